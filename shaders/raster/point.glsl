// A rasterized point and how textures are read there: docs/shading.md §1, §4.
#ifndef ETALON_SHADERS_RASTER_POINT_GLSL
#define ETALON_SHADERS_RASTER_POINT_GLSL
#include "shaders/raster/frame.glsl"

/// A texture coordinate with its screen derivatives.
struct Uv {
    vec2 at;
    vec2 dx;
    vec2 dy;
};

/// What rasterization gives for a pixel, extrapolated to its centre (SH-30).
struct Point {
    vec3 position;  // camera-relative world
    vec3 ng;        // unit, on the glTF front's side
    vec3 n;         // unit, on the same side
    vec4 tangent;   // world, not unit; w the bitangent's sign; 0: none
    Uv uv[2];
    vec4 color;
    float scale;    // metres in the world per metre in the mesh: thickness of bodies (SH-65)
    bool front;
};

/// (TX-1) from the interpolated coordinate times q = 1/w and q itself: both are linear on the screen, so their
/// differences are exact derivatives, the same on every pixel of a quad.
Uv with_derivatives(vec2 uv, float q)
{
    const vec2 linear = uv * q;
    return Uv(uv, (dFdx(linear) - uv * dFdx(q)) / q, (dFdy(linear) - uv * dFdy(q)) / q);
}

Uv uv_of(TextureSlot slot, Point point)
{
    Uv uv = point.uv[0];
    if (kUv1 && slot.uv_set == 1u) uv = point.uv[1];
    if (!kTextureTransform) return uv;
    const mat2 m = mat2(slot.u_row.x, slot.v_row.x, slot.u_row.y, slot.v_row.y);
    return Uv(m * uv.at + vec2(slot.u_row.z, slot.v_row.z), m * uv.dx, m * uv.dy);
}

/// (TX-2), not clamped.
float level_of(sampler2D map, TextureSlot slot, Point point)
{
    const Uv uv = uv_of(slot, point);
    const vec2 dx = uv.dx * vec2(textureSize(map, 0));
    const vec2 dy = uv.dy * vec2(textureSize(map, 0));
    return 0.5 * log2(max(max(dot(dx, dx), dot(dy, dy)), 1e-30));
}

/// Filtered as its sampler says, at level (TX-2), or by several probes along the footprint (TX-6).
vec4 read(sampler2D map, TextureSlot slot, Point point)
{
    const Uv uv = uv_of(slot, point);
    const vec2 size = vec2(textureSize(map, 0));
    const vec2 dx = uv.dx * size;
    const vec2 dy = uv.dy * size;
    // 1e-30: a constant coordinate reads level 0 (T1).
    const float x2 = dot(dx, dx);
    const float y2 = dot(dy, dy);
    const float level = 0.5 * log2(max(max(x2, y2), 1e-30));
    if (kProbes == 1u) return textureLod(map, uv.at, level);
    const float ratio = sqrt(max(x2, y2) / max(min(x2, y2), 1e-30));
    const uint count = clamp(uint(ceil(min(0.999 * ratio, 16.0))), 1u, kProbes);
    const vec2 along = x2 >= y2 ? uv.dx : uv.dy;
    vec4 sum = vec4(0.0);
    for (uint i = 1u; i <= count; ++i)
        sum += textureLod(map, uv.at + (float(i) / float(count + 1u) - 0.5) * along, level - log2(float(count)));
    return sum / float(count);
}

/// (SH-2) The normal that a texel of a normal map means.
vec3 mapped_normal(vec3 texel, float scale, Point point)
{
    const vec3 xyz = (2.0 * texel - 1.0) * vec3(scale, scale, 1.0);
    const vec3 t = normalize(point.tangent.xyz);
    const vec3 b = cross(point.n, t) * point.tangent.w;
    return normalize(t * xyz.x + b * xyz.y + point.n * xyz.z);
}

#endif
