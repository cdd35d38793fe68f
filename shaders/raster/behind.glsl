// What a transmitting surface shows of what is behind it: docs/shading.md (SH-65).
#ifndef ETALON_SHADERS_RASTER_BEHIND_GLSL
#define ETALON_SHADERS_RASTER_BEHIND_GLSL
#include "shaders/raster/environment.glsl"
#include "shaders/raster/levels.glsl"
#include "shaders/raster/scatter.glsl"

vec4 behind_at(ivec2 texel, ivec2 size, ivec2 corner)
{
    return texelFetch(picture_behind, corner + clamp(texel, ivec2(0), size - 1), 0);
}

/// One level, bilinear, clamped at the border. `film`: pixels of level 0.
vec4 behind_on_level(vec2 film, int level)
{
    const ivec2 whole = ivec2(frame.size);
    const ivec2 size = level_size(whole, level);
    const ivec2 corner = level_corner(whole, level);
    const vec2 at = clamp(film * (vec2(size) / vec2(whole)) - 0.5, vec2(-1.0), vec2(size));
    const ivec2 low = ivec2(floor(at));
    const vec2 weight = at - floor(at);
    const vec4 top = mix(behind_at(low, size, corner), behind_at(low + ivec2(1, 0), size, corner), weight.x);
    const vec4 bottom =
        mix(behind_at(low + ivec2(0, 1), size, corner), behind_at(low + ivec2(1, 1), size, corner), weight.x);
    return mix(top, bottom, weight.y);
}

vec4 behind_blurred(vec2 film, float level)
{
    const float l = clamp(level, 0.0, float(level_count(ivec2(frame.size)) - 1));
    const int fine = int(l);
    const vec4 sharp = behind_on_level(film, fine);
    return l > float(fine) ? mix(sharp, behind_on_level(film, fine + 1), l - float(fine)) : sharp;
}

/// Pixels where a point is seen; `own` where it is not in front of the viewer.
vec2 film_of(vec3 position, vec2 own)
{
    const vec3 c = position * frame.world_from_camera;
    if (!kOrthographic && c.z >= 0.0) return own;
    const vec2 film = (kOrthographic ? c.xy : c.xy / -c.z) / frame.film_half;
    return 0.5 * (vec2(film.x, -film.y) + 1.0) * frame.size;
}

/// S of a body of index `ior`, or of a thin wall (ior 0).
vec3 seen_through(Seen v, vec3 position, vec2 pixel, float ior)
{
    const float roughness = v.s.reflectance.roughness;
    float narrowing = 1.0;  // of the lobe against that of reflection
    vec3 direction = -v.wo;
    vec2 film = pixel;
    if (kVolume) {
        narrowing = min(abs(ior - 1.0) * 0.70710678, 1.0);
        const vec3 bent = refract(-v.wo, v.s.n, 1.0 / ior);
        if (dot(bent, bent) > 0.0) direction = bent;
        film = film_of(position + v.s.layers.thickness * direction, pixel);
    }
    const float alpha = roughness * roughness * narrowing;
    const float width = alpha * frame.size.y / (kOrthographic ? 1.0 : frame.film_half.y);
    const vec4 near = behind_blurred(film, log2(max(width, 1.0)));
    vec3 sum = near.rgb;
    if (kEnvironment != kEnvironmentNone)
        sum += (1.0 - near.a) * environment_reflection(direction, sqrt(alpha));
    return sum;
}

/// t b (1 - m) S times absorption, but for what the surface's Fresnel term takes.
vec3 light_from_behind(Seen v, vec3 position, vec2 pixel)
{
    const Layers l = v.s.layers;
    vec3 sum;
    if (kVolume && kDispersion && l.ior_spread != 0.0) {
        sum = vec3(seen_through(v, position, pixel, max(l.ior - l.ior_spread, 1.0)).r, seen_through(v, position, pixel, l.ior).g,
                   seen_through(v, position, pixel, l.ior + l.ior_spread).b);
    } else {
        sum = seen_through(v, position, pixel, l.ior);
    }
    if (kVolume) sum *= exp(-l.absorption * l.thickness);
    return l.transmission * v.s.reflectance.diffuse * sum;
}

#endif
