// Lists the surfaces that the pixels of a wave show, and clears what was gathered there.
#version 460
#extension GL_EXT_scalar_block_layout : require
#extension GL_GOOGLE_include_directive : require
#include "shaders/path/gather.glsl"

layout(local_size_x = kPathWorkgroup) in;

layout(set = 0, binding = kBindPointsOut, std430) writeonly buffer PointsOut { vec4 points_out[]; };
layout(set = 0, binding = kBindGathered, rgba32f) writeonly uniform image2D gathered;
layout(set = 0, binding = kBindLit, rgba32ui) writeonly uniform uimage2D lit;

void main()
{
    uint index = gl_GlobalInvocationID.x;
    bool here = index < push.slot_count;
    index = min(index, push.slot_count - 1u);
    PathState path = load_path(index);
    uint primitive = imageLoad(hits_in, int(index)).x;
    bool hit = primitive != kNoPrimitive && primitive != kLostPrimitive;
    float t;
    Surface s = make_surface(hit ? primitive : 0u, path.origin, path.direction, t);
    uint place = append(counter_at(1u, kCountPoints), here && hit);
    if (here && hit) {
        points_out[2u * place] = vec4(path.origin, uintBitsToFloat(path.slot));
        points_out[2u * place + 1u] = vec4(path.direction, uintBitsToFloat(primitive));
    }
    ivec2 at = pixel_of_slot(path.slot);
    float along = dot(s.position - frame.eye, frame.forward);
    if (here) imageStore(gathered, at, vec4(0.0, 0.0, 0.0, hit ? along : 0.0));
    if (here) imageStore(lit, at, uvec4(0u, 0u, 0u, hit ? s.object : 0u));
}
