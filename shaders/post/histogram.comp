#version 460
#extension GL_EXT_scalar_block_layout : require
#extension GL_GOOGLE_include_directive : require
// How often each luminance occurs, for automatic exposure (IP-3). A bin is the exponent and the first four bits of the
// mantissa: exact, and 2^k times the light moves every count by 16 k bins.
#include "shaders/post/picture.glsl"
#include "shaders/shared/post.h"

layout(local_size_x = 8, local_size_y = 8) in;
layout(set = 0, binding = 5, scalar) buffer Counts { uint counts[]; };
layout(push_constant, scalar) uniform Push { PostMeter push; };

void main()
{
    const ivec2 at = ivec2(gl_GlobalInvocationID.xy);
    if (any(greaterThanEqual(at, push.size))) return;
    const vec4 c = imageLoad(source, at);
    const float y = luminance(c.rgb);
    if (is_finite(c) && is_finite(y) && y >= 1.17549435e-38) atomicAdd(counts[floatBitsToUint(y) >> kPostBinShift], 1u);
}
