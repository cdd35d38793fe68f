#version 460
#extension GL_EXT_scalar_block_layout : require
#extension GL_EXT_samplerless_texture_functions : require
#extension GL_GOOGLE_include_directive : require
#include "shaders/raster/light.glsl"
#include "shaders/raster/sphere_point.glsl"

layout(location = 0) out vec4 color;

void main()
{
    const int covered = covered_samples(gl_FragCoord.xy - 0.5);
    if (covered == 0) discard;
    float t;
    const Point point = sphere_point(gl_FragCoord.xy, t);
    const MaterialRecord material = materials[sphere.material];
    const Surface surface = resolve_surface(material, point);
    if (kAlphaMask && surface.alpha < material.alpha_cutoff) discard;
    gl_SampleMask[0] = covered;
    gl_FragDepth = sphere_depth(t);
    color = shade(surface, point.position, sphere.object_id);
}
