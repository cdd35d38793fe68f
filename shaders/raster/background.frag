#version 460
#extension GL_EXT_scalar_block_layout : require
#extension GL_EXT_samplerless_texture_functions : require
#extension GL_GOOGLE_include_directive : require
#include "shaders/raster/equirect.glsl"
#include "shaders/raster/frame.glsl"

layout(set = 1, binding = 0) uniform texture2D environment_map;  // at its full size

layout(location = 0) out vec4 color;

void main()
{
    if (kEnvironment == kEnvironmentNone) {
        color = frame.background;
        return;
    }
    vec3 origin, direction;
    film_ray(gl_FragCoord.xy, origin, direction);
    vec3 light = frame.environment_radiance;
    if (kEnvironment == kEnvironmentMap) {
        const vec2 uv = equirect(to_map(direction, frame.environment_turn));
        light = frame.environment_scale * fetch_equirect(environment_map, uv, textureSize(environment_map, 0), 0);
    }
    color = vec4(light, 1.0);
}
