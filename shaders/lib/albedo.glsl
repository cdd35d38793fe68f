// Directional albedos from the tables of engine/render/albedo.h. The includer defines vec4 albedo_cell(int), which reads one
// cell of shaders/shared/albedo.h.
#ifndef ETALON_LIB_ALBEDO_GLSL
#define ETALON_LIB_ALBEDO_GLSL
#include "shaders/shared/albedo.h"

float interpolate_cells(int first, int nx, int ny, vec2 at)
{
    vec2 position = clamp(at, 0.0, 1.0) * vec2(nx, ny);
    int x = min(int(position.x), nx - 1);
    int y = min(int(position.y), ny - 1);
    vec2 fraction = position - vec2(x, y);
    vec4 cell = albedo_cell(first + y * nx + x);
    vec2 along = cell.xz + fraction.x * (cell.yw - cell.xz);
    return along.x + fraction.y * (along.y - along.x);
}

// (SH-53)
float ggx_albedo(float cosine, float alpha)
{
    float x = sqrt((1.0 + alpha) * cosine / (cosine + alpha));
    float y = (alpha - kGgxAlbedoAlpha) / (1.0 - kGgxAlbedoAlpha);
    return interpolate_cells(0, int(kGgxAlbedoX), int(kGgxAlbedoY), vec2(x, y));
}

// (SH-61)
float sheen_albedo(float cosine, float roughness)
{
    float c = max(cosine, kSheenAlbedoCosine);
    float lowest = pow((1.0 + roughness) * kSheenAlbedoCosine / (kSheenAlbedoCosine + roughness), 1.0 / 3.0);
    float x = pow((1.0 + roughness) * c / (c + roughness), 1.0 / 3.0);
    vec2 at = vec2((x - lowest) / (1.0 - lowest), (roughness - kSheenAlbedoRoughness) / (1.0 - kSheenAlbedoRoughness));
    return interpolate_cells(int(kSheenAlbedoFirst), int(kSheenAlbedoX), int(kSheenAlbedoY), at) / roughness;
}

// (SH-34) w̄, from tables of rasterizers.
float schlick_share(float cosine, float roughness)
{
    return interpolate_cells(int(kSchlickShareFirst), int(kSchlickShareX), int(kSchlickShareY), vec2(cosine, roughness));
}

#endif
