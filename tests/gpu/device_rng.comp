#version 460
#extension GL_GOOGLE_include_directive : require
#include "tests/gpu/device_kernel.glsl"
#include "shaders/shared/rng.h"

struct Drawn {
    uvec4 bits;
    float unit;
};
layout(scalar, set = 0, binding = 0) readonly buffer Inputs { uvec4 inputs[]; };
layout(scalar, set = 0, binding = 1) writeonly buffer Outputs { Drawn outputs[]; };

void main()
{
    const uint i = kernel_index();
    if (i >= count) return;
    const uvec4 bits = random_bits(inputs[i].x, inputs[i].y, inputs[i].z, inputs[i].w);
    outputs[i] = Drawn(bits, unit_float(bits.x));
}
