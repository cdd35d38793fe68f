#pragma once
#include <string>

#include "engine/gpu/device.h"
#include "engine/image/film.h"
#include "engine/measure/rasters.h"
#include "engine/scene/pose.h"
#include "engine/scene/settings.h"

namespace etalon::agree {

/// What compare_rasters may find on this device.
RasterBudget budget_of(const PosedScene& posed, const RenderSettings& settings, const gpu::DeviceLimits& limits);

/// Draws `posed` by both and expects agreement; prints the row of the table.
void expect_rasters_agree(gpu::Device& device, const std::string& what, const PosedScene& posed,
                          const RenderSettings& settings);

Film by_device(gpu::Device& device, const PosedScene& posed, const RenderSettings& settings);
Film by_reference_raster(const PosedScene& posed, RenderSettings settings);

}  // namespace etalon::agree
