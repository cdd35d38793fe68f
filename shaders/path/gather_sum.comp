// Adds what one path of each point found to its pixel's mean, or (kShadows) keeps whether a light reached it.
#version 460
#extension GL_EXT_scalar_block_layout : require
#extension GL_GOOGLE_include_directive : require
#include "shaders/path/gather.glsl"

layout(local_size_x = kPathWorkgroup) in;

layout(constant_id = kSpecShadow) const bool kShadows = false;

layout(set = 0, binding = kBindRadianceIn, rgba32ui) readonly uniform uimageBuffer radiance_in;
layout(set = 0, binding = kBindGathered, rgba32f) uniform image2D gathered;
layout(set = 0, binding = kBindLit, rgba32ui) uniform uimage2D lit;
layout(set = 0, binding = kBindKnown, std430) readonly buffer Known { vec4 known[]; };
layout(set = 0, binding = kBindSums, std430) buffer Sums { vec4 sums[]; };

float weigh(vec3 light) { return light.x + light.y + light.z; }

void add_shadow(ivec2 at, bool reached)
{
    uvec4 bits = imageLoad(lit, at);
    uint bit = reached ? 1u << (push.sample_count & 31u) : 0u;
    uint word = push.sample_count >> 5;
    bits.x |= word == 0u ? bit : 0u;
    bits.y |= word == 1u ? bit : 0u;
    bits.z |= word == 2u ? bit : 0u;
    imageStore(lit, at, bits);
}

// The mean of what paths found, x, corrected by what is known better than by paths: y, of the same paths where nothing hides
// the environment. By the regression of x on y (Owen 2013, 8.9): wholly where nothing is in the way, not at all where the
// environment is hidden, so that its lamps are no noise there.
vec3 corrected(vec4 x, vec4 y, vec3 looks, float count)
{
    float covariance = x.w / count - weigh(x.xyz) / count * (weigh(y.xyz) / count);
    float variance = y.w / count - weigh(y.xyz) / count * (weigh(y.xyz) / count);
    float slope = variance > 0.0 ? clamp(covariance / variance, 0.0, 1.0) : 0.0;
    return max((x.xyz - slope * (y.xyz - looks)) / count, vec3(0.0));
}

void main()
{
    uint index = gl_GlobalInvocationID.x;
    if (index >= push.slot_count) return;
    uint slot = imageLoad(points, int(2u * index)).w;
    ivec2 at = pixel_of_slot(slot);
    vec3 found = uintBitsToFloat(imageLoad(radiance_in, int(slot)).xyz);
    if (kShadows) {
        add_shadow(at, max_component(found) > 0.0);
        return;
    }
    vec4 x = sums[3u * index];
    vec4 y = sums[3u * index + 1u];
    vec4 looks = sums[3u * index + 2u];
    vec3 by_path = known[2u * index].xyz;
    // A path that began elsewhere, or that the traversal gave up, is left out; w of `looks` counts the others.
    if (is_finite(found) && known[2u * index].w > 0.0) {
        x += vec4(found, weigh(found) * weigh(by_path));
        y += vec4(by_path, weigh(by_path) * weigh(by_path));
        looks += vec4(known[2u * index + 1u].xyz, 1.0);
    }
    sums[3u * index] = x;
    sums[3u * index + 1u] = y;
    sums[3u * index + 2u] = looks;
    float depth = imageLoad(gathered, at).w;
    imageStore(gathered, at, vec4(corrected(x, y, looks.xyz, max(looks.w, 1.0)), depth));
}
