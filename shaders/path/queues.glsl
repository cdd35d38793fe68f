// Queues and counters between the kernels of one wave.
#ifndef ETALON_PATH_QUEUES_GLSL
#define ETALON_PATH_QUEUES_GLSL
#extension GL_KHR_shader_subgroup_basic : require
#extension GL_KHR_shader_subgroup_shuffle : require
#include "shaders/path/scene_data.glsl"

layout(set = 0, binding = kBindPathsIn, rgba32ui) readonly uniform uimageBuffer paths_in;
layout(set = 0, binding = kBindHits, r32ui) readonly uniform uimageBuffer hits_in;
layout(set = 0, binding = kBindShadows, rgba32ui) readonly uniform uimageBuffer shadows_in;
layout(set = 0, binding = kBindPixels, r32ui) readonly uniform uimageBuffer chosen_pixels;
layout(set = 0, binding = kBindPathsOut, std430) writeonly buffer PathsOut { vec4 paths_out[]; };
layout(set = 0, binding = kBindHitsOut, std430) writeonly buffer HitsOut { uint hits_out[]; };
layout(set = 0, binding = kBindShadowsOut, std430) writeonly buffer ShadowsOut { vec4 shadows_out[]; };
layout(set = 0, binding = kBindRadiance, std430) buffer Radiance { vec4 radiance[]; };
layout(set = 0, binding = kBindCounters, std430) buffer Counters { uint counters[]; };
layout(set = 0, binding = kBindRetries, std430) buffer Retries { uint retries[]; };

// Texels of a path in its queue.
const bool kFourthTexel = kVolume || kGlassShadows;
const uint kPathTexels = kFourthTexel ? 4u : 3u;

// A path on its way: the ray of its current segment, what it carries, and where its light goes.
struct PathState {
    vec3 origin;
    uint self;        // the primitive it leaves, which it cannot meet again; kNoPrimitive if it can
    vec3 direction;   // unit
    uint slot;        // of the radiance, relative to the pass
    vec3 throughput;
    float pdf;        // density of the direction over solid angle; negative: no light sampling competes with it
    uint medium;      // material of the body that it is in (SH-59), or kNoMedium
    float reach;      // metres from where the direction was chosen to the origin: what glass is behind (SH-70)
};

const uint kNoMedium = 0xffffffffu;

PathState load_path(uint index)
{
    int first = int(kPathTexels * index);
    uvec4 a = imageLoad(paths_in, first);
    uvec4 b = imageLoad(paths_in, first + 1);
    vec4 c = uintBitsToFloat(imageLoad(paths_in, first + 2));
    uvec4 d = uvec4(kNoMedium, 0u, 0u, 0u);
    if (kFourthTexel) d = imageLoad(paths_in, first + 3);
    return PathState(uintBitsToFloat(a.xyz), a.w, uintBitsToFloat(b.xyz), b.w, c.xyz, c.w, d.x, uintBitsToFloat(d.y));
}

void store_path(uint index, PathState path)
{
    uint first = kPathTexels * index;
    paths_out[first] = vec4(path.origin, uintBitsToFloat(path.self));
    paths_out[first + 1u] = vec4(path.direction, uintBitsToFloat(path.slot));
    paths_out[first + 2u] = vec4(path.throughput, path.pdf);
    if (kFourthTexel) paths_out[first + 3u] = vec4(uintBitsToFloat(path.medium), path.reach, 0.0, 0.0);
}

uint counter_at(uint iteration, uint which) { return kCountersPerIteration * iteration + which; }

// a / b, and what is left, for a below 2^31 and quotients below 2^22, where the float one is off by one at most: integer
// division is a scalar loop on lavapipe.
uint divide(uint a, uint b, out uint rest)
{
    uint guess = uint(float(a) / float(b));
    int over = int(a) - int(guess * b);
    uint quotient = over < 0 ? guess - 1u : (over >= int(b) ? guess + 1u : guess);
    rest = a - quotient * b;
    return quotient;
}

// Which pixel of the band, and which sample of the pass, a slot is: slot = sample * pixel_count + pixel.
void split_slot(uint slot, out uint pixel, out uint sample_in_pass)
{
    sample_in_pass = divide(slot, push.pixel_count, pixel);
}

uint picture_pixel(uint pixel) { return kChosenPixels ? imageLoad(chosen_pixels, int(pixel)).x : push.first_pixel + pixel; }

// One place in a queue for every invocation that wants one; one atomic a subgroup. All invocations must call it.
uint append(uint counter, bool wanted)
{
    uint lane = gl_SubgroupInvocationID;
    uint before = wanted ? 1u : 0u;
    for (uint i = 0u; i < kSubgroupLog2; ++i) {
        uint step_size = 1u << i;
        uint other = subgroupShuffle(before, (lane - step_size) & (gl_SubgroupSize - 1u));
        before += lane >= step_size ? other : 0u;
    }
    uint total = subgroupShuffle(before, gl_SubgroupSize - 1u);
    uint base = 0u;
    if (lane == 0u && total > 0u) base = atomicAdd(counters[counter], total);
    return subgroupShuffle(base, 0u) + before - 1u;
}

#endif
