#include "engine/measure/picture_error.h"

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <numeric>
#include <random>

#include "engine/base/error.h"
#include "engine/image/metrics.h"
#include "engine/math/stats.h"
#include "engine/reference/reference.h"
#include "engine/scene/requirements.h"

namespace etalon {
namespace {

constexpr std::size_t kPixelsPerCell = 16;
/// Fewer pixels than this in a cell would leave its scatter unknown.
constexpr std::size_t kLeastCell = 64;
constexpr double kTail = 0.025;  // of a 95% interval

/// Sums over the pixels of one cell.
struct CellSums {
    double count = 0, sum = 0, squares = 0;

    void add(double value)
    {
        ++count;
        const double off = value - sum / std::max(count - 1, 1.0);
        // Welford's update of the sum of squared deviations (M3).
        if (count > 1) squares += off * off * (count - 1) / count;
        sum += value;
    }
    double mean() const { return count > 0 ? sum / count : 0; }
    double variance_of_mean() const { return count > 1 ? squares / (count - 1) / count : 0; }
};

/// The picture's mean of a value from stratified sampling, and how uncertain it is.
struct Stratified {
    double mean = 0;
    double variance = 0;
    double dof = 1;  ///< Satterthwaite

    double off = 0;  ///< what the mean may be off by besides, systematically

    double half_width() const { return -student_quantile(kTail, dof) * std::sqrt(variance) + off; }
};

Stratified estimate(const PixelProbe& probe, const std::vector<CellSums>& cells)
{
    Stratified out;
    double weights = 0, spread = 0;
    for (std::size_t h = 0; h < cells.size(); ++h) {
        if (cells[h].count == 0) continue;
        const double w = probe.weight(h);
        const double v = w * w * cells[h].variance_of_mean();
        weights += w;
        out.mean += w * cells[h].mean();
        out.variance += v;
        if (cells[h].count > 1) spread += v * v / (cells[h].count - 1);
    }
    if (weights == 0) return {};
    out.mean /= weights;
    if (spread > 0) out.dof = out.variance * out.variance / spread;
    out.variance /= weights * weights;
    return out;
}

/// For what is not negative. By the logarithm where the value stands out of its uncertainty, which keeps the interval
/// above 0 and longer upwards, as the scatter of squares is.
Estimate positive(const Stratified& of)
{
    const double half = of.half_width();
    if (of.mean <= 0 || half > of.mean) return {std::max(of.mean, 0.0), 0, std::max(of.mean, 0.0) + half};
    const double factor = std::exp(half / of.mean);
    return {of.mean, of.mean / factor, of.mean * factor};
}

Estimate root(const Estimate& e, double scale)
{
    return {std::sqrt(e.value) * scale, std::sqrt(e.low) * scale, std::sqrt(e.high) * scale};
}

/// f(b) for an estimate `b` of variance `v`, without what that noise adds in expectation to second order: the mean of f
/// one deviation to either side exceeds f by as much. Exact for squares.
template <typename Function>
double without_noise(const Function& f, double b, double v)
{
    const double here = f(b);
    const double s = std::sqrt(v);
    return s > 0 ? 2 * here - 0.5 * (f(b + s) + f(b - s)) : here;
}

bool is_finite(const vec3& v)
{
    return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z);
}

/// The probed pixels of `film`, as a film of one row.
Film at_pixels(const Film& film, const PixelProbe& probe)
{
    Film out{.width = static_cast<int>(probe.pixels.size()), .height = 1, .samples = film.samples};
    for (const std::uint32_t pixel : probe.pixels) {
        out.mean.push_back(film.mean[pixel]);
        out.alpha.push_back(film.alpha.empty() ? 1.0f : film.alpha[pixel]);
        if (!film.variance.empty()) out.variance.push_back(film.variance[pixel]);
    }
    return out;
}

/// Sums by cell of `value(k)` over the probed pixels k that are finite on both sides.
template <typename Value>
std::vector<CellSums> sum_cells(const PixelProbe& probe, const Film& film, const Value& value)
{
    std::vector<CellSums> cells(probe.ends.size());
    std::size_t k = 0;
    for (std::size_t h = 0; h < cells.size(); ++h)
        for (; k < probe.ends[h]; ++k)
            if (is_finite(film.mean[k]) && is_finite(probe.truth.mean[k])) cells[h].add(value(k));
    return cells;
}

/// Developed colours over black, in steps of 1/255.
std::vector<dvec3> displayed(const Film& film, const DevelopSettings& settings)
{
    const Image image = develop(film, settings);
    std::vector<dvec3> out;
    for (std::size_t i = 0; i < image.pixel_count(); ++i) {
        const float* p = &image.values[4 * i];
        out.push_back(255.0 * double(p[3]) * dvec3(p[0], p[1], p[2]));
    }
    return out;
}

/// Squared distance on the display of each probed pixel, without the probe's noise: per channel, as without_noise().
std::vector<double> display_squares(const Film& film, const PixelProbe& probe, const DevelopSettings& settings)
{
    const std::vector<dvec3> a = displayed(film, settings);
    const auto squares = [&](const Film& truth) {
        std::vector<double> out;
        const std::vector<dvec3> b = displayed(truth, settings);
        for (std::size_t k = 0; k < a.size(); ++k) out.push_back(dot(a[k] - b[k], a[k] - b[k]) / 3);
        return out;
    };
    std::vector<double> out = squares(probe.truth);
    const std::vector<double> here = out;
    for (int c = 0; c < 3; ++c) {
        std::array<std::vector<double>, 2> beside;
        for (std::size_t side = 0; side < 2; ++side) {
            Film moved = probe.truth;
            for (std::size_t k = 0; k < a.size(); ++k) {
                const float s = std::sqrt(moved.variance[k][c]);
                moved.mean[k][c] += side == 0 ? s : -s;
            }
            beside[side] = squares(moved);
        }
        for (std::size_t k = 0; k < a.size(); ++k) out[k] -= 0.5 * (beside[0][k] + beside[1][k]) - here[k];
    }
    return out;
}

void add_map(PictureError& out, const std::vector<CellSums>& squares, double mean)
{
    out.map.clear();
    for (const CellSums& cell : squares) out.map.push_back(mean > 0 ? std::sqrt(std::max(cell.mean(), 0.0)) / mean : 0);
}

}  // namespace

double PixelProbe::weight(std::size_t cell) const
{
    const auto cx = static_cast<int>(cell) % cells_x;
    const auto cy = static_cast<int>(cell) / cells_x;
    const auto edge = [](int i, int n, int size) { return static_cast<int>(std::int64_t{size} * i / n); };
    const double area = double(edge(cx + 1, cells_x, width) - edge(cx, cells_x, width)) *
                        double(edge(cy + 1, cells_y, height) - edge(cy, cells_y, height));
    return area / (double(width) * height);
}

PixelProbe choose_pixels(int width, int height, std::size_t count, std::uint64_t seed)
{
    if (width <= 0 || height <= 0) throw Error(Blame::input, "a picture of no pixels has no error");
    const double pixels = double(width) * height;
    const double cells = std::clamp(std::min(double(count / kPixelsPerCell), pixels / double(kLeastCell)), 1.0, 1e4);
    const double side = std::sqrt(pixels / cells);
    PixelProbe out{.width = width, .height = height};
    out.cells_x = std::clamp(static_cast<int>(std::lround(width / side)), 1, width);
    out.cells_y = std::clamp(static_cast<int>(std::lround(cells / out.cells_x)), 1, height);
    const std::size_t each = std::max<std::size_t>(count / (std::size_t(out.cells_x) * std::size_t(out.cells_y)), 2);
    std::mt19937_64 random(seed);
    std::vector<std::uint32_t> all;
    for (int cy = 0; cy < out.cells_y; ++cy) {
        for (int cx = 0; cx < out.cells_x; ++cx) {
            const auto edge = [](int i, int n, int size) { return static_cast<int>(std::int64_t{size} * i / n); };
            all.clear();
            for (int y = edge(cy, out.cells_y, height); y < edge(cy + 1, out.cells_y, height); ++y)
                for (int x = edge(cx, out.cells_x, width); x < edge(cx + 1, out.cells_x, width); ++x)
                    all.push_back(static_cast<std::uint32_t>(y) * static_cast<std::uint32_t>(width) +
                                  static_cast<std::uint32_t>(x));
            const std::size_t drawn = std::min(each, all.size());
            for (std::size_t k = 0; k < drawn; ++k) std::swap(all[k], all[k + random() % (all.size() - k)]);
            std::sort(all.begin(), all.begin() + std::ptrdiff_t(drawn));
            out.pixels.insert(out.pixels.end(), all.begin(), all.begin() + std::ptrdiff_t(drawn));
            out.ends.push_back(out.pixels.size());
        }
    }
    return out;
}

RenderSettings probe_settings(const RenderSettings& settings, const ProbeSettings& how)
{
    RenderSettings out = settings;
    out.renderer = Renderer::reference;
    out.spp = how.samples;
    out.max_depth = std::max(how.depth, settings.max_depth);
    out.seed = settings.seed ^ how.seed;
    out.shard = {};
    out.aovs = false;
    return out;
}

PixelProbe trace_probe(const PosedScene& posed, const RenderSettings& settings, const ProbeSettings& how,
                       const Progress& progress)
{
    PixelProbe out = choose_pixels(posed.view.width, posed.view.height, how.pixels, how.seed);
    out.settings = probe_settings(settings, how);
    const auto end = std::chrono::steady_clock::now() + std::chrono::duration_cast<std::chrono::steady_clock::duration>(
                                                            std::chrono::duration<double>(how.seconds));
    out.truth =
        reference::render_pixels(posed, require(posed, out.settings), out.settings, out.pixels, progress.until(end));
    out.cut = out.truth.samples < how.samples;
    return out;
}

PictureError measure_picture(const Film& film, const PixelProbe& probe, const DevelopSettings& develop)
{
    if (film.width != probe.width || film.height != probe.height)
        throw Error(Blame::input, "the probe is of a picture of another size");
    if (probe.truth.mean.size() != probe.pixels.size() || probe.truth.variance.size() != probe.pixels.size())
        throw Error(Blame::input, "the probe has no values with their variance", "trace at least two samples a pixel");
    const Film a = at_pixels(film, probe);
    const Film& b = probe.truth;
    PictureError out{.cells_x = probe.cells_x,
                     .cells_y = probe.cells_y,
                     .pixels = probe.pixels.size(),
                     .samples = b.samples,
                     .depth = probe.settings.max_depth,
                     .cut = probe.cut};
    for (std::size_t k = 0; k < a.mean.size(); ++k) out.left_out += !is_finite(a.mean[k]);

    const auto mean_of = [](const vec3& v) { return (double(v.x) + v.y + v.z) / 3; };
    const double mean = estimate(probe, sum_cells(probe, a, [&](std::size_t k) { return mean_of(b.mean[k]); })).mean;
    const double per_mean = mean > 0 ? 1 / mean : 0;
    out.mean = mean;

    const auto per_channel = [&](const auto& f) {
        return [&a, &b, f](std::size_t k) {
            double sum = 0;
            for (int c = 0; c < 3; ++c) {
                const double value = a.mean[k][c];
                sum += without_noise([&](double x) { return f(value, x); }, b.mean[k][c], b.variance[k][c]);
            }
            return sum / 3;
        };
    };
    const auto square = [](double x, double y) { return (x - y) * (x - y); };
    const std::vector<CellSums> squares = sum_cells(probe, a, per_channel(square));
    const Estimate mse = positive(estimate(probe, squares));
    out.rmse = root(mse, 1);
    out.relative = root(mse, per_mean);
    add_map(out, squares, mean);

    const double floor = kRelativeEpsilon * mean * mean;
    const auto relative_square = [floor, square](double x, double y) {
        const double scale = y * y + floor;
        return scale > 0 ? square(x, y) / scale : 0;
    };
    Stratified relative = estimate(probe, sum_cells(probe, a, per_channel(relative_square)));
    // The noise is taken off to second order. Higher orders are smaller by about the relative variance; three times
    // that covers the skewed distributions of the tests.
    relative.off =
        estimate(probe, sum_cells(probe, a,
                                  [&](std::size_t k) {
                                      double sum = 0;
                                      for (int c = 0; c < 3; ++c) {
                                          const double y = b.mean[k][c], v = b.variance[k][c];
                                          const double scale = y * y + floor;
                                          const auto f = [&](double x) { return relative_square(a.mean[k][c], x); };
                                          if (scale > 0) sum += 3 * v / scale * std::abs(f(y) - without_noise(f, y, v));
                                      }
                                      return sum / 3;
                                  }))
            .mean;
    out.relmse = positive(relative);

    const std::vector<double> shown = display_squares(a, probe, develop);
    out.display = root(positive(estimate(probe, sum_cells(probe, a, [&](std::size_t k) { return shown[k]; }))), 1);

    const Stratified shift =
        estimate(probe, sum_cells(probe, a, [&](std::size_t k) { return mean_of(a.mean[k]) - mean_of(b.mean[k]); }));
    const double half = shift.half_width();
    out.brightness = {shift.mean * per_mean, (shift.mean - half) * per_mean, (shift.mean + half) * per_mean};

    if (!a.variance.empty()) {
        const auto noiseless = [&](std::size_t k) {
            return per_channel(square)(k) - (is_finite(a.variance[k]) ? mean_of(a.variance[k]) : 0);
        };
        out.systematic = root(positive(estimate(probe, sum_cells(probe, a, noiseless))), per_mean);
    }
    return out;
}

}  // namespace etalon
