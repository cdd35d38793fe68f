#include "engine/render/raster_filter.h"

#include <cmath>
#include <vector>

#include "engine/base/error.h"
#include "engine/math/types.h"
#include "etalon_shaders.h"
#include "shaders/shared/raster.h"

namespace etalon {
namespace {

/// Half the width of a filter, pixels.
double radius(PixelFilter filter)
{
    switch (filter) {
        case PixelFilter::box:
            return 0.5;
        case PixelFilter::tent:
            return 1;
        case PixelFilter::gaussian:
            return 2;
        case PixelFilter::blackman_harris:
            return 1.5;
    }
    assume(false);
    return 0;
}

/// (AA-2) at `x` pixels from its centre, within its radius.
double weight(PixelFilter filter, double x)
{
    switch (filter) {
        case PixelFilter::box:
            return 1;
        case PixelFilter::tent:
            return 1 - std::abs(x);
        case PixelFilter::gaussian:
            return std::exp(-2 * x * x);
        case PixelFilter::blackman_harris: {
            const double turn = kPi * x / radius(filter);
            return 0.35875 + 0.48829 * std::cos(turn) + 0.14128 * std::cos(2 * turn) + 0.01168 * std::cos(3 * turn);
        }
    }
    assume(false);
    return 0;
}

}  // namespace

bool RasterFilter::is_needed(const RenderSettings& settings)
{
    // With one drawn pixel in a pixel, those that are no wider than two pixels weigh it alone.
    return settings.ssaa > 1 || radius(settings.pixel_filter) > 1;
}

RasterFilter::RasterFilter(gpu::Device& device, const RenderSettings& settings)
    : device_(device),
      per_side_(static_cast<std::uint32_t>(settings.ssaa)),
      pipeline_(device, {.shader = {.code = etalon_shaders::find("raster/filter.comp"), .constants = {}},
                         .name = "raster/filter.comp"})
{
    const int n = settings.ssaa;
    // Drawn pixel j of a pixel is (j + ½)/n - ½ from its centre: the first one within the radius.
    first_ = static_cast<int>(std::floor(n * (0.5 - radius(settings.pixel_filter)) - 0.5)) + 1;
    std::vector<float> weights;
    for (int j = first_; j < n - first_; ++j)
        weights.push_back(static_cast<float>(weight(settings.pixel_filter, (j + 0.5) / n - 0.5)));
    taps_ = static_cast<std::uint32_t>(weights.size());
    weights_ = gpu::make_buffer(device, weights, "filter weights");
}

void RasterFilter::bind(const RasterTargets& targets)
{
    rows_ = {device_, pipeline_.layout(), {{0, targets.resolved}, {1, targets.filtered_rows}, {2, weights_}}, 0};
    columns_ = {device_, pipeline_.layout(), {{0, targets.filtered_rows}, {1, targets.filtered}, {2, weights_}}, 0};
}

void RasterFilter::record(gpu::Commands& commands, RasterTargets& targets) const
{
    commands.begin_region("filter");
    const auto pass = [&](gpu::Image& from, gpu::Image& to, const gpu::Bindings& bindings, bool vertical) {
        commands.prepare(from, gpu::ImageUse::sampled);
        commands.prepare(to, gpu::ImageUse::storage, true);
        commands.bind(pipeline_, bindings);
        commands.push(shared::RasterReconstruction{.size = uvec2(to.width(), to.height()),
                                                   .first = first_,
                                                   .taps = taps_,
                                                   .per_side = per_side_,
                                                   .vertical = vertical ? 1u : 0u});
        commands.dispatch((to.width() + 7) / 8, (to.height() + 7) / 8);
    };
    pass(targets.resolved, targets.filtered_rows, rows_, false);
    pass(targets.filtered_rows, targets.filtered, columns_, true);
    commands.end_region();
}

}  // namespace etalon
