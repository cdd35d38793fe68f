// Starts the paths of a wave: one per slot.
#version 460
#extension GL_EXT_scalar_block_layout : require
#extension GL_GOOGLE_include_directive : require
#include "shaders/path/start.glsl"

layout(local_size_x = kPathWorkgroup) in;

layout(constant_id = kSpecBlendSolid) const bool kCentres = false;  // AOVs
layout(constant_id = kSpecRetry) const bool kRetry = false;         // the slots that the fused kernel has left

void main()
{
    uint index = gl_GlobalInvocationID.x;
    if (index >= push.slot_count) return;
    uint slot = kRetry ? retries[index] : slot_at(index);
    store_path(index, start_path(slot, kCentres));
}
