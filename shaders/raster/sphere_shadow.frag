#version 460
#extension GL_EXT_scalar_block_layout : require
#extension GL_GOOGLE_include_directive : require
// Depth alone, of what a light sees (SH-43).
#include "shaders/raster/sphere_point.glsl"

void main()
{
    vec3 origin, direction, nearest;
    float closest;
    const float enter = meet_sphere(gl_FragCoord.xy, origin, direction, nearest, closest);
    if (enter <= 0.0) discard;
    // Of single-sided spheres the side away from the light: light that comes to their back passes it (SH-6).
    gl_FragDepth = sphere_depth(kCullBack ? max(2.0 * closest - enter, enter) : enter);
}
