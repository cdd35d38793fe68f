// Light from infinitely far (docs/shading.md §5): its radiance, and the sampling of a map by its alias table.
#ifndef ETALON_PATH_ENVIRONMENT_GLSL
#define ETALON_PATH_ENVIRONMENT_GLSL
#include "shaders/lib/sampling.glsl"
#include "shaders/path/scene_data.glsl"
#include "shaders/shared/rng.h"

// (SH-40) Map coordinates of a world direction, and the sine of its polar angle.
vec2 sky_coordinates(vec3 d, out float sine)
{
    float x = frame.sky_cos * d.x - frame.sky_sin * d.z;
    float z = frame.sky_sin * d.x + frame.sky_cos * d.z;
    sine = sqrt(x * x + z * z);
    float u = atan_turns(x, -z);
    return vec2(u < 0.0 ? u + 1.0 : u, 2.0 * atan_turns(sine, d.y));
}

vec3 sky_direction(vec2 uv, out float sine)
{
    vec2 polar = cos_sin_turns(0.5 * uv.y);
    vec2 around = cos_sin_turns(uv.x);
    sine = abs(polar.y);
    float x = sine * around.y;
    float z = -sine * around.x;
    return vec3(frame.sky_cos * x + frame.sky_sin * z, polar.x, frame.sky_cos * z - frame.sky_sin * x);
}

vec3 sky_texel(int x, int y) { return uintBitsToFloat(imageLoad(sky_map, y * int(frame.sky_width) + x).xyz); }

vec3 sky_at(vec2 uv)
{
    int width = int(frame.sky_width);
    int height = int(frame.sky_height);
    float x = uv.x * float(width) - 0.5;
    float y = uv.y * float(height) - 0.5;
    int x0 = int(floor(x));
    int y0 = int(floor(y));
    float fx = x - floor(x);
    float fy = y - floor(y);
    // Columns wrap as integers: a u that rounds to 1 must not read beyond the row (S22).
    int left = x0 < 0 ? x0 + width : min(x0, width - 1);
    int right = x0 + 1 >= width ? x0 + 1 - width : x0 + 1;
    int top = clamp(y0, 0, height - 1);
    int bottom = clamp(y0 + 1, 0, height - 1);
    vec3 a = sky_texel(left, top), b = sky_texel(right, top);
    vec3 c = sky_texel(left, bottom), d = sky_texel(right, bottom);
    vec3 upper = a + fx * (b - a);
    vec3 lower = c + fx * (d - c);
    return upper + fy * (lower - upper);
}

// Density over solid angle of a direction in cell `cell_density` (chance of the cell times the number of cells).
float sky_density(float cell_density, float sine) { return sine > 0.0 ? cell_density / (2.0 * kPi * kPi * sine) : 0.0; }

// Radiance from direction d, and the density with which sample_sky draws d.
vec3 eval_sky(vec3 d, out float pdf)
{
    pdf = 0.0;
    if (!kSkyMap) return frame.sky;
    float sine;
    vec2 uv = sky_coordinates(d, sine);
    uint column = min(uint(uv.x * float(frame.cells_x)), frame.cells_x - 1u);
    uint row = min(uint(uv.y * float(frame.cells_y)), frame.cells_y - 1u);
    pdf = sky_density(uintBitsToFloat(imageLoad(sky_cells, int(row * frame.cells_x + column)).z), sine);
    return frame.sky * sky_at(uv);
}

// A direction towards the map's light: cell by alias table, uniform in (u, v) within it (S23, M10).
vec3 sample_sky(uint pick, uint threshold, vec2 u, out vec3 value, out float pdf)
{
    uint high;
    uint low;
    umulExtended(pick, frame.cells_x * frame.cells_y, high, low);
    uvec4 entry = imageLoad(sky_cells, int(high));
    bool own = unit_float(threshold) < uintBitsToFloat(entry.x);
    uint cell = own ? high : entry.y;
    uint row = uint(float(cell) / float(frame.cells_x));
    row = row * frame.cells_x > cell ? row - 1u : row;
    row = (row + 1u) * frame.cells_x <= cell ? row + 1u : row;
    uint column = cell - row * frame.cells_x;
    vec2 uv = (vec2(column, row) + u) / vec2(frame.cells_x, frame.cells_y);
    float sine;
    vec3 d = sky_direction(uv, sine);
    pdf = sky_density(uintBitsToFloat(own ? entry.z : entry.w), sine);
    value = frame.sky * sky_at(uv);
    return d;
}

#endif
