// Light from the environment without rays: docs/shading.md (SH-33) to (SH-35).
#ifndef ETALON_SHADERS_RASTER_ENVIRONMENT_GLSL
#define ETALON_SHADERS_RASTER_ENVIRONMENT_GLSL
#include "shaders/raster/equirect.glsl"
#include "shaders/raster/frame.glsl"

/// (SH-33) Irradiance E(n), not below 0.
vec3 environment_irradiance(vec3 normal)
{
    if (kEnvironment == kEnvironmentConstant) return kPi * frame.environment_radiance;
    const vec3 n = to_map(normal, frame.environment_turn);
    vec3 e = frame.irradiance[0] + frame.irradiance[1] * n.y + frame.irradiance[2] * n.z + frame.irradiance[3] * n.x;
    e += frame.irradiance[4] * (n.x * n.y) + frame.irradiance[5] * (n.y * n.z) +
         frame.irradiance[6] * (3.0 * n.z * n.z - 1.0) + frame.irradiance[7] * (n.x * n.z) +
         frame.irradiance[8] * (n.x * n.x - n.y * n.y);
    return max(e, vec3(0.0));
}

vec3 rough_table(vec2 uv, int table)
{
    return fetch_equirect(environment_atlas, uv, ivec2(64, 32), int(frame.mirror_size.y) + 32 * (table - 1));
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

/// (SH-34) [A, B] of Karis 2014: the specular albedo is F0 A + B.
vec2 specular_albedo(float roughness, float n_v)
{
    const vec4 r = roughness * vec4(-1.0, -0.0275, -0.572, 0.022) + vec4(1.0, 0.0425, 1.04, -0.04);
    const float a = min(r.x * r.x, exp2(-9.28 * n_v)) * r.x + r.y;
    return vec2(-1.04 * a + r.z, 1.04 * a + r.w);
}

#endif
