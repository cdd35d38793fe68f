#version 460
#extension GL_EXT_scalar_block_layout : require
#extension GL_GOOGLE_include_directive : require
// Exposure and vignette: (IP-3), (IP-4).
#include "shaders/post/picture.glsl"
#include "shaders/shared/post.h"

layout(local_size_x = 8, local_size_y = 8) in;
layout(set = 0, binding = 4, scalar) readonly buffer Table { float table[]; };
layout(push_constant, scalar) uniform Push { PostScale push; };

void main()
{
    const ivec2 at = ivec2(gl_GlobalInvocationID.xy);
    if (any(greaterThanEqual(at, push.size))) return;
    const vec2 from_centre = vec2(2 * at + 1 - push.size);
    const vec2 half_diagonal = vec2(push.size);
    const float r2 = dot(from_centre, from_centre) / dot(half_diagonal, half_diagonal);
    const float one_over_cos2 = 1.0 + push.falloff * r2;
    const float factor = table[push.factor] / (one_over_cos2 * one_over_cos2);
    vec4 c = imageLoad(source, at);
    c.rgb *= factor;
    if (push.squared == 1u) c.rgb *= factor;
    imageStore(result, at, c);
}
