// Rows and results of path_glossy.comp.
#ifndef ETALON_TESTS_GPU_PATH_GLOSSY_H
#define ETALON_TESTS_GPU_PATH_GLOSSY_H
#include "shaders/shared/types.h"
ETALON_SHARED_BEGIN

// Glossy of shaders/lib/glossy.glsl, and what to do with it.
struct GlossyCall {
    uint sampled;  // 1: draw wi by random numbers of `index`; 0: evaluate wi as given
    uint index;
    vec3 wo;
    vec3 wi;
    vec3 diffuse;
    vec3 f0;
    vec3 hat0;
    float f90;
    vec3 boost;
    float alpha;
    vec2 alphas;
    float film;
    float film_ior;
    float film_nanometres;
    vec3 film_base;
    float film_specular;
    vec3 film_metal;
    float metallic;
    vec3 diffuse_through;
    vec3 through;
    uint body;
    vec3 excess;
    float inner;
    vec3 sheen;
    float sheen_roughness;
    float coat;
    float coat_alpha;
    vec3 coat_n;
    vec3 ng;
};

struct GlossyResult {
    vec3 wi;
    float pdf;   // 0 where the sample went straight through
    vec3 value;  // weight where sampled, else f |n·wi|
};

// What every cell of the tables of albedo holds here, so that E_s = kTestAlbedo / roughness.
ETALON_CONSTANT float kTestAlbedo = 0.3f;

ETALON_SHARED_END
#endif
