#version 460
#extension GL_GOOGLE_include_directive : require
#include "tests/gpu/device_kernel.glsl"
#include "tests/gpu/device_echo.h"

// One array of each shared struct; invocation i fills element i. Counts in words keep the numbers of two elements apart.
layout(scalar, set = 0, binding = 0) writeonly buffer Materials { MaterialRecord materials[]; };
layout(scalar, set = 0, binding = 1) writeonly buffer Lights { LightRecord lights[]; };
layout(scalar, set = 0, binding = 2) writeonly buffer RasterFrames { RasterFrame raster_frames[]; };
layout(scalar, set = 0, binding = 3) writeonly buffer RasterDraws { RasterDraw raster_draws[]; };
layout(scalar, set = 0, binding = 4) writeonly buffer RasterSpheres { RasterSphere raster_spheres[]; };
layout(scalar, set = 0, binding = 5) writeonly buffer PathFrames { PathFrame path_frames[]; };
layout(scalar, set = 0, binding = 6) writeonly buffer PathPushes { PathPush path_pushes[]; };
layout(scalar, set = 0, binding = 7) writeonly buffer Emitters { EmitterRecord emitters[]; };
layout(scalar, set = 0, binding = 8) writeonly buffer Layers { LayerRecord layers[]; };
layout(scalar, set = 0, binding = 9) writeonly buffer Shrinks { RasterShrink shrinks[]; };

void main()
{
    const uint i = kernel_index();
    if (i >= count) return;
    const uint n = 1000u * i;
    MaterialRecord material;
    fill_echo(material, n);
    materials[i] = material;
    LightRecord light;
    fill_echo(light, n);
    lights[i] = light;
    RasterFrame raster_frame;
    fill_echo(raster_frame, n);
    raster_frames[i] = raster_frame;
    RasterDraw raster_draw;
    fill_echo(raster_draw, n);
    raster_draws[i] = raster_draw;
    RasterSphere raster_sphere;
    fill_echo(raster_sphere, n);
    raster_spheres[i] = raster_sphere;
    PathFrame path_frame;
    fill_echo(path_frame, n);
    path_frames[i] = path_frame;
    PathPush path_push;
    fill_echo(path_push, n);
    path_pushes[i] = path_push;
    EmitterRecord emitter;
    fill_echo(emitter, n);
    emitters[i] = emitter;
    LayerRecord layer;
    fill_echo(layer, n);
    layers[i] = layer;
    RasterShrink shrink;
    fill_echo(shrink, n);
    shrinks[i] = shrink;
}
