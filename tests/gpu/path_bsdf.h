// Rows and results of path_bsdf.comp.
#ifndef ETALON_TESTS_GPU_PATH_BSDF_H
#define ETALON_TESTS_GPU_PATH_BSDF_H
#include "shaders/shared/types.h"
ETALON_SHARED_BEGIN

struct BsdfCall {
    uint model;
    uint sampled;  // 1: draw wi by random numbers of `index`; 0: evaluate wi as given
    uint index;
    float alpha;
    float excess;
    vec3 diffuse;
    vec3 f0;
    vec3 eta;
    vec3 k;
    vec3 wo;
    vec3 wi;
};

struct BsdfResult {
    vec3 wi;
    float pdf;
    vec3 value;  // weight where sampled, else f |n·wi|
};

ETALON_SHARED_END
#endif
