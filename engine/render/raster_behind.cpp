#include "engine/render/raster_behind.h"

#include <algorithm>

#include "etalon_shaders.h"
#include "shaders/shared/raster.h"

namespace etalon {

RasterBehind::RasterBehind(gpu::Device& device)
    : device_(device),
      shrink_(device, {.shader = {.code = etalon_shaders::find("raster/shrink.comp"), .constants = {}},
                       .name = "raster/shrink.comp"})
{}

void RasterBehind::bind(const RasterTargets& targets)
{
    bindings_ = {device_, shrink_.layout(), {{0, targets.resolved}, {1, targets.levels}}, 0};
}

void RasterBehind::record(gpu::Commands& commands, RasterTargets& targets) const
{
    const std::uint32_t width = targets.resolved.width(), height = targets.resolved.height();
    commands.prepare(targets.resolved, gpu::ImageUse::sampled);
    commands.prepare(targets.levels, gpu::ImageUse::storage, true);
    commands.bind(shrink_, bindings_);
    for (std::uint32_t level = 0; level < gpu::mip_count(width, height); ++level) {
        if (level > 0) commands.barrier(gpu::Work::compute, gpu::Work::compute);
        commands.push(shared::RasterShrink{.size = uvec2(width, height), .level = level});
        const std::uint32_t w = std::max(1u, width >> level), h = std::max(1u, height >> level);
        commands.dispatch((w + 7) / 8, (h + 7) / 8);
    }
    commands.prepare(targets.levels, gpu::ImageUse::sampled);
}

}  // namespace etalon
