#version 460
#extension GL_EXT_scalar_block_layout : require
#extension GL_GOOGLE_include_directive : require
// The exposure that the histogram asks for (IP-3), by one invocation: 4096 bins are few.
#include "shaders/shared/post.h"

layout(local_size_x = 1) in;
layout(set = 0, binding = 4, scalar) buffer Table { float table[]; };
layout(set = 0, binding = 5, scalar) readonly buffer Counts { uint counts[]; };
layout(push_constant, scalar) uniform Push { PostMeter push; };

// log2 of the middle of each of the sixteen bins of an octave.
const float kMiddles[16] =
    float[](0.0443941194, 0.129283017, 0.209453366, 0.285402219, 0.357552005, 0.426264755, 0.491853096, 0.554588852,
            0.614709844, 0.672425342, 0.727920455, 0.781359714, 0.832890014, 0.882643049, 0.930737338, 0.977279923);

void main()
{
    uint total = 0u;
    for (uint i = 0u; i < kPostBins; ++i) total += counts[i];
    const float low = float(total) * kPostTail;
    const float high = float(total) - low;
    float before = 0.0, sum = 0.0, lost = 0.0;
    for (uint i = 0u; i < kPostBins; ++i) {
        const float after = before + float(counts[i]);
        const float share = max(0.0, min(after, high) - max(before, low));
        if (share > 0.0) {
            precise const float term = share * (float(int(i >> 4u) - 127) + kMiddles[i & 15u]) - lost;
            precise const float next = sum + term;
            precise const float error = (next - sum) - term;
            lost = error;
            sum = next;
        }
        before = after;
    }
    const float mean = sum / (high - low);
    table[push.factor] = total == 0u ? 1.0 : clamp(kPostMiddleGrey * exp2(-mean), exp2(-100.0), exp2(100.0));
}
