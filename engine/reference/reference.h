#pragma once
#include <cstdint>
#include <span>

#include "engine/base/progress.h"
#include "engine/image/film.h"
#include "engine/image/film_state.h"
#include "engine/scene/pose.h"
#include "engine/scene/requirements.h"
#include "engine/scene/settings.h"

namespace etalon::reference {

/// The path tracer of docs/equations.md in double precision: settings.spp samples a pixel, independent of shaders/lib.
/// Deterministic whatever the thread count. Stops early, with what it has, when `progress` says so. With settings.shard
/// the film has the rows of that part alone. With `checkpoints` it takes up a film and hands out its states: the same
/// bits as in one run. Error(input) when the state has more samples than settings.spp.
Film render_path(const PosedScene& posed, const Requirements& required, const RenderSettings& settings,
                 const Progress& progress, const Checkpoints& checkpoints = {});

/// The same of chosen pixels alone, each a row-major number (y * width + x) of the posed view: a film of one row, whose
/// pixels are to the bit those of the whole picture. Stops between passes of about half a second.
Film render_pixels(const PosedScene& posed, const Requirements& required, const RenderSettings& settings,
                   std::span<const std::uint32_t> pixels, const Progress& progress);

/// The rasterizer of the notes, stage by stage, in double precision: edge functions with the top-left rule,
/// perspective-correct interpolation, mip level from derivatives, trilinear filtering, the shading of docs/shading.md
/// §4, at settings.msaa sample positions (Vulkan's standard ones).
Film render_raster(const PosedScene& posed, const Requirements& required, const RenderSettings& settings,
                   const Progress& progress);

}  // namespace etalon::reference
