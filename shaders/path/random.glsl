// The random numbers of a path, by the sampler that the picture asks for.
#ifndef ETALON_PATH_RANDOM_GLSL
#define ETALON_PATH_RANDOM_GLSL
#include "shaders/path/scene_data.glsl"
#include "shaders/shared/sobol.h"

uvec4 path_bits(uint pixel, uint sample_index, uint dimension)
{
    if (kSobol) return sobol_bits(pixel, sample_index, dimension, frame.seed);
    return random_bits(pixel, sample_index, dimension, frame.seed);
}

#endif
