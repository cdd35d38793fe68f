#version 460
#extension GL_EXT_scalar_block_layout : require
#extension GL_GOOGLE_include_directive : require
// Reads the blurred grid at each pixel, between its eight cells (IP-9). Alpha stays.
#include "shaders/post/picture.glsl"
#include "shaders/post/grid.glsl"

layout(local_size_x = 8, local_size_y = 8) in;

void main()
{
    const ivec2 at = ivec2(gl_GlobalInvocationID.xy);
    if (any(greaterThanEqual(at, push.size))) return;
    const vec4 centre = imageLoad(source, at);
    if (!is_finite(centre)) {
        imageStore(result, at, centre);
        return;
    }
    const vec3 p = vec3(vec2(at) / push.spacing, level(luminance(centre.rgb)));
    const ivec3 first = min(ivec3(p), ivec3(push.cells, kPostGridLevels) - 2);
    const vec3 f = p - vec3(first);
    vec4 sum = vec4(0.0);
    for (int i = 0; i < 8; ++i) {
        const ivec3 corner = ivec3(i & 1, i >> 1 & 1, i >> 2);
        const vec3 w = mix(1.0 - f, f, vec3(corner));
        sum += (w.x * w.y * w.z) * cells[cell(first + corner)];
    }
    imageStore(result, at, sum.w > 0.0 ? vec4(sum.rgb / sum.w, centre.a) : centre);
}
