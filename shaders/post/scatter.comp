#version 460
#extension GL_EXT_scalar_block_layout : require
#extension GL_GOOGLE_include_directive : require
// Adds what one Gaussian of a bloom scatters to a pixel and takes away from it (IP-11).
#include "shaders/post/picture.glsl"
#include "shaders/shared/post.h"

layout(local_size_x = 8, local_size_y = 8) in;
layout(set = 0, binding = 2, rgba32f) uniform readonly image2D bright;
layout(push_constant, scalar) uniform Push { PostBloom push; };

void main()
{
    const ivec2 at = ivec2(gl_GlobalInvocationID.xy);
    if (any(greaterThanEqual(at, push.size))) return;
    vec4 c = imageLoad(result, at);
    if (!is_finite(c)) return;
    c.rgb += push.share * (imageLoad(source, at).rgb - imageLoad(bright, at).rgb);
    imageStore(result, at, c);
}
