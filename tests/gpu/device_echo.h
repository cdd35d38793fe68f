// Fills every field of every shared struct with numbers of its own, by one text for C++ and GLSL: what the device
// writes must then be what the host writes, byte for byte.
#ifndef ETALON_TESTS_GPU_DEVICE_ECHO_H
#define ETALON_TESTS_GPU_DEVICE_ECHO_H
#include "shaders/shared/material.h"
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

ETALON_SHARED_END
#endif
