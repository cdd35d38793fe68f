// Look-ups in the tables of directional albedo: the rows are the cells, then what to look up.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "tests/gpu/device_kernel.glsl"

layout(scalar, set = 0, binding = 0) readonly buffer Inputs { vec4 inputs[]; };
layout(scalar, set = 0, binding = 1) writeonly buffer Outputs { vec4 outputs[]; };
vec4 albedo_cell(int index) { return inputs[index]; }
#include "shaders/lib/albedo.glsl"

void main()
{
    const uint i = kernel_index();
    if (i >= count) return;
    const vec4 row = inputs[i];  // cosine, alpha, roughness of the sheen
    outputs[i] = i < kAlbedoCells ? vec4(0.0) : vec4(ggx_albedo(row.x, row.y), sheen_albedo(row.x, row.z), 0.0, 0.0);
}
