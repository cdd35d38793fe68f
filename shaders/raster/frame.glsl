// What every draw of a frame reads.
#ifndef ETALON_SHADERS_RASTER_FRAME_GLSL
#define ETALON_SHADERS_RASTER_FRAME_GLSL
#include "shaders/lib/numeric.glsl"
#include "shaders/raster/features.glsl"
#include "shaders/shared/material.h"
#include "shaders/shared/raster.h"

layout(set = 0, binding = 0, scalar) readonly buffer FrameBlock { RasterFrame frame; };
layout(set = 0, binding = 1, scalar) readonly buffer MaterialBlock { MaterialRecord materials[]; };
layout(set = 0, binding = 2, scalar) readonly buffer LightBlock { LightRecord lights[]; };
layout(set = 0, binding = 3, scalar) readonly buffer FaceBlock { vec3 face_normals[]; };  // object space, unit
layout(set = 0, binding = 4, scalar) readonly buffer EmitterBlock { EmitterRecord emitters[]; };
layout(set = 0, binding = 5) uniform texture2D environment_atlas;
layout(set = 0, binding = 6, scalar) readonly buffer LayerBlock { LayerRecord layer_records[]; };
layout(set = 0, binding = 7, scalar) readonly buffer AlbedoBlock { vec4 albedo_cells[]; };  // shaders/shared/albedo.h
layout(set = 0, binding = 8) uniform texture2D picture_behind;  // levels of seen.glsl; black but for transmission
layout(set = 0, binding = 9, scalar) readonly buffer ShadowBlock { RasterShadow shadows[]; };
layout(set = 0, binding = 10, scalar) readonly buffer ShadowDepthBlock { float shadow_depths[]; };
layout(set = 0, binding = 11) uniform texture2D gathered_light;  // rgb, metres along the viewing axis (gathered.glsl)
layout(set = 0, binding = 12) uniform utexture2D gathered_lit;   // a bit for each of 96 lights, object

vec4 albedo_cell(int index) { return albedo_cells[index]; }

/// Towards the viewer from a surface point.
vec3 towards_viewer(vec3 position)
{
    return kOrthographic ? frame.world_from_camera[2] : -normalize(position);
}

/// The ray through a film position in pixels: camera-relative world space, one metre along the viewing axis per t.
void film_ray(vec2 pixel, out vec3 origin, out vec3 direction)
{
    const vec2 film = vec2(2.0 * pixel.x / frame.size.x - 1.0, 1.0 - 2.0 * pixel.y / frame.size.y) * frame.film_half;
    origin = kOrthographic ? frame.world_from_camera * vec3(film, 0.0) : vec3(0.0);
    direction = frame.world_from_camera * (kOrthographic ? vec3(0.0, 0.0, -1.0) : vec3(film, -1.0));
}

/// Metres along the viewing axis.
float view_depth(vec3 position)
{
    return -dot(position, frame.world_from_camera[2]);
}

#endif
