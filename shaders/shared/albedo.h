// The tables of directional albedo (SH-53, SH-61), the same for the host that fills them and the kernels that read
// them: cells of (value, next along x, next along y, both), so that one read of a texel interpolates.
#ifndef ETALON_SHADERS_SHARED_ALBEDO_H
#define ETALON_SHADERS_SHARED_ALBEDO_H
#include "shaders/shared/types.h"
ETALON_SHARED_BEGIN

// E(cosine, alpha) of GGX: x = √((1 + alpha) cosine / (cosine + alpha)), y linear in alpha from kGgxAlbedoAlpha to 1.
ETALON_CONSTANT uint kGgxAlbedoX = 63u;  // cells
ETALON_CONSTANT uint kGgxAlbedoY = 31u;
ETALON_CONSTANT float kGgxAlbedoAlpha = 1e-3f;

// r E(cosine, r²) of sheen: x = ∛((1 + r) cosine / (cosine + r)), cosine at least kSheenAlbedoCosine, from what x is
// there to 1; y linear in r from kSheenAlbedoRoughness to 1. Its cells follow those of GGX.
ETALON_CONSTANT uint kSheenAlbedoX = 95u;
ETALON_CONSTANT uint kSheenAlbedoY = 47u;
ETALON_CONSTANT float kSheenAlbedoRoughness = 0.07f;
ETALON_CONSTANT float kSheenAlbedoCosine = 1e-4f;

ETALON_CONSTANT uint kSheenAlbedoFirst = kGgxAlbedoX * kGgxAlbedoY;
ETALON_CONSTANT uint kAlbedoCells = kSheenAlbedoFirst + kSheenAlbedoX * kSheenAlbedoY;

// The mean of Schlick's weight (SH-34), for rasterizers alone: x = cosine, y = roughness = √alpha. Its cells follow the
// others.
ETALON_CONSTANT uint kSchlickShareX = 63u;
ETALON_CONSTANT uint kSchlickShareY = 31u;
ETALON_CONSTANT uint kSchlickShareFirst = kAlbedoCells;

ETALON_SHARED_END
#endif
