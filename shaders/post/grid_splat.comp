#version 460
#extension GL_EXT_scalar_block_layout : require
#extension GL_GOOGLE_include_directive : require
// Splats pixels by tents (IP-9): each invocation gathers for one column of cells, so that nobody else writes there.
#include "shaders/post/picture.glsl"
#include "shaders/post/grid.glsl"

layout(local_size_x = 8, local_size_y = 8) in;

void main()
{
    const ivec2 column = ivec2(gl_GlobalInvocationID.xy);
    if (any(greaterThanEqual(column, push.cells))) return;
    for (int k = 0; k < kPostGridLevels; ++k) cells[cell(ivec3(column, k))] = vec4(0.0);
    const vec2 centre = vec2(column) * push.spacing;
    const ivec2 first = max(ivec2(ceil(centre - push.spacing)), ivec2(0));
    const ivec2 last = min(ivec2(floor(centre + push.spacing)), push.size - 1);
    for (int y = first.y; y <= last.y; ++y)
        for (int x = first.x; x <= last.x; ++x) {
            const vec4 c = imageLoad(source, ivec2(x, y));
            if (!is_finite(c)) continue;
            const vec2 tent = max(vec2(0.0), 1.0 - abs(vec2(x, y) - centre) / push.spacing);
            const float w = tent.x * tent.y;
            const float z = level(luminance(c.rgb));
            const int k = min(int(z), kPostGridLevels - 2);
            const float f = z - float(k);
            cells[cell(ivec3(column, k))] += (w * (1.0 - f)) * vec4(c.rgb, 1.0);
            cells[cell(ivec3(column, k + 1))] += (w * f) * vec4(c.rgb, 1.0);
        }
}
