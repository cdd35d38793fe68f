#pragma once
#include "engine/base/progress.h"
#include "engine/gpu/device.h"
#include "engine/image/adaptive.h"
#include "engine/image/film.h"
#include "engine/image/film_state.h"
#include "engine/scene/pose.h"
#include "engine/scene/requirements.h"
#include "engine/scene/settings.h"

namespace etalon {

/// The Vulkan rasterizer: docs/shading.md §4. Film::variance is empty: its error is measured by comparison, not by
/// samples.
Film render_raster(gpu::Device& device, const PosedScene& posed, const Requirements& required,
                   const RenderSettings& settings, const Progress& progress);

/// Whether the path tracer's kernels are timed one by one, each waiting for the one before. Changes no pixel.
enum class KernelTimes { unknown, measured };

/// The Vulkan compute path tracer: docs/shading.md §3. Bounded work per submit; stops within about 50 ms of device
/// time when `progress` says so and returns what it has (PathTracer::stop_pass). When the device is lost it is renewed
/// once, so that nothing else may be alive on it, and the picture goes on from the last 256 samples a pixel, to the
/// same bits; a second loss is DeviceLost. With `checkpoints` it takes up a film and hands out its states: the same
/// bits as in one run. Error(input) when the state has more samples than settings.spp.
Film render_path(gpu::Device& device, const PosedScene& posed, const Requirements& required,
                 const RenderSettings& settings, const Progress& progress, const Checkpoints& checkpoints = {},
                 KernelTimes kernels = KernelTimes::unknown);

/// render_path() with settings.spp samples a pixel on average, dealt out by what the first 16 of them say (half of them
/// where there are fewer than 32): plan_samples() of engine/image/adaptive.h, MC-11. Film::counts says how many each
/// pixel has. When `progress` says stop, pixels that it had not come to have those of the pilot. Error(input) with a
/// shard.
Film render_path_adaptively(gpu::Device& device, const PosedScene& posed, const Requirements& required,
                            const RenderSettings& settings, AdaptiveGoal goal, const Progress& progress);

}  // namespace etalon
