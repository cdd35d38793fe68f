#version 460
#extension GL_EXT_scalar_block_layout : require
#extension GL_GOOGLE_include_directive : require
#include "shaders/raster/frame.glsl"

layout(push_constant, scalar) uniform DrawBlock { RasterDraw draw; };

layout(location = 0) in vec3 position;
layout(location = 1) in vec3 normal;
layout(location = 2) in vec4 tangent;
layout(location = 3) in vec2 uv0;
layout(location = 4) in vec2 uv1;
layout(location = 5) in vec4 color;

layout(location = 0) out vec3 out_position;
layout(location = 1) out vec3 out_normal;
layout(location = 2) out vec4 out_tangent;
layout(location = 3) out vec4 out_uv;
layout(location = 4) out vec4 out_color;

invariant gl_Position;

void main()
{
    const vec4 p = vec4(position, 1.0);
    out_position = vec3(dot(draw.object_rows[0], p), dot(draw.object_rows[1], p), dot(draw.object_rows[2], p));
    out_normal = draw.normal_matrix * normal;
    out_tangent = vec4(dot(draw.object_rows[0].xyz, tangent.xyz), dot(draw.object_rows[1].xyz, tangent.xyz),
                       dot(draw.object_rows[2].xyz, tangent.xyz), tangent.w * draw.handedness);
    out_uv = vec4(uv0, uv1);
    out_color = color;
    gl_Position = frame.clip_from_world * vec4(out_position, 1.0);
    gl_PointSize = 1.0;  // (SH-7)
}
