#version 460
#extension GL_EXT_scalar_block_layout : require
#extension GL_GOOGLE_include_directive : require
// The bilateral filter over a window (IP-7), or over one axis of it (IP-8). Rows are summed by themselves, so that
// rounding grows with the side of the window and not with its area.
#include "shaders/post/picture.glsl"
#include "shaders/shared/post.h"

layout(local_size_x = 8, local_size_y = 8) in;
layout(push_constant, scalar) uniform Push { PostBilateral push; };

void main()
{
    const ivec2 at = ivec2(gl_GlobalInvocationID.xy);
    if (any(greaterThanEqual(at, push.size))) return;
    const vec4 centre = imageLoad(source, at);
    if (!is_finite(centre)) {
        imageStore(result, at, centre);
        return;
    }
    vec4 sum = vec4(0.0);
    float weights = 0.0;
    for (int y = -push.reach.y; y <= push.reach.y; ++y) {
        vec4 row = vec4(0.0);
        float row_weights = 0.0;
        for (int x = -push.reach.x; x <= push.reach.x; ++x) {
            const vec4 c = pixel(at + ivec2(x, y), push.size);
            if (!is_finite(c)) continue;
            const vec4 difference = c - centre;
            const vec2 s = vec2(x, y) * push.inverse_s;
            const vec3 r = difference.rgb * push.inverse_r;  // the quotient first: its square may overflow, to no harm (I1)
            const float exponent = 0.5 * (dot(s, s) + dot(r, r));
            if (!(exponent < 80.0)) continue;
            const float w = exp(-exponent);
            row += w * difference;
            row_weights += w;
        }
        sum += row;
        weights += row_weights;
    }
    imageStore(result, at, centre + sum / weights);
}
