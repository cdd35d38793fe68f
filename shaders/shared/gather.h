// What the kernels that gather light at rasterized surfaces agree on with the host (SH-44): numbers beyond those of path.h.
#ifndef ETALON_SHADERS_SHARED_GATHER_H
#define ETALON_SHADERS_SHARED_GATHER_H
#include "shaders/shared/path.h"
ETALON_SHARED_BEGIN

// Bindings of set 0.
ETALON_CONSTANT uint kBindPoints = 40u;     // read: 2 texels each, (viewing ray's origin, slot) (direction, primitive)
ETALON_CONSTANT uint kBindPointsOut = 41u;  // the same, written
ETALON_CONSTANT uint kBindGathered = 42u;   // image: rgb, metres along the viewing axis
ETALON_CONSTANT uint kBindLit = 43u;        // image: a bit for each of kMostLitLights, object

ETALON_CONSTANT uint kBindKnown = 44u;      // 2 vec4 a point: of its last path and shadow ray (w: there were any), and of looks
ETALON_CONSTANT uint kBindSums = 45u;       // 3 vec4 a point: sums over its paths

/// Punctual lights whose shadows an image can hold.
ETALON_CONSTANT uint kMostLitLights = 96u;

/// Counter, of iteration 1, of the points that pixels of a wave show.
ETALON_CONSTANT uint kCountPoints = kCountRetriedPaths;

ETALON_SHARED_END
#endif
