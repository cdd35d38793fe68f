// What the AOV pass writes of a surface: docs of Aovs, engine/image/film.h.
#ifndef ETALON_SHADERS_RASTER_AOV_GLSL
#define ETALON_SHADERS_RASTER_AOV_GLSL
#include "shaders/raster/surface.glsl"

layout(location = 0) out vec4 normal_depth;
layout(location = 1) out vec4 albedo_u;
layout(location = 2) out vec4 emission_v;
layout(location = 3) out uvec2 ids;  // object, material

void write_aovs(Surface s, Point point, uint object_id, uint material_index)
{
    const vec3 emission = kModel == kModelUnlit ? s.base : s.emission;  // (SH-15)
    normal_depth = vec4(s.n, view_depth(point.position));
    albedo_u = vec4(s.base, point.uv[0].at.x);
    emission_v = vec4(emission, point.uv[0].at.y);
    ids = uvec2(object_id, material_index + 1u);
}

#endif
