#version 460
#extension GL_EXT_scalar_block_layout : require
#extension GL_GOOGLE_include_directive : require
// The gradient of luminance (IP-12). Both axes sum in the same order: a transposed picture swaps them bit for bit (I2).
#include "shaders/post/picture.glsl"
#include "shaders/shared/post.h"

layout(local_size_x = 8, local_size_y = 8) in;
layout(push_constant, scalar) uniform Push { PostSobel push; };

void main()
{
    const ivec2 at = ivec2(gl_GlobalInvocationID.xy);
    if (any(greaterThanEqual(at, push.size))) return;
    const vec4 centre = imageLoad(source, at);
    if (!is_finite(centre)) {
        imageStore(result, at, centre);
        return;
    }
    const float own = luminance(centre.rgb);
    float side[2][2] = float[2][2](float[2](0.0, 0.0), float[2](0.0, 0.0));  // [axis][before or after]
    for (int axis = 0; axis < 2; ++axis)
        for (int after = 0; after < 2; ++after)
            for (int i = -1; i <= 1; ++i) {
                const int across = 2 * after - 1;
                const ivec2 offset = axis == 0 ? ivec2(across, i) : ivec2(i, across);
                side[axis][after] += (i == 0 ? 0.25 : 0.125) * luminance_at(at + offset, push.size, own);
            }
    const float gradient = push.gain * robust_length(side[0][1] - side[0][0], side[1][1] - side[1][0]);
    imageStore(result, at, vec4(vec3(gradient), centre.a));
}
