// Starts the paths of a wave: one per slot, at camera rays through random points of their pixels (SH-24).
#version 460
#extension GL_EXT_scalar_block_layout : require
#extension GL_GOOGLE_include_directive : require
#include "shaders/path/camera.glsl"
#include "shaders/path/queues.glsl"
#include "shaders/path/random.glsl"

layout(local_size_x = kPathWorkgroup) in;

layout(constant_id = kSpecBlendSolid) const bool kCentres = false;  // AOVs: through the centres of pixel and lens

// lavapipe cuts a dispatch into as many runs of workgroups as it has threads, whatever they cost. Runs of 512 paths are
// dealt to 16 parts in turn, so that each part sees the whole picture.
uint dealt(uint index)
{
    const uint run = 512u;
    const uint parts = 16u;
    uint rows = push.slot_count / (run * parts);
    uint which = index / run;
    if (which >= rows * parts) return index;
    return ((which % rows) * parts + which / rows) * run + index % run;
}

// Pixels in columns of 8 rows, so that neighbours in a queue are neighbours in the picture.
uint pixel_in_strips(uint k)
{
    const uint rows = 8u;
    uint strip = k / (rows * frame.width);
    uint within = k - strip * rows * frame.width;
    uint height = push.pixel_count / frame.width;
    uint tall = min(rows, height - strip * rows);
    return (strip * rows + within % tall) * frame.width + within / tall;
}

void main()
{
    if (gl_GlobalInvocationID.x >= push.slot_count) return;
    uint k = push.first_slot + dealt(gl_GlobalInvocationID.x);
    uint in_pass;
    uint in_order;
    split_slot(k, in_order, in_pass);
    uint pixel = pixel_in_strips(in_order);
    uint id = picture_pixel(pixel);
    uvec4 bits = path_bits(id, push.first_sample + in_pass, 0u);
    vec2 jitter = kCentres ? vec2(0.5) : vec2(unit_float(bits.x), unit_float(bits.y));
    vec2 lens = vec2(0.0);
    if (kThinLens && !kCentres) lens = sample_aperture(vec2(unit_float(bits.z), unit_float(bits.w)));
    uvec2 at = uvec2(id % frame.width, id / frame.width);

    vec3 origin;
    vec3 direction;
    camera_ray((vec2(at) + jitter) / vec2(frame.width, frame.height), lens, origin, direction);
    store_path(gl_GlobalInvocationID.x,
               PathState(origin, kNoPrimitive, direction, in_pass * push.pixel_count + pixel, vec3(1.0), -1.0, kNoMedium, 0.0));
}
