#version 460
#extension GL_EXT_scalar_block_layout : require
#extension GL_GOOGLE_include_directive : require
// Blurs the grid along one axis (IP-9); outside of it is nothing.
#include "shaders/post/grid.glsl"

layout(local_size_x = 8, local_size_y = 8) in;
layout(set = 0, binding = 4, scalar) readonly buffer Table { float table[]; };
layout(set = 0, binding = 7, scalar) writeonly buffer Blurred { vec4 blurred[]; };

void main()
{
    const ivec3 at = ivec3(gl_GlobalInvocationID);
    const ivec3 count = ivec3(push.cells, kPostGridLevels);
    if (any(greaterThanEqual(at, count))) return;
    vec4 sum = vec4(0.0);
    const int first = max(-kPostGridRadius, -at[push.axis]);
    const int last = min(kPostGridRadius, count[push.axis] - 1 - at[push.axis]);
    for (int i = first; i <= last; ++i) {
        ivec3 from = at;
        from[push.axis] += i;
        sum += table[push.kernel + uint(abs(i))] * cells[cell(from)];
    }
    blurred[cell(at)] = sum;
}
