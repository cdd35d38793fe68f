// Looking up an equirectangular map: docs/shading.md §5.
#ifndef ETALON_SHADERS_RASTER_EQUIRECT_GLSL
#define ETALON_SHADERS_RASTER_EQUIRECT_GLSL

/// Into the map's frame: R_y(-rotation) d, `turn` = (cos, sin) of the rotation (SH-40).
vec3 to_map(vec3 d, vec2 turn)
{
    return vec3(turn.x * d.x - turn.y * d.z, d.y, turn.y * d.x + turn.x * d.z);
}

/// Equirectangular coordinates of a direction in the map's frame (SH-40). The polar angle by the arc tangent: acos of
/// lavapipe is off by 1.6e-4, which is a fortieth of a texel of 256.
vec2 equirect(vec3 d)
{
    const float kTurn = 6.28318530717958647692;
    const float across = length(d.xz);
    return vec2(across > 0.0 ? fract(atan(d.x, -d.z) / kTurn) : 0.0, atan(across, d.y) / (0.5 * kTurn));
}

/// Bilinear look-up in the `size` texels of `map` from row `first_row` on; u wraps, v clamps. By fetches, not by a
/// sampler: those may weigh by 8 bits, and need not filter 32-bit floats at all.
vec3 fetch_equirect(texture2D map, vec2 uv, ivec2 size, int first_row)
{
    const vec2 texel = uv * vec2(size) - 0.5;
    const vec2 low = floor(texel);
    const vec2 weight = texel - low;
    const int x0 = int(low.x) < 0 ? int(low.x) + size.x : min(int(low.x), size.x - 1);
    const int x1 = x0 + 1 == size.x ? 0 : x0 + 1;
    const int y0 = first_row + clamp(int(low.y), 0, size.y - 1);
    const int y1 = first_row + clamp(int(low.y) + 1, 0, size.y - 1);
    const vec3 top = mix(texelFetch(map, ivec2(x0, y0), 0).rgb, texelFetch(map, ivec2(x1, y0), 0).rgb, weight.x);
    const vec3 bottom = mix(texelFetch(map, ivec2(x0, y1), 0).rgb, texelFetch(map, ivec2(x1, y1), 0).rgb, weight.x);
    return mix(top, bottom, weight.y);
}

#endif
