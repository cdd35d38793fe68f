#version 460
#extension GL_EXT_scalar_block_layout : require
#extension GL_GOOGLE_include_directive : require
#include "shaders/raster/aov.glsl"
#include "shaders/raster/mesh_point.glsl"

void main()
{
    const MaterialRecord material = materials[draw.material];
    const Point point = mesh_point();
    const Surface surface = resolve_surface(material, point);
    if (kAlphaMask && surface.alpha < material.alpha_cutoff) discard;
    write_aovs(surface, point, draw.object_id, draw.material);
}
