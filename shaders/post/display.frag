#version 460
#extension GL_EXT_scalar_block_layout : require
#extension GL_GOOGLE_include_directive : require
// Linear radiance to what a window shows: exposure, tone curve, sRGB transfer; engine/image/develop.h in single
// precision. Where the picture is transparent, a chequered ground shows.
#include "shaders/lib/tone.glsl"

layout(set = 0, binding = 0) uniform sampler2D picture;  // RGBA, premultiplied
layout(push_constant, scalar) uniform Push {
    vec2 size;       // of the window, pixels
    float exposure;  // factor
    uint curve;      // of enum class Tone
};
layout(location = 0) out vec4 shown;

vec3 srgb_from_linear(vec3 linear)
{
    const vec3 bent = 1.055 * pow(linear, vec3(1.0 / 2.4)) - 0.055;
    return mix(bent, 12.92 * linear, lessThanEqual(linear, vec3(0.0031308)));
}

void main()
{
    const vec4 film = texture(picture, gl_FragCoord.xy / size);
    if (any(isnan(film)) || any(isinf(film))) {
        shown = vec4(1.0, 0.0, 1.0, 1.0);  // loud, as in develop()
        return;
    }
    const vec3 exposed = max(film.rgb * (film.a > 0.0 ? exposure / film.a : exposure), 0.0);
    const vec3 coded = srgb_from_linear(clamp(tone(curve, exposed), 0.0, 1.0));
    const ivec2 cell = ivec2(gl_FragCoord.xy) / 16;
    const vec3 ground = vec3((cell.x + cell.y) % 2 == 0 ? 0.4 : 0.5);
    shown = vec4(mix(ground, coded, min(film.a, 1.0)), 1.0);
}
