// Adds the samples of a pass to the film of the block: per pixel and replicate (MC-10), mean and sum of squared deviations
// (MC-2, M3), in order of the sample number, so that passes of any size give the same bits. Samples that are not finite
// are left out and counted.
#version 460
#extension GL_EXT_scalar_block_layout : require
#extension GL_GOOGLE_include_directive : require
#include "shaders/path/scene_data.glsl"
#include "shaders/shared/sobol.h"

layout(local_size_x = kPathWorkgroup) in;

layout(set = 0, binding = kBindRadianceIn, rgba32ui) readonly uniform uimageBuffer radiance_in;
layout(set = 0, binding = kBindMean, std430) buffer Means { vec4 means[]; };
layout(set = 0, binding = kBindM2, std430) buffer Deviations { vec4 deviations[]; };

const uint kReplicates = kSobol ? kSobolReplicates : 1u;

void add_replicate(uint replicate, uint pixel)
{
    uint place = replicate * push.pixel_count + pixel;
    uint before = (push.done + kReplicates - 1u - replicate) / kReplicates;
    bool first = before == 0u;
    vec4 mean = first ? vec4(0.0) : means[place];
    vec4 stored = first ? vec4(0.0) : deviations[place];
    vec3 m2 = stored.xyz;
    uint nonfinite = floatBitsToUint(stored.w) & 0xffffu;
    uint truncated = floatBitsToUint(stored.w) >> 16;
    uint count = before;
    for (uint i = (replicate + kReplicates - push.done % kReplicates) % kReplicates; i < push.sample_count; i += kReplicates) {
        vec4 value = uintBitsToFloat(imageLoad(radiance_in, int(i * push.pixel_count + pixel)));
        bool cut = value.w >= 2.0;
        truncated += cut ? 1u : 0u;
        value.w -= cut ? 2.0 : 0.0;
        bool finite = is_finite(value.xyz);
        nonfinite += finite ? 0u : 1u;
        ++count;
        vec4 delta = finite ? value - mean : vec4(0.0);
        mean += delta / max(float(count - nonfinite), 1.0);
        m2 += finite ? delta.xyz * (value.xyz - mean.xyz) : vec3(0.0);
    }
    means[place] = mean;
    deviations[place] = vec4(m2, uintBitsToFloat(nonfinite | truncated << 16));
}

void main()
{
    uint pixel = gl_GlobalInvocationID.x;
    if (pixel >= push.pixel_count) return;
    for (uint replicate = 0u; replicate < kReplicates; ++replicate) add_replicate(replicate, pixel);
}
