#include <fmt/format.h>

#include <cmath>

#include "engine/image/metrics.h"
#include "engine/measure/picture_error.h"
#include "engine/measure/text.h"

namespace etalon {
namespace {

std::string plain(const Estimate& e)
{
    return fmt::format("{:.4g} {:.4g} {:.4g}", e.value, e.low, e.high);
}

}  // namespace

std::string describe(const PictureError& error)
{
    if (error.mean <= 0) return fmt::format("{:.3g} nit where all is black", error.rmse.value);
    if (error.relative.low == 0)
        return fmt::format("under {} (95%), under {:.2g} of 255 display steps", percent(error.relative.high),
                           error.display.high);
    return fmt::format("{} (95% interval {} to {}), {:.2g} of 255 display steps", percent(error.relative.value),
                       percent(error.relative.low), percent(error.relative.high), error.display.value);
}

std::vector<std::pair<std::string, std::string>> picture_error_texts(const PictureError& error)
{
    std::vector<std::pair<std::string, std::string>> out = {
        {"error", describe(error)},
        {"error.rmse", plain(error.rmse)},
        {"error.relative", plain(error.relative)},
        {"error.relmse", plain(error.relmse)},
        {"error.display", plain(error.display)},
        {"error.brightness", plain(error.brightness)},
        {"error.probe", fmt::format("pixels={} samples={} max-depth={}{}", error.pixels, error.samples, error.depth,
                                    error.cut ? " cut-by-time" : "")}};
    if (error.systematic) out.emplace_back("error.systematic", plain(*error.systematic));
    std::string map = fmt::format("{}x{}", error.cells_x, error.cells_y);
    for (const double cell : error.map) map += fmt::format(" {:.3g}", cell);
    out.emplace_back("error.map", map);
    return out;
}

Image picture_error_map(const PictureError& error)
{
    constexpr double kDecades = 3;
    Image level(error.cells_x, error.cells_y, 1), zero(error.cells_x, error.cells_y, 1);
    for (std::size_t i = 0; i < error.map.size(); ++i)
        level.values[i] =
            error.map[i] > 0 ? static_cast<float>(std::max(1 + std::log10(error.map[i]) / kDecades, 0.0)) : 0.0f;
    return difference_picture(level, zero, 1);
}

}  // namespace etalon
