// Light from the environment without rays: docs/shading.md (SH-33) to (SH-35).
#ifndef ETALON_SHADERS_RASTER_ENVIRONMENT_GLSL
#define ETALON_SHADERS_RASTER_ENVIRONMENT_GLSL
#include "shaders/raster/equirect.glsl"
#include "shaders/raster/frame.glsl"
#include "shaders/lib/albedo.glsl"  // reads by albedo_cell of frame.glsl

vec3 rough_table(vec2 uv, int table)
{
    return fetch_equirect(environment_atlas, uv, ivec2(64, 32), int(frame.mirror_size.y) + 32 * (table - 1));
}

/// (SH-33) Irradiance E(n).
vec3 environment_irradiance(vec3 normal)
{
    if (kEnvironment == kEnvironmentConstant) return kPi * frame.environment_radiance;
    return kPi * frame.environment_scale * rough_table(equirect(to_map(normal, frame.environment_turn)), 6);
}

/// (SH-34) Where the middle of what a rough surface reflects comes from; of any length.
vec3 dominant_reflection(vec3 wo, vec3 n, float roughness)
{
    const float alpha = roughness * roughness;
    return mix(n, reflect(-wo, n), (1.0 - alpha) * (sqrt(max(1.0 - alpha, 0.0)) + alpha));
}

/// (SH-35) P(r, roughness).
vec3 environment_reflection(vec3 r, float roughness)
{
    if (kEnvironment == kEnvironmentConstant) return frame.environment_radiance;
    const vec2 uv = equirect(to_map(r, frame.environment_turn));
    const float level = clamp(roughness, 0.0, 1.0) * 5.0;
    const int table = min(int(level), 4);
    const vec3 fine =
        table == 0 ? fetch_equirect(environment_atlas, uv, ivec2(frame.mirror_size), 0) : rough_table(uv, table);
    return frame.environment_scale * mix(fine, rough_table(uv, table + 1), level - float(table));
}

/// (SH-34) [A, B]: the specular albedo is F0 A + F90 B.
vec2 specular_albedo(float roughness, float n_v)
{
    const float e = ggx_albedo(n_v, clamp(roughness * roughness, 1e-3, 1.0));
    const float b = e * schlick_share(n_v, roughness);
    return vec2(e - b, b);
}

#endif
