#version 460
#extension GL_EXT_scalar_block_layout : require
#extension GL_GOOGLE_include_directive : require
// Radiance to the display's linear [0, 1] (IP-15); colours as they are without premultiplication.
#include "shaders/lib/tone.glsl"
#include "shaders/post/picture.glsl"
#include "shaders/shared/post.h"

layout(local_size_x = 8, local_size_y = 8) in;
layout(push_constant, scalar) uniform Push { PostTone push; };

void main()
{
    const ivec2 at = ivec2(gl_GlobalInvocationID.xy);
    if (any(greaterThanEqual(at, push.size))) return;
    vec4 c = imageLoad(source, at);
    if (is_finite(c)) {
        const float coverage = c.a > 0.0 ? min(c.a, 1.0) : 1.0;
        c.rgb = coverage * clamp(tone(push.curve, max(c.rgb / coverage, 0.0)), 0.0, 1.0);
    }
    imageStore(result, at, c);
}
