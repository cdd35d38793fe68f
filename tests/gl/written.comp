#version 460
#extension GL_EXT_scalar_block_layout : require
// A block that is written in a layout which OpenGL has not.
layout(local_size_x = 1) in;
layout(scalar, set = 0, binding = 0) buffer Points
{
    vec3 points[];
};

void main()
{
    points[gl_GlobalInvocationID.x] += 1.0;
}
