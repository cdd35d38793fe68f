// The surfaces that pixels show, from kernel to kernel of a gathering (SH-44).
#ifndef ETALON_PATH_GATHER_GLSL
#define ETALON_PATH_GATHER_GLSL
#include "shaders/path/queues.glsl"
#include "shaders/path/surface.glsl"
#include "shaders/shared/gather.h"

layout(set = 0, binding = kBindPoints, rgba32ui) readonly uniform uimageBuffer points;

// Where a viewing ray ends.
struct GatherPoint {
    vec3 origin;
    uint slot;
    vec3 direction;
    uint primitive;
};

GatherPoint load_point(uint index)
{
    uvec4 a = imageLoad(points, int(2u * index));
    uvec4 b = imageLoad(points, int(2u * index + 1u));
    return GatherPoint(uintBitsToFloat(a.xyz), a.w, uintBitsToFloat(b.xyz), b.w);
}

ivec2 pixel_of_slot(uint slot)
{
    uint id = picture_pixel(slot);
    return ivec2(id % frame.width, id / frame.width);
}

#endif
