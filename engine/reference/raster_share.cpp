#include "engine/reference/raster_share.h"

#include <algorithm>
#include <cmath>

#include "engine/base/parallel.h"
#include "engine/reference/layers_albedo.h"

namespace etalon::reference {
namespace {

constexpr double kLowestAlpha = 1e-3;
constexpr double kLowestRoughness = 0.07;
constexpr double kLowestCosine = 1e-4;  // of sheen

// What both axes of cosine are made of: x = ((1 + s) c/(c + s))^(1/power), s the roughness that shapes the function.
double stretched(double cosine, double s)
{
    return (1 + s) * cosine / (cosine + s);
}

double unstretched(double x, double s)
{
    const double t = x / (1 + s);
    return t < 1 ? std::min(s * t / (1 - t), 1.0) : 1.0;
}

double lowest_of_sheen(double roughness)
{
    return std::cbrt(stretched(kLowestCosine, roughness));
}

}  // namespace

RasterShares::RasterShares(bool ggx, bool sheen, unsigned threads)
{
    const auto fill = [&](Grid& grid, int columns, int rows, auto&& value) {
        grid.columns = columns;
        grid.rows = rows;
        grid.nodes.resize(static_cast<std::size_t>(columns) * static_cast<std::size_t>(rows));
        parallel_for(
            grid.nodes.size(),
            [&](std::size_t i) {
                const int x = static_cast<int>(i) % columns, y = static_cast<int>(i) / columns;
                grid.nodes[i] = value(double(x) / (columns - 1), double(y) / (rows - 1));
            },
            threads);
    };
    if (ggx)
        fill(ggx_, 64, 32, [](double x, double y) {
            const double alpha = kLowestAlpha + y * (1 - kLowestAlpha);
            return ggx_share(unstretched(x * x, alpha), alpha);
        });
    if (ggx)
        fill(schlick_, 64, 32, [](double x, double y) { return ggx_schlick_share(x, std::max(y * y, kLowestAlpha)); });
    if (sheen)
        fill(sheen_, 96, 48, [](double x, double y) {
            const double r = kLowestRoughness + y * (1 - kLowestRoughness);
            const double low = lowest_of_sheen(r), root = low + x * (1 - low);
            return r * sheen_share(unstretched(root * root * root, r), r * r);
        });
}

double RasterShares::Grid::at(double x, double y) const
{
    const double column = std::clamp(x, 0.0, 1.0) * (columns - 1), row = std::clamp(y, 0.0, 1.0) * (rows - 1);
    const int i = std::min(static_cast<int>(column), columns - 2), j = std::min(static_cast<int>(row), rows - 2);
    const double* low = nodes.data() + j * columns + i;
    const double* high = low + columns;
    const double fx = column - i, fy = row - j;
    return (1 - fy) * ((1 - fx) * low[0] + fx * low[1]) + fy * ((1 - fx) * high[0] + fx * high[1]);
}

double RasterShares::ggx(double cosine, double alpha) const
{
    return ggx_.at(std::sqrt(stretched(cosine, alpha)), (alpha - kLowestAlpha) / (1 - kLowestAlpha));
}

double RasterShares::schlick(double cosine, double roughness) const
{
    return schlick_.at(cosine, roughness);
}

dvec2 RasterShares::specular(double cosine, double roughness) const
{
    const double e = ggx(cosine, std::clamp(roughness * roughness, kLowestAlpha, 1.0)), w = schlick(cosine, roughness);
    return {e * (1 - w), e * w};
}

double RasterShares::sheen(double cosine, double roughness) const
{
    const double low = lowest_of_sheen(roughness);
    const double x = std::cbrt(stretched(std::max(cosine, kLowestCosine), roughness));
    return sheen_.at((x - low) / (1 - low), (roughness - kLowestRoughness) / (1 - kLowestRoughness)) / roughness;
}

}  // namespace etalon::reference
