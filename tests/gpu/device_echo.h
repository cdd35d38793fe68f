// Fills every field of every shared struct with numbers of its own, by one text for C++ and GLSL: what the device
// writes must then be what the host writes, byte for byte.
#ifndef ETALON_TESTS_GPU_DEVICE_ECHO_H
#define ETALON_TESTS_GPU_DEVICE_ECHO_H
#include "shaders/shared/material.h"
#include "shaders/shared/path.h"
#include "shaders/shared/raster.h"
ETALON_SHARED_BEGIN

ETALON_FUNCTION uint next_uint(ETALON_INOUT(uint) n)
{
    n += 1u;
    return n;
}

ETALON_FUNCTION float next_float(ETALON_INOUT(uint) n)
{
    return float(next_uint(n));
}

ETALON_FUNCTION uvec2 next_uvec2(ETALON_INOUT(uint) n)
{
    uvec2 v;
    v.x = next_uint(n);
    v.y = next_uint(n);
    return v;
}

ETALON_FUNCTION vec2 next_vec2(ETALON_INOUT(uint) n)
{
    vec2 v;
    v.x = next_float(n);
    v.y = next_float(n);
    return v;
}

ETALON_FUNCTION vec3 next_vec3(ETALON_INOUT(uint) n)
{
    vec3 v;
    v.x = next_float(n);
    v.y = next_float(n);
    v.z = next_float(n);
    return v;
}

ETALON_FUNCTION vec4 next_vec4(ETALON_INOUT(uint) n)
{
    vec4 v;
    v.x = next_float(n);
    v.y = next_float(n);
    v.z = next_float(n);
    v.w = next_float(n);
    return v;
}

ETALON_FUNCTION mat3 next_mat3(ETALON_INOUT(uint) n)
{
    mat3 m;
    for (int column = 0; column < 3; ++column) m[column] = next_vec3(n);
    return m;
}

ETALON_FUNCTION mat4 next_mat4(ETALON_INOUT(uint) n)
{
    mat4 m;
    for (int column = 0; column < 4; ++column) m[column] = next_vec4(n);
    return m;
}

ETALON_FUNCTION TextureSlot next_slot(ETALON_INOUT(uint) n)
{
    TextureSlot slot;
    slot.u_row = next_vec3(n);
    slot.v_row = next_vec3(n);
    slot.texture = next_uint(n);
    slot.uv_set = next_uint(n);
    return slot;
}

ETALON_FUNCTION void fill_echo(ETALON_INOUT(MaterialRecord) r, uint n)
{
    r.base_color = next_vec4(n);
    r.emission = next_vec3(n);
    r.metallic = next_float(n);
    r.eta = next_vec3(n);
    r.roughness = next_float(n);
    r.k = next_vec3(n);
    r.alpha_cutoff = next_float(n);
    r.normal_scale = next_float(n);
    r.occlusion_strength = next_float(n);
    r.ggx_alpha = next_float(n);
    r.model = next_uint(n);
    r.flags = next_uint(n);
    r.base_color_texture = next_slot(n);
    r.metallic_roughness_texture = next_slot(n);
    r.normal_texture = next_slot(n);
    r.occlusion_texture = next_slot(n);
    r.emissive_texture = next_slot(n);
    r.layers = next_uint(n);
}

ETALON_FUNCTION void fill_echo(ETALON_INOUT(LayerRecord) r, uint n)
{
    r.specular_color = next_vec3(n);
    r.specular = next_float(n);
    r.sheen_color = next_vec3(n);
    r.sheen_roughness = next_float(n);
    r.absorption = next_vec3(n);
    r.thickness = next_float(n);
    r.diffuse_transmission_color = next_vec3(n);
    r.diffuse_transmission = next_float(n);
    r.ior = next_float(n);
    r.dispersion = next_float(n);
    r.clearcoat = next_float(n);
    r.clearcoat_roughness = next_float(n);
    r.clearcoat_normal_scale = next_float(n);
    r.transmission = next_float(n);
    r.iridescence = next_float(n);
    r.iridescence_ior = next_float(n);
    r.iridescence_thickness_min = next_float(n);
    r.iridescence_thickness_max = next_float(n);
    r.anisotropy = next_float(n);
    r.anisotropy_cos = next_float(n);
    r.anisotropy_sin = next_float(n);
    r.specular_texture = next_slot(n);
    r.specular_color_texture = next_slot(n);
    r.clearcoat_texture = next_slot(n);
    r.clearcoat_roughness_texture = next_slot(n);
    r.clearcoat_normal_texture = next_slot(n);
    r.sheen_color_texture = next_slot(n);
    r.sheen_roughness_texture = next_slot(n);
    r.transmission_texture = next_slot(n);
    r.thickness_texture = next_slot(n);
    r.iridescence_texture = next_slot(n);
    r.iridescence_thickness_texture = next_slot(n);
    r.anisotropy_texture = next_slot(n);
    r.diffuse_transmission_texture = next_slot(n);
    r.diffuse_transmission_color_texture = next_slot(n);
}

ETALON_FUNCTION void fill_echo(ETALON_INOUT(LightRecord) r, uint n)
{
    r.color_intensity = next_vec3(n);
    r.type = next_uint(n);
    r.position = next_vec3(n);
    r.range = next_float(n);
    r.direction = next_vec3(n);
    r.spot_scale = next_float(n);
    r.spot_offset = next_float(n);
}

ETALON_FUNCTION void fill_echo(ETALON_INOUT(RasterFrame) r, uint n)
{
    r.clip_from_world = next_mat4(n);
    r.world_from_camera = next_mat3(n);
    r.environment_radiance = next_vec3(n);
    r.environment_turn = next_vec2(n);
    r.environment_scale = next_float(n);
    r.film_half = next_vec2(n);
    r.size = next_vec2(n);
    r.depth_range = next_vec2(n);
    r.mirror_size = next_uvec2(n);
    r.light_count = next_uint(n);
    r.emitter_count = next_uint(n);
    r.background = next_vec4(n);
    r.point_size = next_float(n);
    r.line_width = next_float(n);
}

ETALON_FUNCTION void fill_echo(ETALON_INOUT(EmitterRecord) r, uint n)
{
    r.radiance = next_vec3(n);
    r.area = next_float(n);
    r.center = next_vec3(n);
    r.object_id = next_uint(n);
    r.area_vector = next_vec3(n);
    r.flags = next_uint(n);
}

ETALON_FUNCTION void fill_echo(ETALON_INOUT(RasterDraw) r, uint n)
{
    for (int i = 0; i < 3; ++i) r.object_rows[i] = next_vec4(n);
    r.normal_matrix = next_mat3(n);
    r.handedness = next_float(n);
    r.scale = next_float(n);
    r.material = next_uint(n);
    r.object_id = next_uint(n);
    r.first_face = next_uint(n);
}

ETALON_FUNCTION void fill_echo(ETALON_INOUT(RasterSphere) r, uint n)
{
    r.center = next_vec3(n);
    r.radius = next_float(n);
    r.material = next_uint(n);
    r.object_id = next_uint(n);
    r.scale = next_float(n);
}

ETALON_FUNCTION void fill_echo(ETALON_INOUT(RasterShrink) r, uint n)
{
    r.size = next_uvec2(n);
    r.level = next_uint(n);
}

ETALON_FUNCTION void fill_echo(ETALON_INOUT(PathFrame) r, uint n)
{
    r.eye = next_vec3(n);
    r.focus_distance = next_float(n);
    r.right = next_vec3(n);
    r.film_x = next_float(n);
    r.up = next_vec3(n);
    r.film_y = next_float(n);
    r.forward = next_vec3(n);
    r.lens_radius = next_float(n);
    r.width = next_uint(n);
    r.height = next_uint(n);
    r.seed = next_uint(n);
    r.grid_base = next_vec3(n);
    r.max_depth = next_uint(n);
    r.grid_scale = next_vec3(n);
    r.roulette = next_uint(n);
    r.bounds_min = next_vec3(n);
    r.emitter_count = next_uint(n);
    r.bounds_max = next_vec3(n);
    r.light_count = next_uint(n);
    r.sky = next_vec3(n);
    r.strategy_count = next_uint(n);
    r.background = next_vec3(n);
    r.background_mode = next_uint(n);
    r.sky_cos = next_float(n);
    r.sky_sin = next_float(n);
    r.sky_width = next_uint(n);
    r.sky_height = next_uint(n);
    r.cells_x = next_uint(n);
    r.cells_y = next_uint(n);
    r.lens_blades = next_uint(n);
}

ETALON_FUNCTION void fill_echo(ETALON_INOUT(PathPush) r, uint n)
{
    r.first_slot = next_uint(n);
    r.slot_count = next_uint(n);
    r.pixel_count = next_uint(n);
    r.first_pixel = next_uint(n);
    r.first_sample = next_uint(n);
    r.sample_count = next_uint(n);
    r.iteration = next_uint(n);
    r.done = next_uint(n);
}

ETALON_SHARED_END
#endif
