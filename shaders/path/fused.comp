// Whole paths, for software Vulkan on SIMD units: what generate, trace, shade and trace for shadows do one after the other
// through queues in memory is done in registers, to the same bits. The lanes of a subgroup share a pool of paths: a lane
// whose path has ended takes the next one, so that all are busy until the pool is empty. Between two turns of shading a lane
// traces the shadow ray of the last one and then its next segment, without waiting for the others; where that leaves the
// scene, its path is ended without a turn. There is one place for each costly thing (taking, shading, storing), since no
// branch jumps over it. Paths that are left when the lanes have made their share of steps (see trace.comp) are done again
// through the queues.
#version 460
#extension GL_EXT_scalar_block_layout : require
#extension GL_GOOGLE_include_directive : require
#include "shaders/path/lanes.glsl"
#include "shaders/path/shade.glsl"
#include "shaders/path/start.glsl"

layout(local_size_x = kPathWorkgroup) in;

// Turns of all loops of a lane after which its subgroup gives up: lavapipe ends every loop after 65535 of them.
const uint kMaxSteps = 50000u;

// How many lanes below this one want a path; `all` of them.
uint rank_among(bool wanted, out uint all)
{
    uint lane = gl_SubgroupInvocationID;
    uint sum = wanted ? 1u : 0u;
    for (uint i = 0u; i < kSubgroupLog2; ++i) {
        uint other = subgroupShuffle(sum, (lane - (1u << i)) & (gl_SubgroupSize - 1u));
        sum += lane >= (1u << i) ? other : 0u;
    }
    all = subgroupShuffle(sum, gl_SubgroupSize - 1u);
    return sum - (wanted ? 1u : 0u);
}

uint subgroup_max(uint x)
{
    uint lane = gl_SubgroupInvocationID;
    for (uint i = 0u; i < kSubgroupLog2; ++i) x = max(x, subgroupShuffle(x, lane ^ (1u << i)));
    return x;
}

void leave_over(uint slot) { retries[atomicAdd(counters[kCountLeftOver], 1u)] = slot; }

// What a lane is at.
const uint kIdle = 0u;         // it has no path
const uint kCasts = 1u;        // a shadow ray, to be traced
const uint kShadowRay = 2u;    // which is under way; a segment follows if the lane is busy
const uint kGoes = 3u;         // a segment, to be traced
const uint kSegment = 4u;      // which is under way
const uint kMet = 5u;          // which has ended at a surface

layout(constant_id = kSpecTurn) const int kTurn = 4;  // lanes at surfaces that are worth a turn of shading

void main()
{
    uint lanes = gl_SubgroupSize;
    uint group = gl_WorkGroupID.x * gl_NumSubgroups + gl_SubgroupID;
    uint pool = group * lanes * kRaysPerLane;  // the path to be taken next
    uint end = min(pool + lanes * kRaysPerLane, push.slot_count);

    uint state = kIdle;
    bool busy = false;   // the lane has a path
    uint segment = 0u;
    PathState path = start_path(0u, false);
    vec4 sum = vec4(0.0);  // of the path; or of the one before, while that is owed
    bool owed = false;     // the sum of an ended path, whose last shadow ray is not traced
    uint slot = 0u;
    vec3 light = vec3(0.0);
    vec3 origin = path.origin;  // of the ray under way, or to be traced
    vec3 direction = path.direction;
    uint self = kNoPrimitive;
    float reach = 0.0;
    Ray ray = make_ray(origin, direction, self, 0u);
    Hit hit = Hit(0.0, kNoPrimitive);
    int node = kDone;
    for (int i = 0; i < kStack; ++i) stack[i] = kDone;
    uint steps = 0u;
    for (;;) {
        bool turn = state == kMet;
        light_turns = 0u;
        Shaded shaded = shade(path, hit.primitive, segment, turn);
        steps += 1u + (kPunctual ? kWeighedLights : 0u);
        if (kLightTree) steps += 2u * subgroup_max(light_turns);  // twice: two loops, each as long as its longest lane
        if (turn) {
            sum = (segment == 0u ? vec4(0.0) : sum) + shaded.collected;
            slot = path.slot;
            owed = !shaded.goes_on;
            busy = shaded.goes_on;
            light = shaded.shadow.light;
            path = shaded.next;
            ++segment;
            origin = shaded.casts ? shaded.shadow.origin : path.origin;
            direction = shaded.casts ? shaded.shadow.direction : path.direction;
            self = shaded.casts ? shaded.shadow.self : path.self;
            reach = shaded.casts ? shaded.shadow.reach : kMaxFloat;
            state = shaded.casts ? kCasts : (busy ? kGoes : kIdle);
        }
        int rest;
        do {
            ++steps;
            uint wanted;
            uint place = pool + rank_among(!busy, wanted);
            bool takes = !busy && place < end;
            PathState fresh = start_path(slot_at(min(place, push.slot_count - 1u)), false);
            if (takes) {
                path = fresh;
                segment = 0u;
                busy = true;
            }
            if (takes && state == kIdle) {
                origin = path.origin;
                direction = path.direction;
                self = path.self;
                reach = kMaxFloat;
                state = kGoes;
            }
            pool = min(pool + wanted, end);

            for (;;) {
                ++steps;
                bool starts = state == kCasts || state == kGoes;
                Ray next = make_ray(origin, direction, self, 0u);
                if (starts) {
                    ray = next;
                    hit = Hit(reach, kNoPrimitive);
                    node = 0;
                    state = state == kCasts ? kShadowRay : kSegment;
                    for (int i = 0; i < kStack; ++i) stack[i] = kDone;
                }
                for (;;) {
                    ++steps;
                    do {
                        node = visit_node(ray, node, hit.t);
                        ++steps;
                    } while (subgroup_sum(node >= 0 ? 1 : 0) > kFewAtNodes && steps < kMaxSteps);
                    do {
                        node = visit_leaf(ray, node, state == kShadowRay, hit);
                        ++steps;
                    } while (subgroup_sum(node < 0 && node != kDone ? 1 : 0) > kFewAtLeaves && steps < kMaxSteps);
                    // Low half: lanes that could go on with something else; high half: lanes at work.
                    int at = subgroup_sum(node == kDone ? (busy && state != kMet ? 1 : 0) : 0x10000);
                    if ((at & 0xffff) >= kRefill || (at >> 16) == 0 || steps >= kMaxSteps) break;
                }
                bool lit = state == kShadowRay && node == kDone;
                if (lit && hit.primitive == kNoPrimitive) sum.xyz += light;
                if (lit) {
                    state = busy ? kGoes : kIdle;
                    origin = path.origin;
                    direction = path.direction;
                    self = path.self;
                    reach = kMaxFloat;
                }
                if (subgroup_sum(state == kGoes ? 1 : 0) == 0 || steps >= kMaxSteps) break;
            }

            bool arrives = state == kSegment && node == kDone;
            bool met = arrives && hit.primitive != kNoPrimitive;
            bool pays = owed && state != kShadowRay && state != kCasts;
            bool leaves = arrives && !met && !pays;
            if (kVolume) met = arrives;  // absorbed on its way out
            if (kVolume) leaves = false;
            state = met ? kMet : state;
            Collected out_there = leave_scene(path, segment == 0u);
            vec4 value = (segment == 0u ? vec4(0.0) : sum) + vec4(out_there.light, segment == 0u ? out_there.alpha : 0.0);
            if (pays || leaves) radiance[pays ? slot : path.slot] = pays ? sum : value;
            owed = owed && !pays;
            busy = busy && !leaves;
            state = leaves ? kIdle : state;
            // Low half: lanes to be shaded; high half: lanes that have something else to do.
            rest = subgroup_sum(state == kMet ? 1 : (busy || owed || pool < end ? 0x10000 : 0));
        } while ((rest & 0xffff) < kTurn && (rest >> 16) > 0 && steps < kMaxSteps);
        if (rest == 0 || steps >= kMaxSteps) break;
    }
    if (owed) leave_over(slot);
    if (busy) leave_over(path.slot);
    for (uint place = pool + gl_SubgroupInvocationID; place < end; place += lanes) leave_over(slot_at(place));
}
