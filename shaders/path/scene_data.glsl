// The scene as kernels read it. Always a whole texel by imageLoad: the one read that lavapipe does without a loop.
#ifndef ETALON_PATH_SCENE_DATA_GLSL
#define ETALON_PATH_SCENE_DATA_GLSL
#include "shaders/path/features.glsl"
#include "shaders/lib/numeric.glsl"

layout(set = 0, binding = kBindFrame, scalar) uniform FrameBlock { PathFrame frame; };
layout(set = 0, binding = kBindNodes, rgba32ui) readonly uniform uimageBuffer nodes;
layout(set = 0, binding = kBindPrimitives, rgba32ui) readonly uniform uimageBuffer primitives;
layout(set = 0, binding = kBindAttributes, rgba32ui) readonly uniform uimageBuffer attributes;
layout(set = 0, binding = kBindMaterials, rgba32ui) readonly uniform uimageBuffer materials;
layout(set = 0, binding = kBindTextures, rgba32ui) readonly uniform uimageBuffer textures;
layout(set = 0, binding = kBindTexels8, r32ui) readonly uniform uimageBuffer texels_8;
layout(set = 0, binding = kBindTexelsWide, rgba32ui) readonly uniform uimageBuffer texels_wide;
layout(set = 0, binding = kBindLights, rgba32ui) readonly uniform uimageBuffer lights;
layout(set = 0, binding = kBindEmitters, rgba32ui) readonly uniform uimageBuffer emitters;
layout(set = 0, binding = kBindSkyCells, rgba32ui) readonly uniform uimageBuffer sky_cells;
layout(set = 0, binding = kBindSkyMap, rgba32ui) readonly uniform uimageBuffer sky_map;

layout(set = 0, binding = kBindAlbedo, rgba32ui) readonly uniform uimageBuffer albedo_cells;

layout(push_constant, scalar) uniform PushBlock { PathPush push; };

struct PrimitiveData {
    vec3 p0;
    vec3 p1;
    vec3 p2;
    uint flags;
    // Of an emitter, else 0. Alias table: the chance to be drawn, of triangles over their area. Tree: leaf + 1.
    float light_density;
    uint object;          // draw or sphere index + 1
};

PrimitiveData load_primitive(uint index)
{
    uvec4 a = imageLoad(primitives, int(3u * index));
    uvec4 b = imageLoad(primitives, int(3u * index + 1u));
    uvec4 c = imageLoad(primitives, int(3u * index + 2u));
    return PrimitiveData(uintBitsToFloat(a.xyz), uintBitsToFloat(b.xyz), uintBitsToFloat(c.xyz), a.w,
                         uintBitsToFloat(b.w), c.w);
}

// Texels of the sections of `attributes`; those that are not required are not there.
const uint kNormalTexels = kNormals ? 3u : 0u;
const uint kUvTexels = kUv ? 3u : 0u;
const uint kTangentTexels = kTangents ? 3u : 0u;
const uint kColorTexels = kColors ? 3u : 0u;
const uint kUvAt = kNormalTexels;
const uint kTangentAt = kUvAt + kUvTexels;
const uint kColorAt = kTangentAt + kTangentTexels;
const uint kAttributeStride = kColorAt + kColorTexels;

// The attribute at offset `at` with weights w.y, w.z of the second and third vertex (TR-4): the form in which an attribute
// that is the same at all three stays so to the bit (G5, R29).
vec4 interpolate(uint primitive, uint at, vec3 w)
{
    int first = int(kAttributeStride * primitive + at);
    vec4 a = uintBitsToFloat(imageLoad(attributes, first));
    vec4 b = uintBitsToFloat(imageLoad(attributes, first + 1));
    vec4 c = uintBitsToFloat(imageLoad(attributes, first + 2));
    return a + w.y * (b - a) + w.z * (c - a);
}

#endif
