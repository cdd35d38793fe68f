// sobol_bits over a table.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "tests/gpu/device_kernel.glsl"
#include "shaders/shared/sobol.h"

layout(scalar, set = 0, binding = 0) readonly buffer Inputs { uvec4 inputs[]; };
layout(scalar, set = 0, binding = 1) writeonly buffer Outputs { uvec4 outputs[]; };

void main()
{
    const uint i = kernel_index();
    if (i >= count) return;
    outputs[i] = sobol_bits(inputs[i].x, inputs[i].y, inputs[i].z, inputs[i].w);
}
