// What rays found at the surface that a pixel shows: docs/shading.md (SH-44), (SH-45).
#ifndef ETALON_SHADERS_RASTER_GATHERED_GLSL
#define ETALON_SHADERS_RASTER_GATHERED_GLSL
#include "shaders/raster/frame.glsl"

struct Gathered {
    vec3 light;
    uvec3 lit;
    bool found;
};

/// Takes a pixel's in the place of `best` where it is of the same object and nearer in depth.
void prefer(ivec2 at, float depth, uint object_id, inout float difference, inout Gathered best)
{
    const ivec2 inside = clamp(at, ivec2(0), ivec2(frame.size) - 1);
    const vec4 light = texelFetch(gathered_light, inside, 0);
    const uvec4 lit = texelFetch(gathered_lit, inside, 0);
    const float away = abs(light.a - depth);
    const bool better = lit.w == object_id && away < difference;
    difference = better ? away : difference;
    best.light = better ? light.rgb : best.light;
    best.lit = better ? lit.xyz : best.lit;
    best.found = best.found || better;
}

/// Of this pixel, whose centre shows the surface or, along edges, of the neighbour that shows the same object at the nearest
/// depth. Where none does, nothing is known.
Gathered gathered_at(vec3 position, uint object_id)
{
    const ivec2 own = ivec2(gl_FragCoord.xy);
    const float depth = view_depth(position);
    // Of several blended layers rays start at the first alone.
    float difference = kAlphaBlend ? 0.01 * abs(depth) : 3.4e38;
    Gathered best = Gathered(vec3(0.0), uvec3(0xffffffffu), false);
    prefer(own, depth, object_id, difference, best);
    if (kSamples > 1u)
        for (int y = -1; y <= 1; ++y)
            for (int x = -1; x <= 1; ++x) prefer(own + ivec2(x, y), depth, object_id, difference, best);
    return best;
}

/// Whether rays say that a punctual light reaches the surface.
bool is_lit(Gathered gathered, uint light)
{
    const uint word = light < 32u ? gathered.lit.x : light < 64u ? gathered.lit.y : gathered.lit.z;
    return light >= 96u || ((word >> (light & 31u)) & 1u) != 0u;
}

#endif
