// Finds what rays meet, for software Vulkan on SIMD units: each lane keeps taking rays (persistent), the nearest child first
// on a stack held in registers, shifted rather than indexed. Loops end by votes, so that lanes that wait are few. A ray that
// would overflow the stack, and rays left when the lane has made its share of steps, go to the exact kernel: lavapipe ends
// every loop of an invocation after 65535 iterations, without a word.
#version 460
#extension GL_EXT_scalar_block_layout : require
#extension GL_GOOGLE_include_directive : require
#include "shaders/path/lanes.glsl"
#include "shaders/path/trace_io.glsl"

layout(local_size_x = kPathWorkgroup) in;

// Steps of a lane after which it takes no more rays: each is one turn of an inner loop, and of the two loops around it.
const uint kMaxSteps = 20000u;
void main()
{
    uint count = ray_count();
    uint lanes = gl_SubgroupSize;
    uint group = gl_WorkGroupID.x * gl_NumSubgroups + gl_SubgroupID;
    uint index = group * lanes * kRaysPerLane + gl_SubgroupInvocationID;  // of the ray to be taken next
    uint taken = 0u;     // rays taken so far
    uint current = 0u;   // index of the ray at hand
    bool busy = false;   // there is one
    int node = kDone;
    Hit hit = Hit(0.0, kNoPrimitive);
    float t_max;
    Ray ray = load_ray(min(index, count - 1u), t_max);
    for (int i = 0; i < kStack; ++i) stack[i] = kDone;

    uint steps = 0u;
    for (;;) {
        bool finished = node == kDone;
        if (finished && busy) {
            if (overflowed) {
                retry(current);
            } else {
                store_result(current, hit);
            }
        }
        bool take = finished && taken < kRaysPerLane && index < count && steps < kMaxSteps;
        busy = finished ? take : busy;
        float next_t_max;
        Ray next = load_ray(min(index, count - 1u), next_t_max);
        if (take) {
            ray = next;
            hit = Hit(next_t_max, kNoPrimitive);
            current = index;
            index += lanes;
            ++taken;
            node = 0;
            overflowed = false;
            if (kGlassShadows && kShadow) passed = vec3(1.0);
            for (int i = 0; i < kStack; ++i) stack[i] = kDone;
        }
        if (subgroup_sum(busy ? 1 : 0) == 0) break;

        bool has_more = taken < kRaysPerLane && index < count;
        for (;;) {
            do {
                node = visit_node(ray, node, hit.t);
                ++steps;
            } while (subgroup_sum(node >= 0 ? 1 : 0) > kFewAtNodes && steps < kMaxSteps);
            do {
                node = visit_leaf(ray, node, kShadow, hit);
                ++steps;
            } while (subgroup_sum(node < 0 && node != kDone ? 1 : 0) > kFewAtLeaves && steps < kMaxSteps);
            // Low half: lanes that could take a new ray; high half: lanes at work.
            int state = subgroup_sum(node == kDone ? (has_more ? 1 : 0) : 0x10000);
            if ((state & 0xffff) >= kRefill || (state >> 16) == 0 || steps >= kMaxSteps) break;
        }
        if (steps >= kMaxSteps) break;
    }

    // Out of steps: what is not done is done elsewhere. `steps` is the same in all lanes.
    if (steps >= kMaxSteps) {
        if (busy) {
            if (node == kDone && !overflowed) {
                store_result(current, hit);
            } else {
                retry(current);
            }
        }
        for (; taken < kRaysPerLane && index < count; ++taken) {
            retry(index);
            index += lanes;
        }
    }
}
