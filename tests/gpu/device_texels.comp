#version 460
#extension GL_GOOGLE_include_directive : require
#include "tests/gpu/device_kernel.glsl"

// Reads whole texels the way the path tracer does, and writes them to a storage block.
layout(set = 0, binding = 0, rgba32ui) uniform readonly uimageBuffer words;
layout(set = 0, binding = 1, rgba32f) uniform readonly imageBuffer numbers;
layout(set = 0, binding = 2) uniform samplerBuffer sampled;
layout(scalar, set = 0, binding = 3) writeonly buffer Outputs { uvec4 outputs[]; };

void main()
{
    const int i = int(kernel_index());
    if (i >= int(count)) return;
    outputs[3 * i] = imageLoad(words, i);
    outputs[3 * i + 1] = floatBitsToUint(imageLoad(numbers, i));
    outputs[3 * i + 2] = floatBitsToUint(texelFetch(sampled, i));
}
