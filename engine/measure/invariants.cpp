#include "engine/measure/invariants.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "engine/base/error.h"
#include "engine/math/stats.h"
#include "engine/measure/compare.h"
#include "engine/scene/builder.h"

namespace etalon {
namespace {

/// Half the mean squared difference of two films: the squared error of one. With the standard error of its logarithm,
/// by the scatter over tiles of 8 by 8.
struct LogError {
    double value = 0;
    double deviation = 0;
};

LogError log_error(const Film& a, const Film& b)
{
    constexpr int kTile = 8;
    std::vector<double> tiles;
    for (int y = 0; y < a.height; y += kTile) {
        for (int x = 0; x < a.width; x += kTile) {
            double sum = 0, count = 0;
            for (int v = y; v < std::min(y + kTile, a.height); ++v) {
                for (int u = x; u < std::min(x + kTile, a.width); ++u) {
                    const std::size_t i = std::size_t(v) * std::size_t(a.width) + std::size_t(u);
                    const dvec3 d = dvec3(a.mean[i]) - dvec3(b.mean[i]);
                    if (!is_finite(d)) continue;
                    sum += dot(d, d) / 6;
                    ++count;
                }
            }
            if (count > 0) tiles.push_back(sum / count);
        }
    }
    const double n = double(tiles.size());
    double mean = 0, squares = 0;
    for (const double tile : tiles) mean += tile / n;
    for (const double tile : tiles) squares += (tile - mean) * (tile - mean);
    if (!(mean > 0) || n < 2) return {};
    return {std::log(mean), std::sqrt(squares / (n - 1) / n) / mean};
}

}  // namespace

Invariant error_slope(const DrawCall& draw, double false_alarm)
{
    double weights = 0, mean_x = 0, mean_y = 0;
    std::vector<double> x, y, w;
    for (const std::uint64_t samples : kSlopeSamples) {
        const LogError error = log_error(draw(samples), draw(samples));
        if (error.deviation == 0) return {true, "the picture has no noise"};
        x.push_back(std::log(double(samples)));
        y.push_back(0.5 * error.value);
        w.push_back(1 / std::pow(0.5 * error.deviation, 2));
        weights += w.back();
        mean_x += w.back() * x.back();
        mean_y += w.back() * y.back();
    }
    mean_x /= weights;
    mean_y /= weights;
    double xx = 0, xy = 0;
    for (std::size_t i = 0; i < x.size(); ++i) {
        xx += w[i] * (x[i] - mean_x) * (x[i] - mean_x);
        xy += w[i] * (x[i] - mean_x) * (y[i] - mean_y);
    }
    const double slope = xy / xx;
    const double half = -normal_quantile(0.5 * false_alarm) / std::sqrt(xx);
    return {std::abs(slope + 0.5) <= half, fmt::format("slope {:.3f} ± {:.3f}", slope, half)};
}

Scene furnace_scene()
{
    SceneBuilder builder("furnace");
    std::vector<Index> materials = {builder.lambert("diffuse", dvec3(1)),
                                    builder.material({.name = "mirror", .model = BsdfModel::mirror}),
                                    builder.material({.name = "glass", .model = BsdfModel::dielectric})};
    for (const double roughness : {0.0, 0.25, 0.5, 0.75, 1.0})
        materials.push_back(builder.metallic_roughness("metal", dvec3(1), 1, roughness));
    constexpr int kAcross = 4;
    for (std::size_t i = 0; i < materials.size(); ++i) {
        const double column = double(i % kAcross), row = double(i / kAcross);
        builder.sphere("ball", dvec3(2 * column - 3, 1 - 2 * row, 0), 0.9, materials[i]);
    }
    Camera camera;
    camera.orthographic = true;
    camera.xmag = 4;
    camera.ymag = 2;
    builder.camera(camera, translation(dvec3(0, 0, 10)));
    builder.environment({.radiance = dvec3(1)});
    builder.size(64, 32);
    return std::move(builder).finish();
}

Invariant judge_furnace(const Film& film, double false_alarm)
{
    Film white = film;
    for (vec3& value : white.mean) value = vec3(1);
    for (vec3& value : white.variance) value = vec3(0);
    constexpr double kTables = 2e-3;
    const Comparison comparison = compare(film, white, {.false_alarm = false_alarm, .rounding = kTables});
    std::string why = comparison.reasons.empty() ? "" : comparison.reasons.front();
    if (comparison.test) {
        const TileFinding& worst = comparison.test->worst_tile;
        why += fmt::format("{}worst tile ({}, {}) off by {:+.3f}%", why.empty() ? "" : "; ", worst.x, worst.y,
                           100 * worst.relative);
    }
    return {passed(comparison.verdict), why};
}

}  // namespace etalon
