#version 460
#extension GL_EXT_scalar_block_layout : require
#extension GL_GOOGLE_include_directive : require
// One axis of the Gaussian (IP-5). Differences to the centre are summed, so that a constant picture stays what it is.
#include "shaders/post/picture.glsl"
#include "shaders/shared/post.h"

layout(local_size_x = 8, local_size_y = 8) in;
layout(set = 0, binding = 4, scalar) readonly buffer Table { float table[]; };
layout(push_constant, scalar) uniform Push { PostGaussian push; };

void main()
{
    const ivec2 at = ivec2(gl_GlobalInvocationID.xy);
    if (any(greaterThanEqual(at, push.size))) return;
    const vec4 centre = imageLoad(source, at);
    if (!is_finite(centre)) {
        imageStore(result, at, centre);
        return;
    }
    vec4 sum = vec4(0.0), lost = vec4(0.0);
    float weights = 0.0, weights_lost = 0.0;
    for (int i = -push.radius; i <= push.radius; ++i) {
        const vec4 c = pixel(at + i * push.step, push.size);
        if (!is_finite(c)) continue;
        const float w = table[push.kernel + uint(abs(i))];
        // Compensated sums (Kahan 1965): thousands of taps round like one.
        precise const vec4 term = w * (c - centre) - lost;
        precise const vec4 next = sum + term;
        precise const vec4 error = (next - sum) - term;
        sum = next;
        lost = error;
        precise const float w_term = w - weights_lost;
        precise const float w_next = weights + w_term;
        precise const float w_error = (w_next - weights) - w_term;
        weights = w_next;
        weights_lost = w_error;
    }
    imageStore(result, at, centre + sum / weights);
}
