#version 460
#extension GL_EXT_scalar_block_layout : require
#extension GL_GOOGLE_include_directive : require
// The variance of luminance from those of its channels, as if they varied together: no estimate of it is larger (IP-10).
#include "shaders/post/picture.glsl"
#include "shaders/shared/post.h"

layout(local_size_x = 8, local_size_y = 8) in;
layout(push_constant, scalar) uniform Push { PostVariance push; };

void main()
{
    const ivec2 at = ivec2(gl_GlobalInvocationID.xy);
    if (any(greaterThanEqual(at, push.size))) return;
    const vec4 variance = imageLoad(source, at);
    const float deviation = luminance(sqrt(max(variance.rgb, 0.0)));
    imageStore(result, at, vec4(is_finite(variance) ? deviation * deviation : 0.0, 0.0, 0.0, 0.0));
}
