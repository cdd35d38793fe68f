#include "engine/image/metrics.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>

#include "engine/base/error.h"
#include "engine/base/parallel.h"

namespace etalon {
namespace {

/// Neumaier 1974: the sum and what rounding has taken from it.
class Sum {
 public:
    void add(double x)
    {
        const double next = sum_ + x;
        lost_ += std::abs(sum_) >= std::abs(x) ? (sum_ - next) + x : (x - next) + sum_;
        sum_ = next;
    }
    double value() const { return sum_ + lost_; }

 private:
    double sum_ = 0;
    double lost_ = 0;
};

void require_same_shape(const Image& a, const Image& b)
{
    if (a.width != b.width || a.height != b.height || a.channels != b.channels)
        throw Error(Blame::input,
                    fmt::format("cannot compare {}x{} pixels of {} channels with {}x{} of {}", a.width, a.height,
                                a.channels, b.width, b.height, b.channels),
                    "compare pictures of one size; nothing is cropped or scaled behind your back");
    if (a.values.empty()) throw Error(Blame::input, "cannot compare pictures without pixels");
}

bool both_finite(float a, float b)
{
    return std::isfinite(a) && std::isfinite(b);
}

/// Luminance of Rec.709, or the only channel; what is not finite counts as 0.
Image luminance(const Image& image)
{
    Image out(image.width, image.height, 1);
    for (std::size_t i = 0; i < image.pixel_count(); ++i) {
        const float* p = &image.values[i * std::size_t(image.channels)];
        const double y =
            image.channels < 3 ? double(p[0]) : 0.2126 * double(p[0]) + 0.7152 * double(p[1]) + 0.0722 * double(p[2]);
        out.values[i] = std::isfinite(y) ? float(y) : 0.0f;
    }
    return out;
}

constexpr int kRadius = 5;

using Window = std::array<double, 2 * kRadius + 1>;

/// exp(-d²/2σ²), σ = 1.5, for d = -5 … 5.
Window gaussian_window()
{
    Window window{};
    for (int d = -kRadius; d <= kRadius; ++d) window[std::size_t(d + kRadius)] = std::exp(-d * d / (2 * 1.5 * 1.5));
    return window;
}

/// One window of SSIM: `visit(weight, a, b)` is called for every pixel of it inside the picture.
template <typename Visit>
void for_each_in_window(const Window& window, const Image& a, const Image& b, int x, int y, const Visit& visit)
{
    for (int v = std::max(0, y - kRadius); v <= std::min(a.height - 1, y + kRadius); ++v)
        for (int u = std::max(0, x - kRadius); u <= std::min(a.width - 1, x + kRadius); ++u) {
            const std::size_t i = std::size_t(v) * std::size_t(a.width) + std::size_t(u);
            visit(window[std::size_t(v - y + kRadius)] * window[std::size_t(u - x + kRadius)], double(a.values[i]),
                  double(b.values[i]));
        }
}

double window_similarity(const Window& window, const Image& a, const Image& b, int x, int y, double c1, double c2)
{
    double weight = 0, mean_a = 0, mean_b = 0;
    for_each_in_window(window, a, b, x, y, [&](double w, double va, double vb) {
        weight += w;
        mean_a += w * va;
        mean_b += w * vb;
    });
    mean_a /= weight;
    mean_b /= weight;
    // Centred: E[x²] - μ² is all rounding where a bright picture has little noise (K1).
    double var_a = 0, var_b = 0, covariance = 0;
    for_each_in_window(window, a, b, x, y, [&](double w, double va, double vb) {
        var_a += w * (va - mean_a) * (va - mean_a);
        var_b += w * (vb - mean_b) * (vb - mean_b);
        covariance += w * (va - mean_a) * (vb - mean_b);
    });
    const double numerator = (2 * mean_a * mean_b + c1) * (2 * covariance / weight + c2);
    const double denominator = (mean_a * mean_a + mean_b * mean_b + c1) * (var_a / weight + var_b / weight + c2);
    return denominator == 0 ? 1 : std::min(1.0, numerator / denominator);
}

double range_of(const Image& image)
{
    float low = INFINITY, high = -INFINITY;
    for (const float value : image.values)
        if (std::isfinite(value)) {
            low = std::min(low, value);
            high = std::max(high, value);
        }
    return high > low ? double(high) - double(low) : 1;
}

struct Stop {
    double at;
    std::array<double, 3> color;
};

/// Rises in luminance throughout.
constexpr std::array kStops{
    Stop{0.0, {0, 0, 0}},          Stop{0.2, {0.15, 0.08, 0.55}}, Stop{0.4, {0.65, 0.12, 0.55}},
    Stop{0.6, {0.95, 0.40, 0.15}}, Stop{0.8, {0.99, 0.82, 0.25}}, Stop{1.0, {1, 1, 1}},
};

std::array<double, 3> false_color(double level)
{
    const double x = std::clamp(level, 0.0, 1.0);
    std::size_t i = 1;
    while (i + 1 < kStops.size() && kStops[i].at < x) ++i;
    const double t = (x - kStops[i - 1].at) / (kStops[i].at - kStops[i - 1].at);
    std::array<double, 3> out{};
    for (std::size_t c = 0; c < 3; ++c) out[c] = (1 - t) * kStops[i - 1].color[c] + t * kStops[i].color[c];
    return out;
}

/// Paints `color(a's values, b's values)` of every pixel where all are finite, green elsewhere.
template <typename Color>
Image paint(const Image& a, const Image& b, const Color& color)
{
    require_same_shape(a, b);
    const auto channels = std::size_t(a.channels);
    Image out(a.width, a.height, 3);
    for (std::size_t i = 0; i < a.pixel_count(); ++i) {
        double magnitude = 0, difference = 0;
        for (std::size_t c = 0; c < channels; ++c) {
            const double d = double(a.values[i * channels + c]) - double(b.values[i * channels + c]);
            magnitude += std::abs(d);
            difference += d;
        }
        const std::array<double, 3> rgb =
            std::isfinite(magnitude) ? color(magnitude, difference) : std::array{0.0, 1.0, 0.0};
        for (std::size_t c = 0; c < 3; ++c) out.values[3 * i + c] = float(rgb[c]);
    }
    return out;
}

}  // namespace

double structural_similarity(const Image& a, const Image& b, double peak)
{
    require_same_shape(a, b);
    assume(a.channels == 1);
    const double c1 = (0.01 * peak) * (0.01 * peak);
    const double c2 = (0.03 * peak) * (0.03 * peak);
    const Window window = gaussian_window();
    std::vector<double> rows(std::size_t(a.height));
    parallel_for(rows.size(), [&](std::size_t y) {
        Sum sum;
        for (int x = 0; x < a.width; ++x) sum.add(window_similarity(window, a, b, x, int(y), c1, c2));
        rows[y] = sum.value();
    });
    Sum total;
    for (const double row : rows) total.add(row);
    return total.value() / double(a.pixel_count());
}

Metrics measure_difference(const Image& a, const Image& b, double peak)
{
    require_same_shape(a, b);
    Metrics m;
    m.identical = std::memcmp(a.values.data(), b.values.data(), a.values.size() * sizeof(float)) == 0;
    Sum squares, sum_a, sum_b, abs_a, abs_b;
    std::uint64_t count = 0;
    for (std::size_t i = 0; i < a.values.size(); ++i) {
        m.nonfinite_a += std::isfinite(a.values[i]) ? 0 : 1;
        m.nonfinite_b += std::isfinite(b.values[i]) ? 0 : 1;
        if (!both_finite(a.values[i], b.values[i])) continue;
        const double va = double(a.values[i]);
        const double vb = double(b.values[i]);
        squares.add((va - vb) * (va - vb));
        sum_a.add(va);
        sum_b.add(vb);
        abs_a.add(std::abs(va));
        abs_b.add(std::abs(vb));
        m.max_abs = std::max(m.max_abs, std::abs(va - vb));
        ++count;
    }
    const double n = double(std::max<std::uint64_t>(count, 1));
    m.mse = squares.value() / n;
    m.rmse = std::sqrt(m.mse);
    m.mean_a = sum_a.value() / n;
    m.mean_b = sum_b.value() / n;

    const double scale = (abs_b.value() > 0 ? abs_b.value() : abs_a.value()) / n;
    Sum relative;
    for (std::size_t i = 0; i < a.values.size() && scale > 0; ++i) {
        if (!both_finite(a.values[i], b.values[i])) continue;
        // Dividing before squaring: neither the square of a value nor that of the scale may overflow or vanish.
        const double d = (double(a.values[i]) - double(b.values[i])) / scale;
        const double reference = double(b.values[i]) / scale;
        relative.add(d * d / (reference * reference + kRelativeEpsilon));
    }
    m.relmse = relative.value() / n;
    const double range = peak > 0 ? peak : range_of(b);
    if (m.mse > 0) m.psnr = 10 * std::log10(range * range / m.mse);
    m.ssim = structural_similarity(luminance(a), luminance(b), range);
    return m;
}

Image difference_picture(const Image& a, const Image& b, double full_scale)
{
    assume(full_scale > 0);
    return paint(a, b, [&](double magnitude, double) { return false_color(magnitude / full_scale); });
}

Image signed_difference_picture(const Image& a, const Image& b, double full_scale)
{
    assume(full_scale > 0);
    const double channels = a.channels;
    return paint(a, b, [&](double, double difference) {
        const double x = std::clamp(difference / channels / full_scale, -1.0, 1.0);
        // Towards red by losing blue and green, towards blue by losing red and green.
        return std::array{1 - std::max(0.0, -x), 1 - std::abs(x), 1 - std::max(0.0, x)};
    });
}

}  // namespace etalon
