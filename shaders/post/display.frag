#version 460
#extension GL_EXT_scalar_block_layout : require
// Linear radiance to what a window shows: exposure, tone curve, sRGB transfer; engine/image/develop.h in single
// precision. Where the picture is transparent, a chequered ground shows.
layout(set = 0, binding = 0) uniform sampler2D picture;  // RGBA, premultiplied
layout(push_constant, scalar) uniform Push {
    vec2 size;       // of the window, pixels
    float exposure;  // factor
    uint tone;       // 0 none, 1 ACES, 2 neutral: enum class Tone
};
layout(location = 0) out vec4 shown;

vec3 tone_aces(vec3 exposed)
{
    const mat3 aces_from_srgb = mat3(0.59719, 0.07600, 0.02840, 0.35458, 0.90834, 0.13383, 0.04823, 0.01566, 0.83777);
    const mat3 srgb_from_aces = mat3(1.60475, -0.10208, -0.00327, -0.53108, 1.10813, -0.07276, -0.07367, -0.00605, 1.07602);
    const vec3 v = min(aces_from_srgb * (exposed / 0.6), 1e15);  // x * x stays finite
    const vec3 a = v * (v + 0.0245786) - 0.000090537;
    const vec3 b = v * (0.983729 * v + 0.4329510) + 0.238081;
    return srgb_from_aces * (a / b);
}

vec3 tone_neutral(vec3 exposed)
{
    const float fresnel = 0.04;
    const float start = 0.8 - fresnel;
    const float least = min(exposed.x, min(exposed.y, exposed.z));
    const float offset = least < 2.0 * fresnel ? least - least * least / (4.0 * fresnel) : fresnel;
    const vec3 color = exposed - offset;
    const float peak = max(color.x, max(color.y, color.z));
    if (peak < start) return color;
    const float room = 1.0 - start;
    const float compressed = 1.0 - room * room / (peak + room - start);
    const float to_white = 1.0 - 1.0 / (0.15 * (peak - compressed) + 1.0);
    return mix(color * (compressed / peak), vec3(compressed), to_white);
}

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
    vec3 exposed = film.rgb * (film.a > 0.0 ? exposure / film.a : exposure);
    if (tone == 1u) exposed = tone_aces(exposed);
    if (tone == 2u) exposed = tone_neutral(exposed);
    const vec3 coded = srgb_from_linear(clamp(exposed, 0.0, 1.0));
    const ivec2 cell = ivec2(gl_FragCoord.xy) / 16;
    const vec3 ground = vec3((cell.x + cell.y) % 2 == 0 ? 0.4 : 0.5);
    shown = vec4(mix(ground, coded, min(film.a, 1.0)), 1.0);
}
