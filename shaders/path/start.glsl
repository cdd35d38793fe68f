// How a path starts: at a camera ray through a random point of its pixel (SH-24).
#ifndef ETALON_PATH_START_GLSL
#define ETALON_PATH_START_GLSL
#include "shaders/path/camera.glsl"
#include "shaders/path/queues.glsl"
#include "shaders/path/random.glsl"

// lavapipe cuts a dispatch into as many runs of workgroups as it has threads, whatever they cost. Runs of 512 paths are
// dealt to 16 parts in turn, so that each part sees the whole picture.
uint dealt(uint index)
{
    const uint run = 512u;
    const uint parts = 16u;
    uint rows = push.slot_count / (run * parts);
    uint which = index / run;
    if (which >= rows * parts) return index;
    uint row;
    uint part = divide(which, max(rows, 1u), row);
    return (row * parts + part) * run + index % run;
}

// Pixels in columns of 8 rows, so that neighbours in a queue are neighbours in the picture.
uint pixel_in_strips(uint k)
{
    if (kChosenPixels) return k;
    const uint rows = 8u;
    uint within;
    uint strip = divide(k, rows * frame.width, within);
    uint rest;
    uint height = divide(push.pixel_count, frame.width, rest);
    uint row;
    uint column = divide(within, min(rows, height - strip * rows), row);
    return (strip * rows + row) * frame.width + column;
}

// The slot of path `index` of the wave.
uint slot_at(uint index)
{
    uint pixel;
    uint in_pass;
    split_slot(push.first_slot + dealt(index), pixel, in_pass);
    return in_pass * push.pixel_count + pixel_in_strips(pixel);
}

// `centres`: through the centres of pixel and lens.
PathState start_path(uint slot, bool centres)
{
    uint pixel;
    uint in_pass;
    split_slot(slot, pixel, in_pass);
    uint id = picture_pixel(pixel);
    uvec4 bits = path_bits(id, push.first_sample + in_pass, 0u);
    vec2 jitter = centres ? vec2(0.5) : vec2(unit_float(bits.x), unit_float(bits.y));
    vec2 lens = vec2(0.0);
    if (kThinLens && !centres) lens = sample_aperture(vec2(unit_float(bits.z), unit_float(bits.w)));
    uvec2 at;
    at.y = divide(id, frame.width, at.x);

    vec3 origin;
    vec3 direction;
    camera_ray((vec2(at) + jitter) / vec2(frame.width, frame.height), lens, origin, direction);
    return PathState(origin, kNoPrimitive, direction, slot, vec3(1.0), -1.0, kNoMedium, 0.0);
}

#endif
