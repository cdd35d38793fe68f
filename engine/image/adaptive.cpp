#include "engine/image/adaptive.h"

#include <algorithm>
#include <cmath>
#include <functional>
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

/// visit(pixel) for those of a tile that are of one colour of the chessboard.
template <typename Visit>
void for_each_pixel(const Film& film, int tile_x, int tile_y, int colour, const Visit& visit)
{
    for (int y = tile_y * kTile; y < std::min(film.height, (tile_y + 1) * kTile); ++y)
        for (int x = tile_x * kTile + ((tile_x * kTile + y + colour) & 1);
             x < std::min(film.width, (tile_x + 1) * kTile); x += 2)
            visit(std::size_t(y) * std::size_t(film.width) + std::size_t(x));
}

double mean_radiance(const Film& film, const Tiles& tiles, int colour)
{
    double sum = 0, count = 0;
    for (int y = 0; y < tiles.down; ++y)
        for (int x = 0; x < tiles.across; ++x)
            for_each_pixel(film, x, y, colour, [&](std::size_t i) {
                for (int c = 0; c < 3; ++c) {
                    if (!std::isfinite(film.mean[i][c])) continue;
                    sum += double(film.mean[i][c]);
                    ++count;
                }
            });
    return count > 0 ? sum / count : 0;
}

/// Mean variance of a tile's pixels, weighed as the goal weighs it.
Tiles variances(const Film& film, AdaptiveGoal goal, int colour)
{
    Tiles out{.across = (film.width + kTile - 1) / kTile, .down = (film.height + kTile - 1) / kTile, .values = {}};
    out.values.resize(std::size_t(out.across) * std::size_t(out.down));
    const double floor = 0.01 * std::pow(mean_radiance(film, out, colour), 2);
    for (int y = 0; y < out.down; ++y)
        for (int x = 0; x < out.across; ++x) {
            double variance = 0, square = 0, count = 0;
            for_each_pixel(film, x, y, colour, [&](std::size_t i) {
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

/// Samples of a tile as a share of the average, after it is cut to the range and to steps.
double stepped(double share, double least)
{
    const double cut = std::clamp(share, least, kMost);
    return std::exp2(std::floor(std::log2(cut) * kStepsAnOctave + 1e-9) / kStepsAnOctave);
}

/// The largest factor for which the shares, cut and stepped, are no more than one on average.
double balance(const Tiles& tiles, double least)
{
    const auto average = [&](double factor) {
        double sum = 0;
        for (const double d : tiles.values) sum += stepped(factor * d, least);
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
    assume(pilot.variance.size() == pilot.pixel_count() && pilot.pixel_count() > 0 && pilot.samples <= spp);
    const double least = std::max(kLeast, double(pilot.samples) / double(spp));
    std::map<std::uint64_t, SampleGroup, std::greater<>> groups;
    for (const int colour : {0, 1}) {
        Tiles shares = deviations(variances(pilot, goal, 1 - colour));
        if (std::all_of(shares.values.begin(), shares.values.end(), [](double d) { return d == 0; }))
            std::fill(shares.values.begin(), shares.values.end(), 1.0);
        const double factor = balance(shares, least);
        for (int y = 0; y < shares.down; ++y)
            for (int x = 0; x < shares.across; ++x) {
                const double samples = stepped(factor * shares.at(x, y), least) * double(spp) - double(pilot.samples);
                const auto even = static_cast<std::uint64_t>(std::max(samples, 0.0) / 2 + 1e-9) * 2;
                SampleGroup& group = groups[even];
                group.samples = even;
                for_each_pixel(pilot, x, y, colour,
                               [&](std::size_t i) { group.pixels.push_back(static_cast<std::uint32_t>(i)); });
            }
    }
    std::vector<SampleGroup> out;
    for (auto& [samples, group] : groups)
        if (!group.pixels.empty()) out.push_back(std::move(group));
    return out;
}

void add_samples(Film& film, const Film& part, std::span<const std::uint32_t> pixels)
{
    assume(film.counts.size() == film.pixel_count() && part.variance.size() == pixels.size());
    for (std::size_t k = 0; k < pixels.size(); ++k) {
        const std::size_t i = pixels[k];
        const double before = film.counts[i], added = double(part.samples), share = added / (before + added);
        film.mean[i] = vec3(dvec3(film.mean[i]) * (1 - share) + dvec3(part.mean[k]) * share);
        film.variance[i] =
            vec3(dvec3(film.variance[i]) * (1 - share) * (1 - share) + dvec3(part.variance[k]) * share * share);
        film.alpha[i] = float(double(film.alpha[i]) * (1 - share) + double(part.alpha[k]) * share);
        film.counts[i] += static_cast<std::uint32_t>(part.samples);
    }
    film.nonfinite += part.nonfinite;
    film.truncated += part.truncated;
}

}  // namespace etalon
