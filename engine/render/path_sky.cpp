#include "engine/render/path_sky.h"

#include <algorithm>
#include <bit>
#include <cmath>

#include "engine/render/path_alias.h"

namespace etalon {
namespace {

std::uint32_t bits(double value)
{
    return std::bit_cast<std::uint32_t>(static_cast<float>(value));
}

double light_of(const Image& map, int x, int y)
{
    double sum = 0;
    for (int c = 0; c < 3; ++c) sum += std::max(0.f, map.at(x, y, std::min(c, map.channels - 1)));
    return std::isfinite(sum) ? sum : 0;
}

/// Means of the bilinear map over its texels: a tent of width 2 over a box of width 1 weighs neighbours 1 : 6 : 1.
std::vector<double> texel_means(const Image& map)
{
    const int w = map.width;
    const int h = map.height;
    std::vector<double> rows(map.pixel_count());
    for (int y = 0; y < h; ++y)
        for (int x = 0; x < w; ++x)
            rows[std::size_t(y) * std::size_t(w) + std::size_t(x)] =
                (light_of(map, (x + w - 1) % w, y) + 6 * light_of(map, x, y) + light_of(map, (x + 1) % w, y)) / 8;
    std::vector<double> means(map.pixel_count());
    for (int y = 0; y < h; ++y) {
        const double* above = &rows[std::size_t(std::max(y - 1, 0)) * std::size_t(w)];
        const double* here = &rows[std::size_t(y) * std::size_t(w)];
        const double* below = &rows[std::size_t(std::min(y + 1, h - 1)) * std::size_t(w)];
        for (int x = 0; x < w; ++x)
            means[std::size_t(y) * std::size_t(w) + std::size_t(x)] = (above[x] + 6 * here[x] + below[x]) / 8;
    }
    return means;
}

/// The largest divisor-like factor by which an axis is coarsened: cells are whole numbers of texels.
int coarsening(int size, int most)
{
    int factor = (size + most - 1) / most;
    while (size % factor != 0) ++factor;
    return factor;
}

std::vector<double> cell_weights(const Image& map, int cells_x, int cells_y)
{
    const std::vector<double> means = texel_means(map);
    const int fx = map.width / cells_x;
    const int fy = map.height / cells_y;
    std::vector<double> weights(std::size_t(cells_x) * std::size_t(cells_y));
    for (int y = 0; y < map.height; ++y) {
        const double sine = std::sin(kPi * (y + 0.5) / map.height);
        double* const row = &weights[std::size_t(y / fy) * std::size_t(cells_x)];
        for (int x = 0; x < map.width; ++x)
            row[x / fx] += sine * means[std::size_t(y) * std::size_t(map.width) + std::size_t(x)];
    }
    return weights;
}

}  // namespace

PathSky make_path_sky(const Image& map)
{
    PathSky sky;
    sky.width = map.width;
    sky.height = map.height;
    sky.texels.reserve(map.pixel_count());
    for (int y = 0; y < map.height; ++y) {
        for (int x = 0; x < map.width; ++x) {
            const auto channel = [&](int c) { return bits(map.at(x, y, std::min(c, map.channels - 1))); };
            sky.texels.emplace_back(channel(0), channel(1), channel(2), 0u);
        }
    }
    const int cells_x = map.width / coarsening(map.width, 1024);
    const int cells_y = map.height / coarsening(map.height, 512);
    const std::vector<AliasEntry> table = make_alias_table(cell_weights(map, cells_x, cells_y));
    if (table.empty()) return sky;
    sky.cells_x = cells_x;
    sky.cells_y = cells_y;
    const auto count = static_cast<double>(table.size());
    sky.cells.reserve(table.size());
    for (const AliasEntry& entry : table)
        sky.cells.emplace_back(std::bit_cast<std::uint32_t>(entry.threshold), entry.other,
                               bits(entry.probability * count), bits(table[entry.other].probability * count));
    return sky;
}

}  // namespace etalon
