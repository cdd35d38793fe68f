// Light on its way through an absorbing body.
#ifndef ETALON_LIB_ABSORPTION_GLSL
#define ETALON_LIB_ABSORPTION_GLSL
#include "shaders/lib/numeric.glsl"

// (SH-59) exp(-absorption distance), distance up to kMaxFloat. The minimum keeps the compiler from multiplying the distance by
// exp's log2(e) first: that is infinite, and infinitely far through what absorbs nothing would be 0 · Inf.
vec3 absorbed(vec3 absorption, float distance) { return exp(-min(absorption * distance, vec3(200.0))); }

#endif
