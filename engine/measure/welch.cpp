#include "engine/measure/welch.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "engine/base/parallel.h"
#include "engine/math/stats.h"

namespace etalon {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

/// What one test adds up over its pixels, in one channel.
struct Sums {
    double difference = 0;
    double magnitude = 0;  ///< (|a| + |b|) / 2
    double variance = 0;   ///< of `difference`
    double rounding = 0;   ///< fully correlated, so it adds up linearly
    double spread = 0;     ///< sum of variance^2 / (degrees of freedom + 2): of what is known of the variance itself

    void add(const Sums& other)
    {
        difference += other.difference;
        magnitude += other.magnitude;
        variance += other.variance;
        rounding += other.rounding;
        spread += other.spread;
    }
    double standard_error() const { return std::sqrt(variance + rounding * rounding); }
    /// Welch 1947's, which is right where the summed variances have few degrees of freedom each, as Satterthwaite's is
    /// not: v² of one with ν of them is too large by 1 + 2/ν on average.
    double degrees_of_freedom() const
    {
        return spread > 0 ? std::max(variance * variance / spread - 2, 1.0) : kInfinity;
    }
    /// Without variance and without a difference there is nothing to test.
    bool testable() const { return variance > 0 || difference != 0; }
    double z() const
    {
        if (difference == 0) return 0;
        const double error = standard_error();
        return error > 0 ? difference / error : std::copysign(kInfinity, difference);
    }
    double p() const { return student_two_sided_p(z(), degrees_of_freedom()); }
    double score() const { return standard_score(z(), degrees_of_freedom()); }
    double relative() const { return magnitude > 0 ? difference / magnitude : 0; }
    /// The relative difference that a test at `level` finds with probability `power` (ST-4).
    double detectable(double level, double power) const
    {
        const double critical = -student_quantile(0.5 * level, degrees_of_freedom()) + normal_quantile(power);
        return critical * standard_error() / magnitude;
    }
};

struct Tile {
    int x = 0, y = 0, width = 0, height = 0;
    std::array<Sums, 3> sums{};
    // Per-pixel statistics of this tile, merged afterwards in tile order.
    std::uint64_t pixels = 0;  ///< channels with variance
    double z_sum = 0, z_square_sum = 0, z_max = 0;
    std::uint64_t over_bound = 0, constant = 0, constant_unequal = 0;
    std::array<std::uint64_t, 20> histogram{};
};

std::size_t bin(double p)
{
    return std::min<std::size_t>(static_cast<std::size_t>(p * 20), 19);
}

Sums pixel_sums(const Film& a, const Film& b, std::size_t i, int c, double rounding)
{
    const double x = a.mean[i][c];
    const double y = b.mean[i][c];
    double variance_a = a.variance[i][c];
    const double variance_b = b.variance[i][c];
    // A pixel's variance from two replicates is often far too small by chance, and 0 on an edge that both hit as often:
    // then the films tell more of the error than either of them. No pixel alone says more than 3 deviations (MC-10).
    if (a.replicates > 0 || b.replicates > 0) variance_a = std::max(variance_a, (x - y) * (x - y) / 9 - variance_b);
    return {.difference = x - y,
            .magnitude = 0.5 * (std::abs(x) + std::abs(y)),
            .variance = variance_a + variance_b,
            .rounding = rounding * std::max(std::abs(x), std::abs(y)),
            .spread = variance_a * variance_a / (a.degrees_of_freedom(i) + 2) +
                      variance_b * variance_b / (b.degrees_of_freedom(i) + 2)};
}

bool finite_pair(const Film& a, const Film& b, std::size_t i, int c)
{
    return std::isfinite(a.mean[i][c]) && std::isfinite(b.mean[i][c]) && std::isfinite(a.variance[i][c]) &&
           std::isfinite(b.variance[i][c]);
}

void add_pixel(Tile& tile, const Sums& pixel, double pixel_level)
{
    if (pixel.variance == 0) {
        ++tile.constant;
        if (std::abs(pixel.difference) > pixel.rounding) ++tile.constant_unequal;
        return;
    }
    const double p = pixel.p();
    const double z = pixel.score();
    ++tile.pixels;
    tile.z_sum += z;
    tile.z_square_sum += z * z;
    tile.z_max = std::max(tile.z_max, std::abs(z));
    if (p < pixel_level) ++tile.over_bound;
    ++tile.histogram[bin(p)];
}

void measure_tile(Tile& tile, const Film& a, const Film& b, double rounding, double pixel_level)
{
    for (int y = tile.y; y < tile.y + tile.height; ++y) {
        for (int x = tile.x; x < tile.x + tile.width; ++x) {
            const std::size_t i = std::size_t(y) * std::size_t(a.width) + std::size_t(x);
            for (int c = 0; c < 3; ++c) {
                if (!finite_pair(a, b, i, c)) continue;
                const Sums pixel = pixel_sums(a, b, i, c, rounding);
                tile.sums[std::size_t(c)].add(pixel);
                add_pixel(tile, pixel, pixel_level);
            }
        }
    }
}

std::vector<Tile> cut_into_tiles(int width, int height, int size)
{
    std::vector<Tile> tiles;
    for (int y = 0; y < height; y += size)
        for (int x = 0; x < width; x += size)
            tiles.push_back({.x = x, .y = y, .width = std::min(size, width - x), .height = std::min(size, height - y)});
    return tiles;
}

TileFinding finding(const Tile& place, int channel, const Sums& sums)
{
    return {.x = place.x,
            .y = place.y,
            .width = place.width,
            .height = place.height,
            .channel = channel,
            .z = sums.z(),
            .p = sums.p(),
            .relative = sums.relative()};
}

/// The middle value; 0 of nothing.
double median(std::vector<double> values)
{
    if (values.empty()) return 0;
    const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
    std::nth_element(values.begin(), middle, values.end());
    return *middle;
}

void merge_pixels(StatisticalTest& test, const std::vector<Tile>& tiles)
{
    double count = 0, sum = 0, square_sum = 0;
    for (const Tile& tile : tiles) {
        count += static_cast<double>(tile.pixels);
        sum += tile.z_sum;
        square_sum += tile.z_square_sum;
        test.pixel_z_max = std::max(test.pixel_z_max, tile.z_max);
        test.pixel_over_bound += tile.over_bound;
        test.constant += tile.constant;
        test.constant_unequal += tile.constant_unequal;
        for (std::size_t k = 0; k < tile.histogram.size(); ++k) test.pixel_p_histogram[k] += tile.histogram[k];
    }
    // z is of mean 0 under equality; about its own mean a common shift would not show twice, here and in the whole.
    if (count > 1) test.pixel_z_std = std::sqrt(std::max(0.0, (square_sum - sum * sum / count) / (count - 1)));
}

void test_tiles(StatisticalTest& test, const std::vector<Tile>& tiles)
{
    std::vector<double> detectable;
    double smallest_uniformity = 1;
    double z_square_sum = 0, z_count = 0;
    for (int c = 0; c < 3; ++c) {
        std::vector<double> p_values;
        for (const Tile& tile : tiles) {
            const Sums& sums = tile.sums[std::size_t(c)];
            if (!sums.testable()) continue;
            const TileFinding found = finding(tile, c, sums);
            if (found.p <= test.worst_tile.p) test.worst_tile = found;
            if (found.p < test.level) test.failures.push_back(found);
            if (sums.variance == 0) continue;
            p_values.push_back(found.p);
            z_square_sum += sums.score() * sums.score();
            ++z_count;
            ++test.tile_p_histogram[bin(found.p)];
            if (sums.magnitude > 0) detectable.push_back(sums.detectable(test.level, test.power));
        }
        if (p_values.size() >= 5) smallest_uniformity = std::min(smallest_uniformity, ks_uniform_p(p_values));
    }
    if (z_count > 0) test.tile_z_std = std::sqrt(z_square_sum / z_count);
    test.uniformity_p = std::min(1.0, 3 * smallest_uniformity);
    test.detectable_tile = median(std::move(detectable));
    test.failed = test.failures.size();
    std::sort(test.failures.begin(), test.failures.end(), [](const TileFinding& l, const TileFinding& r) {
        return l.p != r.p ? l.p < r.p : std::abs(l.z) > std::abs(r.z);
    });
    if (test.failures.size() > 16) test.failures.resize(16);
}

void test_whole(StatisticalTest& test, const std::vector<Tile>& tiles, const Film& film)
{
    const Tile place{.width = film.width, .height = film.height};
    test.detectable_whole = kInfinity;
    for (int c = 0; c < 3; ++c) {
        Sums sums;
        for (const Tile& tile : tiles) sums.add(tile.sums[std::size_t(c)]);
        test.whole[std::size_t(c)] = finding(place, c, sums);
        if (test.whole[std::size_t(c)].p < test.level) ++test.failed;
        if (sums.variance > 0 && sums.magnitude > 0)
            test.detectable_whole = std::min(test.detectable_whole, sums.detectable(test.level, test.power));
    }
    if (std::isinf(test.detectable_whole)) test.detectable_whole = 0;
}

std::uint64_t count_tests(const std::vector<Tile>& tiles)
{
    std::uint64_t count = 3;
    for (const Tile& tile : tiles)
        for (const Sums& sums : tile.sums)
            if (sums.testable()) ++count;
    return count;
}

}  // namespace

StatisticalTest welch_test(const Film& a, const Film& b, const CompareSettings& settings)
{
    std::vector<Tile> tiles = cut_into_tiles(a.width, a.height, settings.tile);
    const double pixel_level = sidak_level(settings.false_alarm, static_cast<double>(3 * a.pixel_count()));
    parallel_for(tiles.size(), [&](std::size_t t) { measure_tile(tiles[t], a, b, settings.rounding, pixel_level); });

    StatisticalTest test{.false_alarm = settings.false_alarm, .tests = count_tests(tiles), .power = settings.power};
    test.level = sidak_level(settings.false_alarm, static_cast<double>(test.tests));
    merge_pixels(test, tiles);
    test_tiles(test, tiles);
    test_whole(test, tiles, a);
    return test;
}

}  // namespace etalon
