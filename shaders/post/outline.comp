#version 460
#extension GL_EXT_scalar_block_layout : require
#extension GL_GOOGLE_include_directive : require
// Lines where inverse depth or normal jump (IP-13). Inverse depth is 0 where there is nothing: no infinities.
#include "shaders/post/picture.glsl"
#include "shaders/shared/post.h"

layout(local_size_x = 8, local_size_y = 8) in;
layout(set = 0, binding = 2, rgba32f) uniform readonly image2D surface;  // normal, depth
layout(push_constant, scalar) uniform Push { PostOutline push; };

// Normal, and inverse depth in w.
vec4 surface_at(ivec2 at)
{
    const vec4 s = imageLoad(surface, clamp(at, ivec2(0), push.size - 1));
    const vec3 n = is_finite(vec4(s.xyz, 0.0)) ? s.xyz : vec3(0.0);
    return vec4(n, is_finite(s.w) && s.w > 0.0 ? 1.0 / s.w : 0.0);
}

void main()
{
    const ivec2 at = ivec2(gl_GlobalInvocationID.xy);
    if (any(greaterThanEqual(at, push.size))) return;
    const vec4 centre = imageLoad(source, at);
    if (!is_finite(centre)) {
        imageStore(result, at, centre);
        return;
    }
    vec4 gx = vec4(0.0), gy = vec4(0.0);
    float nearest = 0.0;
    for (int y = -1; y <= 1; ++y)
        for (int x = -1; x <= 1; ++x) {
            const vec4 s = surface_at(at + ivec2(x, y));
            gx += 0.125 * float(x * (2 - abs(y))) * s;
            gy += 0.125 * float(y * (2 - abs(x))) * s;
            nearest = max(nearest, s.w);
        }
    const float normal = sqrt(dot(gx.xyz, gx.xyz) + dot(gy.xyz, gy.xyz)) * push.inverse_normal;
    const float depth = nearest > 0.0 ? robust_length(gx.w, gy.w) / nearest * push.inverse_depth : 0.0;
    const float line = push.strength * clamp(max(normal, depth), 0.0, 1.0);
    imageStore(result, at, vec4(centre.rgb * (1.0 - line), centre.a + line * (1.0 - centre.a)));
}
