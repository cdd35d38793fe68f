#version 460
#extension GL_EXT_scalar_block_layout : require
#extension GL_GOOGLE_include_directive : require
#include "tests/gpu/device_echo.h"
// Reads what the host has filled, and counts the structs that are as they should be: through OpenGL's own layouts.
layout(local_size_x = 1) in;
layout(scalar, set = 0, binding = 0) readonly buffer Materials
{
    MaterialRecord materials[];
};
layout(scalar, set = 0, binding = 1) readonly buffer Lights
{
    LightRecord lights[];
};
layout(scalar, set = 0, binding = 2) readonly buffer Frame
{
    RasterFrame frame;
};
layout(scalar, set = 0, binding = 3) readonly buffer Emitters
{
    EmitterRecord emitters[];
};
layout(scalar, set = 0, binding = 4) readonly buffer Layers
{
    LayerRecord layers[];
};
layout(scalar, set = 0, binding = 5) readonly buffer Normals
{
    vec3 normals[];
};
layout(set = 0, binding = 6) writeonly buffer Verdicts
{
    uint verdicts[];
};
layout(push_constant, scalar) uniform Draw
{
    RasterDraw draw;
};

void main()
{
    const uint i = gl_GlobalInvocationID.x;
    const uint n = 1000u * i;
    MaterialRecord material;
    fill_echo(material, n);
    LightRecord light;
    fill_echo(light, n);
    RasterFrame whole;
    fill_echo(whole, 0u);
    EmitterRecord emitter;
    fill_echo(emitter, n);
    LayerRecord layer;
    fill_echo(layer, n);
    RasterDraw pushed;
    fill_echo(pushed, 7u);
    uint right = 0u;
    if (materials[i] == material) right |= 1u;
    if (lights[i] == light) right |= 2u;
    if (frame == whole) right |= 4u;
    if (emitters[i] == emitter) right |= 8u;
    if (layers[i] == layer) right |= 16u;
    if (normals[i] == vec3(n, n + 1u, n + 2u)) right |= 32u;
    if (draw == pushed) right |= 64u;
    verdicts[i] = right;
}
