// Finds what rays meet, one ray an invocation, with a stack in memory that is never too small: on GPUs for all rays, on
// software Vulkan for those that the persistent kernel leaves (kSpecRetry). A ray that has not ended after as many steps as
// lavapipe grants an invocation is marked, so that its sample is counted as lost and not mistaken.
#version 460
#extension GL_EXT_scalar_block_layout : require
#extension GL_GOOGLE_include_directive : require
#include "shaders/path/trace_io.glsl"

layout(local_size_x = kPathWorkgroup) in;

layout(constant_id = kSpecStack) const int kStack = 64;
layout(constant_id = kSpecRetry) const bool kRetry = false;

const uint kMaxSteps = 60000u;

void main()
{
    uint count = kRetry ? counters[counter_at(push.iteration, kShadow ? kCountRetriedShadows : kCountRetriedPaths)] : ray_count();
    uint invocation = gl_GlobalInvocationID.x;
    if (invocation >= count) return;
    uint index = kRetry ? retries[invocation] : invocation;

    float t_max;
    Ray ray = load_ray(index, t_max);
    Hit hit = Hit(t_max, kNoPrimitive);
    int stack[kStack];
    int height = 0;
    int node = 0;
    uint steps = 0u;
    for (; node != kDone && steps < kMaxSteps; ++steps) {
        bool pop = true;
        if (node >= 0) {
            int nearest = kMissed;
            int next = kDone;
            int limit = floatBitsToInt(hit.t);
            for (int i = 0; i < 4; ++i) {
                uvec4 child = imageLoad(nodes, 4 * node + i);
                int key = child_key(child, ray, limit);
                if (key == kMissed) continue;
                bool nearer = key < nearest;
                if (nearest != kMissed) stack[height++] = nearer ? next : int(child.w);
                next = nearer ? int(child.w) : next;
                nearest = min(key, nearest);
            }
            pop = nearest == kMissed;
            node = pop ? node : next;
        } else {
            uint leaf = uint(~node);
            bool met = (leaf & 15u) != 0u && meet(ray, leaf >> 4, hit);
            if (kShadow && met) break;
            if (kGlassShadows && kShadow && (leaf & 15u) != 0u) passed *= passed_here;
            pop = (leaf & 15u) <= 1u;
            node = pop ? node : ~int(leaf + 15u);
        }
        if (pop) node = height > 0 ? stack[--height] : kDone;
    }
    if (steps >= kMaxSteps) hit.primitive = kLostPrimitive;
    store_result(index, hit);
}
