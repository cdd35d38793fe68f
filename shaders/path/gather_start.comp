// Looks at the points again, each time through another place of their pixels (the first time through the centres), so that
// textures and creases finer than a pixel are averaged over it.
#version 460
#extension GL_EXT_scalar_block_layout : require
#extension GL_GOOGLE_include_directive : require
#include "shaders/path/gather.glsl"
#include "shaders/path/start.glsl"

layout(local_size_x = kPathWorkgroup) in;

void main()
{
    uint index = gl_GlobalInvocationID.x;
    if (index >= push.slot_count) return;
    store_path(index, start_path(load_point(index).slot, push.first_sample == 0u));
}
