#version 460
#extension GL_EXT_scalar_block_layout : require
#extension GL_EXT_samplerless_texture_functions : require
#extension GL_GOOGLE_include_directive : require
#include "shaders/raster/light.glsl"
#include "shaders/raster/mesh_point.glsl"

layout(location = 0) out vec4 color;

void main()
{
    const MaterialRecord material = materials[draw.material];
    const Point point = mesh_point();
    const Surface surface = resolve_surface(material, point);
    if (kAlphaMask && surface.alpha < material.alpha_cutoff) discard;
    color = shade(surface, point.position, draw.object_id);
}
