// Which function of shaders/lib a row of path_lib.comp calls, and with what.
#ifndef ETALON_TESTS_GPU_PATH_LIB_H
#define ETALON_TESTS_GPU_PATH_LIB_H
#include "shaders/shared/types.h"
ETALON_SHARED_BEGIN

ETALON_CONSTANT uint kAtanTurns = 0u;       // y, x
ETALON_CONSTANT uint kCosSinTurns = 1u;     // turns
ETALON_CONSTANT uint kDecodeSrgb = 2u;      // code
ETALON_CONSTANT uint kNormalize = 3u;       // vector
ETALON_CONSTANT uint kDielectric = 4u;      // cosine, index - 1
ETALON_CONSTANT uint kConductor = 5u;       // cosine, eta, k
ETALON_CONSTANT uint kSchlick = 6u;         // f0, cosine
ETALON_CONSTANT uint kPowerHeuristic = 7u;  // p, q
ETALON_CONSTANT uint kConeSolidAngle = 8u;  // sin²
ETALON_CONSTANT uint kFrameX = 9u;          // normal
ETALON_CONSTANT uint kFrameY = 10u;
ETALON_CONSTANT uint kSphere = 11u;    // origin, direction, (centre, radius)
ETALON_CONSTANT uint kTriangle = 12u;  // corners with the origin in w, direction
ETALON_CONSTANT uint kGgx = 13u;       // (h, alpha), (cosine i, cosine o)
ETALON_CONSTANT uint kVndf = 14u;      // (wo, alpha), u
ETALON_CONSTANT uint kCosine = 15u;    // u
ETALON_CONSTANT uint kAbsorbed = 16u;  // (absorption, distance; 0: infinitely far)

struct LibCall {
    uint function;
    vec4 a;
    vec4 b;
    vec4 c;
    vec4 d;
};

ETALON_SHARED_END
#endif
