// The random numbers of every renderer: integers, the same in C++ and GLSL. No state: a number is a function of where
// it is used, so that any order, thread count, tile or shard gives the same bits. pcg4d: Jarzynski & Olano, "Hash
// Functions for GPU Rendering", JCGT 9(3), 2020.
#ifndef ETALON_SHADERS_SHARED_RNG_H
#define ETALON_SHADERS_SHARED_RNG_H
#include "shaders/shared/types.h"
ETALON_SHARED_BEGIN

/// Four uniform 32-bit integers for the counter `v`.
ETALON_FUNCTION uvec4 pcg4d(uvec4 v)
{
    v = v * 1664525u + uvec4(1013904223u);
    v.x += v.y * v.w;
    v.y += v.z * v.x;
    v.z += v.x * v.y;
    v.w += v.y * v.z;
    v = v ^ (v >> 16u);
    v.x += v.y * v.w;
    v.y += v.z * v.x;
    v.z += v.x * v.y;
    v.w += v.y * v.z;
    return v;
}

/// The random integers of one decision: `pixel` is y * width + x, `sample_index` counts from 0 in the pixel,
/// `dimension` numbers the decision along the path, `seed` is the user's (folded to 32 bits).
ETALON_FUNCTION uvec4 random_bits(uint pixel, uint sample_index, uint dimension, uint seed)
{
    return pcg4d(uvec4(pixel, sample_index, dimension, seed));
}

/// Uniform in [0, 1), a multiple of 2^-24, never 1 (promise M5, docs/numerics.md).
ETALON_FUNCTION float unit_float(uint bits)
{
    return float(bits >> 8u) * (1.0f / 16777216.0f);
}

ETALON_SHARED_END
#endif
