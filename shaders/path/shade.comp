// What happens where a segment of the wave's paths ends, each queue filled anew.
#version 460
#extension GL_EXT_scalar_block_layout : require
#extension GL_GOOGLE_include_directive : require
#include "shaders/path/shade.glsl"

layout(local_size_x = kPathWorkgroup) in;

void main()
{
    uint index = gl_GlobalInvocationID.x;
    uint count = counters[counter_at(push.iteration, kCountPaths)];
    bool here = index < count;
    index = min(index, count - 1u);
    PathState path = load_path(index);
    Shaded shaded = shade(path, imageLoad(hits_in, int(index)).x, push.iteration, here);

    uint place = append(counter_at(push.iteration, kCountShadows), shaded.casts);
    if (shaded.casts) {
        ShadowRay shadow = shaded.shadow;
        shadows_out[3u * place] = vec4(shadow.origin, uintBitsToFloat(shadow.self));
        shadows_out[3u * place + 1u] = vec4(shadow.direction, shadow.reach);
        shadows_out[3u * place + 2u] = vec4(shadow.light, uintBitsToFloat(path.slot));
    }
    place = append(counter_at(push.iteration + 1u, kCountPaths), shaded.goes_on);
    if (shaded.goes_on) store_path(place, shaded.next);

    // Stores are the dearest instructions of lavapipe: most segments of most scenes have nothing to add.
    if (here && push.iteration == 0u) {
        radiance[path.slot] = shaded.collected;
    } else if (here && shaded.collected != vec4(0.0)) {
        radiance[path.slot] += shaded.collected;
    }
}
