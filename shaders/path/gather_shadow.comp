// Asks for each surface that a pixel shows whether a punctual light reaches it (SH-45): one shadow ray, of one light.
#version 460
#extension GL_EXT_scalar_block_layout : require
#extension GL_GOOGLE_include_directive : require
#include "shaders/path/gather.glsl"
#include "shaders/path/lights.glsl"

layout(local_size_x = kPathWorkgroup) in;

void main()
{
    uint index = gl_GlobalInvocationID.x;
    bool here = index < push.slot_count;
    GatherPoint point = load_point(min(index, push.slot_count - 1u));
    float t;
    Surface s = make_surface(point.primitive, point.origin, point.direction, t);
    LightSample light = punctual_light(s.position, push.done);
    bool casts = here && max_component(light.value) > 0.0;
    vec3 origin = leave(s, light.wi);
    vec3 direction = light.infinite ? light.wi : light.target - origin;
    uint place = append(counter_at(0u, kCountShadows), casts);
    if (casts) {
        shadows_out[3u * place] = vec4(origin, uintBitsToFloat(self_of(s, point.primitive, light.wi)));
        shadows_out[3u * place + 1u] = vec4(direction, light.infinite ? kMaxFloat : 1.0 - 1e-6);
        shadows_out[3u * place + 2u] = vec4(vec3(1.0), uintBitsToFloat(point.slot));
    }
    if (here) radiance[point.slot] = vec4(0.0);
}
