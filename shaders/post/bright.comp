#version 460
#extension GL_EXT_scalar_block_layout : require
#extension GL_GOOGLE_include_directive : require
// What a bloom scatters (IP-11): light above a luminance, in its own colour.
#include "shaders/post/picture.glsl"
#include "shaders/shared/post.h"

layout(local_size_x = 8, local_size_y = 8) in;
layout(push_constant, scalar) uniform Push { PostBloom push; };

void main()
{
    const ivec2 at = ivec2(gl_GlobalInvocationID.xy);
    if (any(greaterThanEqual(at, push.size))) return;
    vec4 c = imageLoad(source, at);
    if (is_finite(c) && push.threshold > 0.0) {
        const float y = luminance(c.rgb);
        c.rgb *= y > push.threshold ? (y - push.threshold) / y : 0.0;
    }
    imageStore(result, at, c);
}
