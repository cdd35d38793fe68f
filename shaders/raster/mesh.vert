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
layout(location = 6) in vec4 beside;  // of a line: its other end, and on which side of it this corner is; of a point: the corner

layout(location = 0) out vec3 out_position;
layout(location = 1) out vec3 out_normal;
layout(location = 2) out vec4 out_tangent;
layout(location = 3) out vec4 out_uv;
layout(location = 4) out vec4 out_color;

invariant gl_Position;

vec3 to_world(vec3 at)
{
    const vec4 p = vec4(at, 1.0);
    return vec3(dot(draw.object_rows[0], p), dot(draw.object_rows[1], p), dot(draw.object_rows[2], p));
}

/// The part of a line that lies beyond the near plane begins here; `near_end` as it is where that is beyond it.
vec4 before_near(vec4 near_end, vec4 far_end)
{
    const float a = kDepth == 0u ? near_end.w - near_end.z : near_end.z;
    const float b = kDepth == 0u ? far_end.w - far_end.z : far_end.z;
    return a < 0.0 && b > 0.0 ? mix(near_end, far_end, a / (a - b)) : near_end;
}

/// (SH-7) From an end to a corner of the rectangle about the line, over the clip position's w; also behind the viewer,
/// where w is below 0: clipping makes it right.
vec2 across_line(vec4 own, vec4 other)
{
    const vec4 from = before_near(own, other);
    const vec4 to = before_near(other, own);
    const vec2 along = (to.xy / to.w - from.xy / from.w) * frame.size;
    const float size = length(along);
    return size > 0.0 ? vec2(-along.y, along.x) * (frame.line_width / size) / frame.size : vec2(0.0);
}

void main()
{
    out_position = to_world(position);
    out_normal = draw.normal_matrix * normal;
    out_tangent = vec4(dot(draw.object_rows[0].xyz, tangent.xyz), dot(draw.object_rows[1].xyz, tangent.xyz),
                       dot(draw.object_rows[2].xyz, tangent.xyz), tangent.w * draw.handedness);
    out_uv = vec4(uv0, uv1);
    out_color = color;
    gl_Position = frame.clip_from_world * vec4(out_position, 1.0);
    if (kElement == kElementLine) {
        const vec4 other = frame.clip_from_world * vec4(to_world(beside.xyz), 1.0);
        gl_Position.xy += beside.w * gl_Position.w * across_line(gl_Position, other);
    }
    if (kElement == kElementPoint) gl_Position.xy += gl_Position.w * frame.point_size * beside.xy / frame.size;
}
