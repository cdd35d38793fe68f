// Turns the counts of an iteration into workgroup counts for the dispatches that follow.
#version 460
#extension GL_EXT_scalar_block_layout : require
#extension GL_GOOGLE_include_directive : require
#include "shaders/path/queues.glsl"

layout(local_size_x = 1) in;

layout(constant_id = kSpecRaysPerLane) const uint kRaysPerLane = 32u;
layout(constant_id = kSpecRetry) const bool kRetry = false;  // for the exact kernel that follows a persistent one

layout(set = 0, binding = kBindDispatches, scalar) writeonly buffer Dispatches { uvec3 dispatches[]; };

uint groups(uint count, uint each) { return (count + each - 1u) / each; }

void main()
{
    if (kRetry) {
        uint paths = counters[counter_at(push.iteration, kCountRetriedPaths)];
        uint shadows = counters[counter_at(push.iteration, kCountRetriedShadows)];
        dispatches[kDispatchRetryPaths] = uvec3(groups(paths, kPathWorkgroup), 1u, 1u);
        dispatches[kDispatchRetryShadows] = uvec3(groups(shadows, kPathWorkgroup), 1u, 1u);
    } else {
        uint paths = counters[counter_at(push.iteration + 1u, kCountPaths)];
        uint shadows = counters[counter_at(push.iteration, kCountShadows)];
        dispatches[kDispatchTracePaths] = uvec3(groups(paths, kPathWorkgroup * kRaysPerLane), 1u, 1u);
        dispatches[kDispatchShade] = uvec3(groups(paths, kPathWorkgroup), 1u, 1u);
        dispatches[kDispatchTraceShadows] = uvec3(groups(shadows, kPathWorkgroup * kRaysPerLane), 1u, 1u);
    }
}
