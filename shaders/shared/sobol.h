// Random numbers that fill the square evenly, sample after sample (MC-8): Owen-scrambled points of Sobol's
// (0,2)-sequence, shuffled and padded (Burley, "Practical Hash-based Owen Scrambling", JCGT 9(4), 2020). Integers, the
// same in C++ and GLSL, without state like those of rng.h, and in their place: a pair of numbers of one decision is
// even over the samples of its pixel and replicate, and independent of every other pair.
#ifndef ETALON_SHADERS_SHARED_SOBOL_H
#define ETALON_SHADERS_SHARED_SOBOL_H
#include "shaders/shared/rng.h"
ETALON_SHARED_BEGIN

/// The samples of a pixel are dealt in turn to so many replicates, each a sequence scrambled for itself: their scatter
/// tells the error (MC-10). A power of two.
ETALON_CONSTANT uint kSobolReplicates = 2u;

ETALON_FUNCTION uint reversed_bits(uint x)
{
    x = x << 16u | x >> 16u;
    x = (x & 0x00ff00ffu) << 8u | (x >> 8u & 0x00ff00ffu);
    x = (x & 0x0f0f0f0fu) << 4u | (x >> 4u & 0x0f0f0f0fu);
    x = (x & 0x33333333u) << 2u | (x >> 2u & 0x33333333u);
    return (x & 0x55555555u) << 1u | (x >> 1u & 0x55555555u);
}

/// Owen's scrambling of a number whose bits are reversed: whether a bit is flipped is decided by the bits below it
/// alone, and by the seed (Laine & Karras 2011, with the constants of Vegdahl 2021).
ETALON_FUNCTION uint scrambled_upward(uint x, uint seed)
{
    x ^= x * 0x3d20adeau;
    x += seed;
    x *= seed >> 16u | 1u;
    x ^= x * 0x05526c56u;
    x ^= x * 0x53a22864u;
    return x;
}

/// Point `index` of the sequence, bits reversed: the first number is the index itself (van der Corput), the second its
/// product with Pascal's triangle modulo 2. C(j, k) is odd iff k's bits are among j's (Lucas), which makes it five
/// steps.
ETALON_FUNCTION uint pascal_bits(uint x)
{
    x ^= x >> 1u & 0x55555555u;
    x ^= x >> 2u & 0x33333333u;
    x ^= x >> 4u & 0x0f0f0f0fu;
    x ^= x >> 8u & 0x00ff00ffu;
    return x ^ x >> 16u;
}

/// One pair for sample `sample_index`; `seeds` shuffle the samples and scramble either number.
ETALON_FUNCTION uvec2 sobol_pair(uint sample_index, uvec4 seeds)
{
    uint index = reversed_bits(scrambled_upward(reversed_bits(sample_index), seeds.x));
    return uvec2(reversed_bits(scrambled_upward(index, seeds.y)),
                 reversed_bits(scrambled_upward(pascal_bits(index), seeds.z)));
}

/// As random_bits of rng.h, two pairs.
ETALON_FUNCTION uvec4 sobol_bits(uint pixel, uint sample_index, uint dimension, uint seed)
{
    uvec4 key = pcg4d(uvec4(pixel, dimension, seed, 0x50b01u + sample_index % kSobolReplicates));
    uvec2 a = sobol_pair(sample_index / kSobolReplicates, key);
    uvec2 b = sobol_pair(sample_index / kSobolReplicates, pcg4d(key));
    return uvec4(a.x, a.y, b.x, b.y);
}

ETALON_SHARED_END
#endif
