#version 460
#extension GL_EXT_scalar_block_layout : require
#extension GL_GOOGLE_include_directive : require
// One level of the edge-avoiding wavelet (IP-10).
#include "shaders/post/picture.glsl"
#include "shaders/shared/post.h"

layout(local_size_x = 8, local_size_y = 8) in;
layout(set = 0, binding = 2, rgba32f) uniform readonly image2D surface;  // normal, depth
layout(set = 0, binding = 3, rgba32f) uniform readonly image2D albedo;
layout(set = 0, binding = 8, rgba32f) uniform readonly image2D variance;  // of luminance, in x
layout(set = 0, binding = 9, rgba32f) uniform writeonly image2D filtered_variance;
layout(push_constant, scalar) uniform Push { PostAtrous push; };

const float kSpline[3] = float[](0.375, 0.25, 0.0625);

float squared(vec3 v) { return dot(v, v); }

// The square of a relative difference of depths; what is infinitely far is equal to itself alone.
float depth_term(float a, float b, float distance)
{
    if (a == b) return 0.0;
    if (!is_finite(a) || !is_finite(b)) return push.inverse_z > 0.0 ? 1e30 : 0.0;
    const float d = (b - a) / (a * distance) * push.inverse_z;
    return d * d;
}

// The standard deviation of luminance around a pixel: the variance of one pixel is itself noisy.
float deviation(ivec2 at)
{
    float sum = 0.0;
    for (int y = -1; y <= 1; ++y)
        for (int x = -1; x <= 1; ++x) {
            const float w = (x == 0 ? 0.5 : 0.25) * (y == 0 ? 0.5 : 0.25);
            sum += w * imageLoad(variance, clamp(at + ivec2(x, y), ivec2(0), push.size - 1)).x;
        }
    return sqrt(sum);
}

float colour_term(vec4 c, vec4 centre, float deviation)
{
    if (push.guided == 0u) return squared((c.rgb - centre.rgb) * push.inverse_c);
    const float d = abs(luminance(c.rgb) - luminance(centre.rgb)) * push.inverse_c;
    return d == 0.0 ? 0.0 : d / deviation;  // Inf where there is no variance: such a pixel is right as it is
}

void main()
{
    const ivec2 at = ivec2(gl_GlobalInvocationID.xy);
    if (any(greaterThanEqual(at, push.size))) return;
    const vec4 centre = imageLoad(source, at);
    const float own_variance = push.guided == 1u ? imageLoad(variance, at).x : 0.0;
    if (!is_finite(centre)) {
        imageStore(result, at, centre);
        imageStore(filtered_variance, at, vec4(own_variance, 0.0, 0.0, 0.0));
        return;
    }
    const vec4 own_surface = imageLoad(surface, at);
    const vec3 own_albedo = imageLoad(albedo, at).rgb;
    const float width = push.guided == 1u ? deviation(at) : 1.0;
    vec4 sum = vec4(0.0);
    float weights = 0.0, variances = 0.0;
    for (int y = -2; y <= 2; ++y)
        for (int x = -2; x <= 2; ++x) {
            const ivec2 q = clamp(at + push.step * ivec2(x, y), ivec2(0), push.size - 1);
            const vec4 c = imageLoad(source, q);
            if (!is_finite(c)) continue;
            const vec4 there = imageLoad(surface, q);
            const float distance = float(push.step) * sqrt(float(x * x + y * y));
            const float exponent = (x == 0 && y == 0)
                                       ? 0.0
                                       : colour_term(c, centre, width) +
                                             squared((there.xyz - own_surface.xyz) * push.inverse_n) +
                                             squared((imageLoad(albedo, q).rgb - own_albedo) * push.inverse_a) +
                                             depth_term(own_surface.w, there.w, distance);
            if (!(exponent < 80.0)) continue;
            const float w = kSpline[abs(x)] * kSpline[abs(y)] * exp(-exponent);
            sum += w * (c - centre);
            weights += w;
            if (push.guided == 1u) variances += w * w * imageLoad(variance, q).x;
        }
    imageStore(result, at, centre + sum / weights);
    imageStore(filtered_variance, at, vec4(variances / (weights * weights), 0.0, 0.0, 0.0));
}
