// How much of a punctual light reaches a point: docs/shading.md (SH-43).
#ifndef ETALON_SHADERS_RASTER_SHADOW_GLSL
#define ETALON_SHADERS_RASTER_SHADOW_GLSL
#include "shaders/raster/frame.glsl"

/// Which of a point light's six maps looks along `d`: +X, -X, +Y, -Y, +Z, -Z.
uint shadow_face(vec3 d)
{
    const vec3 a = abs(d);
    if (a.x >= a.y && a.x >= a.z) return d.x >= 0.0 ? 0u : 1u;
    if (a.y >= a.z) return d.y >= 0.0 ? 2u : 3u;
    return d.z >= 0.0 ? 4u : 5u;
}

/// Metres along the axis of what a map holds; beyond everything where it holds nothing.
float shadow_distance(RasterShadow map, ivec2 texel)
{
    const float depth = shadow_depths[map.first + uint(texel.y) * map.side + uint(texel.x)];
    if (depth <= 0.0) return 1e30;
    return map.kind == kShadowParallel ? mix(map.depth_range.y, map.depth_range.x, depth) : map.depth_range.x / depth;
}

/// Whether the plane through `c` across `n` (in the light's frame) is lit at the centre of a texel: what the map holds there
/// is not before it. The plane's own distance there, so that a slope needs no bias but for what rounding moves.
float plane_is_lit(RasterShadow map, vec3 c, vec3 n, float offset, float reach, ivec2 texel)
{
    const vec2 unit = (2.0 * (vec2(texel) + 0.5) / float(map.side) - 1.0) * vec2(1.0, -1.0);
    const vec2 film = unit * map.half_extent;
    const bool parallel = map.kind == kShadowParallel;
    const float along = parallel ? -n.z : dot(n, vec3(film, -1.0));
    const float distance = (parallel ? offset - dot(n.xy, film) : offset) / along;
    // Seen from its edge, or beyond the horizon: its own distance will do.
    const float plane = distance > 0.0 && abs(distance + c.z) < reach ? distance : -c.z;
    const float texel_size = 2.0 * map.half_extent / float(map.side) * (parallel ? 1.0 : plane);
    const float slope = min(length(n.xy) / max(abs(n.z), 1e-3), 1e3);
    // Vertices are snapped to 1/256 texel in both directions; positions are off by a few 2^-23 of their size.
    const float rounding = slope * texel_size / 128.0 + 4e-6 * (length(c) + length(map.eye));
    return shadow_distance(map, texel) > plane - rounding ? 1.0 : 0.0;
}

/// 0 … 1: the mean over a square of three texels about the point.
float lit_share(uint light, vec3 position, vec3 ng)
{
    if (shadows[6u * light].kind == kShadowNone) return 1.0;
    const bool cube = shadows[6u * light].kind == kShadowCube;
    const RasterShadow map = shadows[6u * light + (cube ? shadow_face(position - shadows[6u * light].eye) : 0u)];
    const vec3 c = map.light_from_world * (position - map.eye);
    const vec3 n = map.light_from_world * ng;
    if (map.kind != kShadowParallel && c.z >= 0.0) return 1.0;
    const vec2 film = map.kind == kShadowParallel ? c.xy : c.xy / -c.z;
    const vec2 at = (film / map.half_extent * vec2(0.5, -0.5) + 0.5) * float(map.side);
    if (any(lessThan(at, vec2(0.0))) || any(greaterThan(at, vec2(float(map.side))))) return 1.0;
    const vec2 low = floor(at - 1.5);
    const vec2 f = at - 1.5 - low;
    const vec4 wx = vec4(1.0 - f.x, 1.0, 1.0, f.x) / 3.0;
    const vec4 wy = vec4(1.0 - f.y, 1.0, 1.0, f.y) / 3.0;
    const float offset = dot(n, c);
    const float reach = 0.25 * length(c);
    float sum = 0.0;
    for (int y = 0; y < 4; ++y)
        for (int x = 0; x < 4; ++x) {
            const ivec2 texel = clamp(ivec2(low) + ivec2(x, y), ivec2(0), ivec2(int(map.side) - 1));
            sum += wx[x] * wy[y] * plane_is_lit(map, c, n, offset, reach, texel);
        }
    return sum;
}

#endif
