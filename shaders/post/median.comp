#version 460
#extension GL_EXT_scalar_block_layout : require
#extension GL_GOOGLE_include_directive : require
// The median of a window, channel by channel (IP-6): a value is the k-th when fewer than k + 1 are below it and more
// than k are not above it. Counting needs no order and no memory.
#include "shaders/post/picture.glsl"
#include "shaders/shared/post.h"

layout(local_size_x = 8, local_size_y = 8) in;
layout(push_constant, scalar) uniform Push { PostMedian push; };

const int kMost = 121;  // 11 x 11
vec4 window[kMost];

void main()
{
    const ivec2 at = ivec2(gl_GlobalInvocationID.xy);
    if (any(greaterThanEqual(at, push.size))) return;
    const vec4 centre = imageLoad(source, at);
    if (!is_finite(centre)) {
        imageStore(result, at, centre);
        return;
    }
    int count = 0;
    for (int y = -push.radius; y <= push.radius; ++y)
        for (int x = -push.radius; x <= push.radius; ++x) {
            const vec4 c = pixel(at + ivec2(x, y), push.size);
            if (is_finite(c)) window[count++] = c;
        }
    const int lower = (count - 1) / 2, upper = count / 2;  // the same for odd counts
    vec4 low = centre, high = centre;
    for (int i = 0; i < count; ++i) {
        ivec4 below = ivec4(0), not_above = ivec4(0);
        for (int j = 0; j < count; ++j) {
            below += ivec4(lessThan(window[j], window[i]));
            not_above += ivec4(lessThanEqual(window[j], window[i]));
        }
        const bvec4 is_low = bvec4(ivec4(lessThanEqual(below, ivec4(lower))) * ivec4(greaterThan(not_above, ivec4(lower))));
        const bvec4 is_high = bvec4(ivec4(lessThanEqual(below, ivec4(upper))) * ivec4(greaterThan(not_above, ivec4(upper))));
        low = mix(low, window[i], is_low);
        high = mix(high, window[i], is_high);
    }
    imageStore(result, at, low == high ? low : low + 0.5 * (high - low));
}
