// What every post pass sees: the picture, RGBA float32 and premultiplied, and how it is read at its border (IP-1).
layout(set = 0, binding = 0, rgba32f) uniform readonly image2D source;
layout(set = 0, binding = 1, rgba32f) uniform image2D result;

// By its bits: what a device's isnan and isinf promise is little.
bool is_finite(float x) { return (floatBitsToUint(x) & 0x7f800000u) != 0x7f800000u; }
bool is_finite(vec4 x) { return is_finite(x.x) && is_finite(x.y) && is_finite(x.z) && is_finite(x.w); }

// The pixel at `at`, or the nearest one of the picture.
vec4 pixel(ivec2 at, ivec2 size) { return imageLoad(source, clamp(at, ivec2(0), size - 1)); }

// (IP-2)
float luminance(vec3 c) { return (0.2126 * c.r + 0.7152 * c.g) + 0.0722 * c.b; }

// The luminance of a neighbour; one that is not finite counts as the pixel that asks.
float luminance_at(ivec2 at, ivec2 size, float otherwise)
{
    const vec4 c = pixel(at, size);
    return is_finite(c) ? luminance(c.rgb) : otherwise;
}

// sqrt(x^2 + y^2) that neither overflows nor underflows on its way (A3).
float robust_length(float x, float y)
{
    const float a = max(abs(x), abs(y)), b = min(abs(x), abs(y));
    return a > 0.0 ? a * sqrt(1.0 + (b / a) * (b / a)) : 0.0;
}
