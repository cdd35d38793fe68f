// How the trace kernels read their rays and hand out what they found.
#ifndef ETALON_PATH_TRACE_IO_GLSL
#define ETALON_PATH_TRACE_IO_GLSL
#include "shaders/path/queues.glsl"
#include "shaders/path/traversal.glsl"

uint ray_count() { return counters[counter_at(push.iteration, kShadow ? kCountShadows : kCountPaths)]; }

uint alpha_key_of(uint slot)
{
    uint pixel;
    uint sample_in_pass;
    split_slot(slot, pixel, sample_in_pass);
    uint dimension = 0x40000000u | (2u * push.iteration + (kShadow ? 1u : 0u));
    return random_bits(picture_pixel(pixel), push.first_sample + sample_in_pass, dimension, frame.seed).x;
}

// Ray `index` of the queue, and how far it goes.
Ray load_ray(uint index, out float t_max)
{
    uvec4 a = kShadow ? imageLoad(shadows_in, int(3u * index)) : imageLoad(paths_in, int(kPathTexels * index));
    uvec4 b = kShadow ? imageLoad(shadows_in, int(3u * index + 1u)) : imageLoad(paths_in, int(kPathTexels * index + 1u));
    t_max = kShadow ? uintBitsToFloat(b.w) : kMaxFloat;
    uint key = 0u;
    if (kAlpha) key = alpha_key_of(kShadow ? imageLoad(shadows_in, int(3u * index + 2u)).w : b.w);
    return make_ray(uintBitsToFloat(a.xyz), uintBitsToFloat(b.xyz), a.w, key);
}

// A path segment's hit goes to the hits; the light of a shadow ray that met nothing goes to its path.
void store_result(uint index, Hit hit)
{
    if (kShadow) {
        uvec4 c = imageLoad(shadows_in, int(3u * index + 2u));
        vec3 light = uintBitsToFloat(c.xyz);
        if (kGlassShadows) light *= passed;
        if (hit.primitive == kNoPrimitive) radiance[c.w].xyz += light;
    } else {
        hits_out[index] = hit.primitive;  // one word: where exactly is computed again where it is shaded
    }
}

// Leaves a ray to the exact kernel.
void retry(uint index)
{
    retries[atomicAdd(counters[counter_at(push.iteration, kShadow ? kCountRetriedShadows : kCountRetriedPaths)], 1u)] = index;
}

#endif
