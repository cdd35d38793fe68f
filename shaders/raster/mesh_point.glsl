// A point of a mesh, as mesh.vert hands it on.
#ifndef ETALON_SHADERS_RASTER_MESH_POINT_GLSL
#define ETALON_SHADERS_RASTER_MESH_POINT_GLSL
#include "shaders/raster/point.glsl"

layout(push_constant, scalar) uniform DrawBlock { RasterDraw draw; };

layout(location = 0) in vec3 in_position;
layout(location = 1) in vec3 in_normal;
layout(location = 2) in vec4 in_tangent;
layout(location = 3) in vec4 in_uv;
layout(location = 4) in vec4 in_color;

Point mesh_point()
{
    Point p;
    p.position = in_position;
    p.front = kTriangles ? gl_FrontFacing : true;
    p.n = normalize(in_normal);
    p.ng = p.n;
    if (kTriangles && kLit) {
        p.ng = normalize(draw.normal_matrix * face_normals[draw.first_face + uint(gl_PrimitiveID)]);
        if (!kNormals) p.n = p.ng;
    }
    p.tangent = in_tangent;
    const float q = gl_FragCoord.w;
    p.uv[0] = with_derivatives(in_uv.xy, q);
    p.uv[1] = with_derivatives(in_uv.zw, q);
    p.color = in_color;
    p.scale = draw.scale;
    return p;
}

#endif
