// The curves between exposed radiance, at least 0, and the display's linear values (IP-15); their numbers are the enum
// class Tone of engine/image/develop.h. The caller clamps to [0, 1].

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

// By luminance, so that colours keep their hue and saturation until a channel clips.
vec3 tone_reinhard(vec3 exposed)
{
    const float y = dot(exposed, vec3(0.2126, 0.7152, 0.0722));
    return exposed / (1.0 + y);
}

vec3 tone_agx(vec3 exposed)
{
    const mat3 rec2020_from_srgb = mat3(0.6274, 0.0691, 0.0164, 0.3293, 0.9195, 0.0880, 0.0433, 0.0113, 0.8956);
    const mat3 srgb_from_rec2020 = mat3(1.6605, -0.1246, -0.0182, -0.5876, 1.1329, -0.1006, -0.0728, -0.0083, 1.1187);
    const mat3 inset = mat3(0.856627153315983, 0.137318972929847, 0.11189821299995, 0.0951212405381588, 0.761241990602591,
                            0.0767994186031903, 0.0482516061458583, 0.101439036467562, 0.811302368396859);
    const mat3 outset = mat3(1.1271005818144368, -0.1413297634984383, -0.14132976349843826, -0.11060664309660323,
                             1.157823702216272, -0.11060664309660294, -0.016493938717834573, -0.016493938717834257,
                             1.2519364065950405);
    const float least = -12.47393, most = 4.026069;  // EV
    const vec3 v = max(inset * (rec2020_from_srgb * exposed), 1e-10);
    const vec3 x = clamp((log2(v) - least) / (most - least), 0.0, 1.0);
    const vec3 curve = -0.00232 + x * (0.1191 + x * (0.4298 + x * (-6.868 + x * (31.96 + x * (-40.14 + x * 15.5)))));
    return srgb_from_rec2020 * pow(max(outset * curve, 0.0), vec3(2.2));
}

vec3 tone(uint curve, vec3 exposed)
{
    const vec3 light = min(exposed, 1e37);  // sums of three stay finite
    switch (curve) {
        case 1u: return tone_aces(light);
        case 2u: return tone_neutral(light);
        case 3u: return tone_reinhard(light);
        case 4u: return tone_agx(light);
        default: return light;
    }
}
