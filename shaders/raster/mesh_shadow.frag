#version 460
#extension GL_EXT_scalar_block_layout : require
#extension GL_GOOGLE_include_directive : require
// Depth alone, of what a light sees (SH-43).
#include "shaders/raster/mesh_point.glsl"
#include "shaders/raster/surface.glsl"

void main()
{
    if (!kAlphaMask) return;
    const MaterialRecord material = materials[draw.material];
    if (resolve_surface(material, mesh_point()).alpha < material.alpha_cutoff) discard;
}
