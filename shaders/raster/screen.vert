#version 460
#extension GL_GOOGLE_include_directive : require
#include "shaders/raster/features.glsl"

// One triangle that covers the whole target, as far as can be.
void main()
{
    const vec2 corner = vec2(gl_VertexIndex & 1, gl_VertexIndex >> 1);
    gl_Position = vec4(4.0 * corner - 1.0, kDepth == 0u ? 0.0 : 1.0, 1.0);
}
