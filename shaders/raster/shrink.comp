#version 460
#extension GL_EXT_scalar_block_layout : require
#extension GL_EXT_samplerless_texture_functions : require
#extension GL_GOOGLE_include_directive : require
// One level of the picture behind transmitting surfaces: level 0 is the picture, each other one the exact area average of the
// one above (TX-4).
#include "shaders/raster/levels.glsl"
#include "shaders/shared/raster.h"

layout(local_size_x = 8, local_size_y = 8) in;

layout(set = 0, binding = 0) uniform texture2D picture;
layout(set = 0, binding = 1, rgba32f) uniform image2D levels;
layout(push_constant, scalar) uniform ShrinkBlock { RasterShrink shrink; };

// Texel s of n covers [s m, (s + 1) m) of n m parts, one of m covers [i n, (i + 1) n): integers, so no rounding.
int overlap(int i, int s, int n, int m) { return min((i + 1) * n, (s + 1) * m) - max(i * n, s * m); }

void main()
{
    const ivec2 whole = ivec2(shrink.size);
    const int level = int(shrink.level);
    const ivec2 size = level_size(whole, level);
    const ivec2 at = ivec2(gl_GlobalInvocationID.xy);
    if (any(greaterThanEqual(at, size))) return;
    if (level == 0) {
        imageStore(levels, at, texelFetch(picture, at, 0));
        return;
    }
    const ivec2 above = level_size(whole, level - 1);
    const ivec2 from = level_corner(whole, level - 1);
    const ivec2 first = at * above / size;
    vec4 sum = vec4(0.0);
    for (int y = first.y; y < above.y && y * size.y < (at.y + 1) * above.y; ++y)
        for (int x = first.x; x < above.x && x * size.x < (at.x + 1) * above.x; ++x)
            sum += float(overlap(at.x, x, above.x, size.x) * overlap(at.y, y, above.y, size.y)) *
                   imageLoad(levels, from + ivec2(x, y));
    imageStore(levels, level_corner(whole, level) + at, sum / (float(above.x) * float(above.y)));
}
