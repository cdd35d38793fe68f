// A step of the traversal in all lanes of a subgroup at once, for SIMD units: the nearest child first, on a stack held in
// registers, shifted rather than indexed.
#ifndef ETALON_PATH_LANES_GLSL
#define ETALON_PATH_LANES_GLSL
#include "shaders/path/queues.glsl"
#include "shaders/path/traversal.glsl"

layout(constant_id = kSpecStack) const int kStack = 24;
layout(constant_id = kSpecRaysPerLane) const uint kRaysPerLane = 32u;
// A loop goes on while more lanes than this are in it; new rays are taken when this many lanes are free.
layout(constant_id = kSpecFewAtNodes) const int kFewAtNodes = 2;
layout(constant_id = kSpecFewAtLeaves) const int kFewAtLeaves = 1;
layout(constant_id = kSpecRefill) const int kRefill = 1;

int subgroup_sum(int x)
{
    uint lane = gl_SubgroupInvocationID;
    for (uint i = 0u; i < kSubgroupLog2; ++i) x += subgroupShuffle(x, lane ^ (1u << i));
    return x;
}

void order(inout int key_a, inout int ref_a, inout int key_b, inout int ref_b)
{
    bool swap = key_b < key_a;
    int key = swap ? key_b : key_a;
    int reference = swap ? ref_b : ref_a;
    key_b = swap ? key_a : key_b;
    ref_b = swap ? ref_a : ref_b;
    key_a = key;
    ref_a = reference;
}

int stack[kStack];
bool overflowed = false;

// Leaves the first `count` (0 … 3) places free, or takes the top away.
void shift_stack(int count, bool pop)
{
    bool odd = (count & 1) != 0;
    bool two = count >= 2;
    int last = stack[kStack - 1];
    int above_last = stack[kStack - 2];
    int third_last = stack[kStack - 3];
    overflowed = overflowed || (count >= 1 && last != kDone) || (two && above_last != kDone) || (count == 3 && third_last != kDone);
    int previous = kDone;
    for (int i = 0; i < kStack; ++i) {
        int current = stack[i];
        int next = i + 1 < kStack ? stack[i + 1] : kDone;
        stack[i] = odd ? previous : (pop ? next : current);
        previous = current;
    }
    for (int i = kStack - 1; i >= 2; --i) stack[i] = two ? stack[i - 2] : stack[i];
}

// One node: its children that are met, the nearest next, the others onto the stack. Lanes that are not at a node do nothing.
int visit_node(Ray ray, int node, float t_max)
{
    bool here = node >= 0;
    int first = 4 * max(node, 0);
    uvec4 c0 = imageLoad(nodes, first);
    uvec4 c1 = imageLoad(nodes, first + 1);
    uvec4 c2 = imageLoad(nodes, first + 2);
    uvec4 c3 = imageLoad(nodes, first + 3);
    int limit = floatBitsToInt(t_max);
    int k0 = child_key(c0, ray, limit), k1 = child_key(c1, ray, limit);
    int k2 = child_key(c2, ray, limit), k3 = child_key(c3, ray, limit);
    int r0 = int(c0.w), r1 = int(c1.w), r2 = int(c2.w), r3 = int(c3.w);
    order(k0, r0, k1, r1);
    order(k2, r2, k3, r3);
    order(k0, r0, k2, r2);
    order(k1, r1, k3, r3);
    order(k1, r1, k2, r2);
    bool met1 = here && k1 < kMissed;
    bool met2 = here && k2 < kMissed;
    bool met3 = here && k3 < kMissed;
    bool pop = here && k0 == kMissed;
    int top = stack[0];
    shift_stack((met1 ? 1 : 0) + (met2 ? 1 : 0) + (met3 ? 1 : 0), pop);
    stack[0] = met1 ? r1 : stack[0];
    stack[1] = met2 ? r2 : stack[1];
    stack[2] = met3 ? r3 : stack[2];
    return here ? (pop ? top : r0) : node;
}

// One primitive of the leaf that a lane is at; a ray that may end at `any` is done where it meets one.
int visit_leaf(Ray ray, int node, bool any, inout Hit hit)
{
    bool here = node < 0 && node != kDone;
    uint leaf = here ? uint(~node) : 0u;
    Hit candidate = hit;
    bool met = meet(ray, leaf >> 4, candidate) && here && (leaf & 15u) != 0u;
    if (kGlassShadows && kShadow && here && (leaf & 15u) != 0u) passed *= passed_here;
    hit.t = met ? candidate.t : hit.t;
    hit.primitive = met ? candidate.primitive : hit.primitive;
    bool more = (leaf & 15u) > 1u;
    bool pop = here && !more;
    int top = stack[0];
    shift_stack(0, pop);
    int next = here ? (more ? ~int(leaf + 15u) : top) : node;
    return any && met ? kDone : next;
}

#endif
