#version 460
#extension GL_EXT_scalar_block_layout : require
#extension GL_GOOGLE_include_directive : require
// Fast approximate antialiasing (IP-14): which way an edge runs, how far its ends are, and how far across it to mix.
#include "shaders/post/picture.glsl"
#include "shaders/shared/post.h"

layout(local_size_x = 8, local_size_y = 8) in;
layout(push_constant, scalar) uniform Push { PostFxaa push; };

// A lone pixel and a diagonal beside constants bend rows and columns alike: that is a row, whatever the rounding.
const float kTie = 1e-4;

// Roughly as bright as it looks: the square root of luminance, which is right where the display's transfer is a square.
float luma_of(vec4 c) { return sqrt(clamp(luminance(c.rgb), 0.0, 1.0)); }
float luma(ivec2 at, float otherwise)
{
    const vec4 c = pixel(at, push.size);
    return is_finite(c) ? luma_of(c) : otherwise;
}

// The second difference.
float bend(float a, float middle, float b) { return abs((a - middle) + (b - middle)); }

// Steps along the edge until its contrast changes, at most push.reach; what the luma differs by there.
int steps_to_end(ivec2 at, ivec2 along, ivec2 across, float own, float middle, float enough, out float difference)
{
    for (int i = 1; i <= push.reach; ++i) {
        const ivec2 there = at + i * along;
        difference = 0.5 * (luma(there, own) + luma(there + across, own)) - middle;
        if (abs(difference) >= enough) return i;
    }
    return push.reach;
}

void main()
{
    const ivec2 at = ivec2(gl_GlobalInvocationID.xy);
    if (any(greaterThanEqual(at, push.size))) return;
    const vec4 centre = imageLoad(source, at);
    imageStore(result, at, centre);
    if (!is_finite(centre)) return;
    float l[3][3];  // [y][x]
    const float own = luma_of(centre);
    for (int y = 0; y < 3; ++y)
        for (int x = 0; x < 3; ++x) l[y][x] = luma(at + ivec2(x - 1, y - 1), own);
    const float brightest = max(max(max(l[0][1], l[2][1]), max(l[1][0], l[1][2])), own);
    const float darkest = min(min(min(l[0][1], l[2][1]), min(l[1][0], l[1][2])), own);
    const float range = brightest - darkest;
    if (range == 0.0 || range < max(push.least, push.threshold * brightest)) return;

    const float corners = l[0][0] + l[0][2] + l[2][0] + l[2][2];
    const float sides = l[0][1] + l[2][1] + l[1][0] + l[1][2];
    const float lone = clamp(abs((2.0 * sides + corners) / 12.0 - own) / range, 0.0, 1.0);
    const float softened = lone * lone * (3.0 - 2.0 * lone);
    const float subpixel = softened * softened * push.subpixel;

    const float rows =
        bend(l[0][0], l[1][0], l[2][0]) + 2.0 * bend(l[0][1], own, l[2][1]) + bend(l[0][2], l[1][2], l[2][2]);
    const float columns =
        bend(l[0][0], l[0][1], l[0][2]) + 2.0 * bend(l[1][0], own, l[1][2]) + bend(l[2][0], l[2][1], l[2][2]);
    const bool horizontal = rows + kTie >= columns;
    const float before = horizontal ? l[0][1] : l[1][0], after = horizontal ? l[2][1] : l[1][2];
    const bool towards_before = abs(before - own) >= abs(after - own);
    const float across_luma = towards_before ? before : after;
    const ivec2 across = (horizontal ? ivec2(0, 1) : ivec2(1, 0)) * (towards_before ? -1 : 1);
    const ivec2 along = horizontal ? ivec2(1, 0) : ivec2(0, 1);
    const float middle = 0.5 * (own + across_luma);
    const float enough = 0.25 * abs(across_luma - own);

    float back_difference, fore_difference;
    const int back = steps_to_end(at, -along, across, own, middle, enough, back_difference);
    const int fore = steps_to_end(at, along, across, own, middle, enough, fore_difference);
    const float end = back < fore ? back_difference : fore_difference;
    // Only on the side of the edge where the nearer end turns away from this pixel.
    const bool bends_here = (own < middle) != (end < 0.0);
    const float edge = bends_here ? 0.5 - float(min(back, fore)) / float(back + fore) : 0.0;
    const vec4 other = pixel(at + across, push.size);
    if (is_finite(other)) imageStore(result, at, centre + max(edge, subpixel) * (other - centre));
}
