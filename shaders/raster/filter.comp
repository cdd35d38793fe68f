#version 460
#extension GL_EXT_scalar_block_layout : require
#extension GL_EXT_samplerless_texture_functions : require
#extension GL_GOOGLE_include_directive : require
// One axis of the reconstruction of a supersampled picture: docs/equations.md (AA-2).
#include "shaders/shared/raster.h"

layout(local_size_x = 8, local_size_y = 8) in;

layout(set = 0, binding = 0) uniform texture2D drawn;
layout(set = 0, binding = 1, rgba32f) writeonly uniform image2D filtered;
layout(set = 0, binding = 2, scalar) readonly buffer WeightBlock { float weights[]; };
layout(push_constant, scalar) uniform FilterBlock { RasterReconstruction pass; };

void main()
{
    const ivec2 at = ivec2(gl_GlobalInvocationID.xy);
    if (any(greaterThanEqual(at, ivec2(pass.size)))) return;
    const bool across = pass.vertical == 0u;
    const ivec2 step = across ? ivec2(1, 0) : ivec2(0, 1);
    const ivec2 line = across ? ivec2(0, at.y) : ivec2(at.x, 0);
    const int end = across ? textureSize(drawn, 0).x : textureSize(drawn, 0).y;
    const int first = (across ? at.x : at.y) * int(pass.per_side) + pass.first;
    vec4 sum = vec4(0.0);
    float total = 0.0;
    // Beyond the border there is nothing: the others share its weight.
    for (int k = max(0, -first); k < int(pass.taps) && first + k < end; ++k) {
        sum += weights[k] * texelFetch(drawn, line + (first + k) * step, 0);
        total += weights[k];
    }
    imageStore(filtered, at, sum / total);
}
