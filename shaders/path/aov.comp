// What camera rays through the centres of pixels meet (docs/shading.md §6): 4 vec4 a pixel.
#version 460
#extension GL_EXT_scalar_block_layout : require
#extension GL_GOOGLE_include_directive : require
#include "shaders/path/queues.glsl"
#include "shaders/path/surface.glsl"

layout(local_size_x = kPathWorkgroup) in;

layout(set = 0, binding = kBindAovs, std430) writeonly buffer Aovs { vec4 aovs[]; };

void main()
{
    uint index = gl_GlobalInvocationID.x;
    if (index >= push.slot_count) return;
    PathState path = load_path(index);
    uint primitive = imageLoad(hits_in, int(index)).x;
    bool hit = primitive != kNoPrimitive && primitive != kLostPrimitive;
    float t;
    Surface s = make_surface(hit ? primitive : 0u, path.origin, path.direction, t);
    vec4 base = base_color(s.material, s.uvs, s.color);
    bool emits = s.front || (s.flags & kPrimitiveEmitsBack) != 0u;
    vec3 light = emits ? emission(s.material, s.uvs) : vec3(0.0);
    if (kUnlit && floatBitsToUint(load_material(s.material, 4u).w) == kModelUnlit) light = base.xyz;

    uint at = 4u * path.slot;
    float along = dot(s.position - frame.eye, frame.forward);
    if (kEquirectangular) along = robust_length(s.position - frame.eye);
    float depth = hit ? along : uintBitsToFloat(0x7f800000u);
    aovs[at] = vec4(hit ? s.n : vec3(0.0), depth);
    aovs[at + 1u] = vec4(hit ? base.xyz : vec3(0.0), uintBitsToFloat(hit ? s.object : 0u));
    aovs[at + 2u] = vec4(hit ? light : vec3(0.0), uintBitsToFloat(hit ? s.material + 1u : 0u));
    aovs[at + 3u] = vec4(hit ? s.uvs.xy : vec2(0.0), 0.0, 0.0);
}
