#version 460
#extension GL_EXT_scalar_block_layout : require
#extension GL_GOOGLE_include_directive : require
#include "shaders/raster/aov.glsl"
#include "shaders/raster/sphere_point.glsl"

void main()
{
    if (covered_samples(gl_FragCoord.xy - 0.5) == 0) discard;
    float t;
    const Point point = sphere_point(gl_FragCoord.xy, t);
    const MaterialRecord material = materials[sphere.material];
    const Surface surface = resolve_surface(material, point);
    if (kAlphaMask && surface.alpha < material.alpha_cutoff) discard;
    gl_FragDepth = sphere_depth(t);
    write_aovs(surface, point, sphere.object_id, sphere.material);
}
