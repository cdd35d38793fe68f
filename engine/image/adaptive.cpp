#include "engine/image/adaptive.h"

#include <algorithm>
#include <cmath>
#include <map>

#include "engine/base/error.h"

namespace etalon {
namespace {

constexpr int kTile = 8;                     // pixels a side
constexpr double kLeast = 0.25, kMost = 16;  // samples, as shares of the average
constexpr double kStepsAnOctave = 2;

/// What the tiles of a picture say, row by row.
struct Tiles {
    int across = 0, down = 0;
    std::vector<double> values;

    double& at(int x, int y) { return values[std::size_t(y) * std::size_t(across) + std::size_t(x)]; }
    double at(int x, int y) const { return values[std::size_t(y) * std::size_t(across) + std::size_t(x)]; }
};

template <typename Visit>
void for_each_pixel(const Film& film, int tile_x, int tile_y, const Visit& visit)
{
    for (int y = tile_y * kTile; y < std::min(film.height, (tile_y + 1) * kTile); ++y)
        for (int x = tile_x * kTile; x < std::min(film.width, (tile_x + 1) * kTile); ++x)
            visit(std::size_t(y) * std::size_t(film.width) + std::size_t(x));
}

double mean_radiance(const Film& film)
{
    double sum = 0, count = 0;
    for (const vec3& m : film.mean)
        for (int c = 0; c < 3; ++c)
            if (std::isfinite(m[c])) {
                sum += double(m[c]);
                ++count;
            }
    return count > 0 ? sum / count : 0;
}

/// Mean variance of a tile's pixels, weighed as the goal weighs it.
Tiles variances(const Film& film, AdaptiveGoal goal)
{
    Tiles out{.across = (film.width + kTile - 1) / kTile, .down = (film.height + kTile - 1) / kTile, .values = {}};
    out.values.resize(std::size_t(out.across) * std::size_t(out.down));
    const double floor = 0.01 * std::pow(mean_radiance(film), 2);
    for (int y = 0; y < out.down; ++y)
        for (int x = 0; x < out.across; ++x) {
            double variance = 0, square = 0, count = 0;
            for_each_pixel(film, x, y, [&](std::size_t i) {
                for (int c = 0; c < 3; ++c) {
                    const double m = film.mean[i][c], v = film.variance[i][c];
                    if (!std::isfinite(m) || !std::isfinite(v)) continue;
                    variance += v;
                    square += m * m;
                    ++count;
                }
            });
            if (count == 0) continue;
            const double scale = goal == AdaptiveGoal::relmse ? square / count + floor : 1;
            out.at(x, y) = scale > 0 ? variance / count / scale : 0;
        }
    return out;
}

/// Deviations of tiles, with a share of those around them: a pilot is too short to know one tile alone.
Tiles deviations(const Tiles& variances)
{
    Tiles out = variances;
    for (int y = 0; y < out.down; ++y)
        for (int x = 0; x < out.across; ++x) {
            double sum = 0, weights = 0;
            for (int v = std::max(y - 1, 0); v <= std::min(y + 1, out.down - 1); ++v)
                for (int u = std::max(x - 1, 0); u <= std::min(x + 1, out.across - 1); ++u) {
                    const double weight = (u == x ? 2 : 1) * (v == y ? 2 : 1);
                    sum += weight * variances.at(u, v);
                    weights += weight;
                }
            out.at(x, y) = std::sqrt(sum / weights);
        }
    return out;
}

/// Samples of a tile as a share of the average, before and after it is cut to the range and to steps.
double stepped(double share)
{
    const double cut = std::clamp(share, kLeast, kMost);
    return std::exp2(std::floor(std::log2(cut) * kStepsAnOctave + 1e-9) / kStepsAnOctave);
}

/// The largest factor for which the shares, cut and stepped, are no more than one on average.
double balance(const Tiles& tiles)
{
    const auto average = [&](double factor) {
        double sum = 0;
        for (const double d : tiles.values) sum += stepped(factor * d);
        return sum / double(tiles.values.size());
    };
    double sum = 0;
    for (const double d : tiles.values) sum += d;
    double low = 0, high = 2 * kMost * double(tiles.values.size()) / sum;
    for (int i = 0; i < 60; ++i) {
        const double middle = 0.5 * (low + high);
        (average(middle) <= 1 ? low : high) = middle;
    }
    return low;
}

}  // namespace

std::vector<SampleGroup> plan_samples(const Film& pilot, std::uint64_t spp, AdaptiveGoal goal)
{
    assume(pilot.variance.size() == pilot.pixel_count() && pilot.pixel_count() > 0 && spp > 0);
    Tiles shares = deviations(variances(pilot, goal));
    if (std::all_of(shares.values.begin(), shares.values.end(), [](double d) { return d == 0; }))
        std::fill(shares.values.begin(), shares.values.end(), 1.0);
    const double factor = balance(shares);
    std::map<std::uint64_t, SampleGroup, std::greater<>> groups;
    for (int y = 0; y < shares.down; ++y)
        for (int x = 0; x < shares.across; ++x) {
            const auto samples = static_cast<std::uint64_t>(stepped(factor * shares.at(x, y)) * double(spp) / 2) * 2;
            SampleGroup& group = groups[std::max<std::uint64_t>(samples, 2)];
            group.samples = std::max<std::uint64_t>(samples, 2);
            for_each_pixel(pilot, x, y, [&](std::size_t i) { group.pixels.push_back(static_cast<std::uint32_t>(i)); });
        }
    std::vector<SampleGroup> out;
    for (auto& [samples, group] : groups) out.push_back(std::move(group));
    return out;
}

}  // namespace etalon
