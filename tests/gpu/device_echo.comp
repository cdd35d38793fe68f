#version 460
#extension GL_GOOGLE_include_directive : require
#include "tests/gpu/device_kernel.glsl"
#include "tests/gpu/device_echo.h"

// One array of each shared struct; invocation i fills element i. Counts in words keep the numbers of two elements apart.
layout(scalar, set = 0, binding = 0) writeonly buffer Materials { MaterialRecord materials[]; };
layout(scalar, set = 0, binding = 1) writeonly buffer Lights { LightRecord lights[]; };

void main()
{
    const uint i = kernel_index();
    if (i >= count) return;
    const uint n = 1000u * i;
    MaterialRecord material;
    fill_echo(material, n);
    materials[i] = material;
    LightRecord light;
    fill_echo(light, n);
    lights[i] = light;
}
