#include "engine/image/flip.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "engine/base/error.h"
#include "engine/base/parallel.h"
#include "engine/image/develop.h"
#include "engine/math/types.h"

namespace etalon {
namespace {

// Constants of the paper and of the authors' program.
constexpr double kExponent = 0.7;         // q_c
constexpr double kKnee = 0.4;             // p_c
constexpr double kAtKnee = 0.95;          // p_t
constexpr double kFeatureWidth = 0.082;   // w, degrees
constexpr double kFeatureExponent = 0.5;  // q_f

/// One channel in double.
struct Plane {
    int width = 0, height = 0;
    std::vector<double> values;

    const double* row(int y) const { return &values[std::size_t(y) * std::size_t(width)]; }
};

using Kernel = std::vector<double>;  // of -radius … radius

/// In parallel where there is enough of it to pay for threads.
template <typename Function>
void for_rows(const Plane& plane, const Function& function)
{
    constexpr std::size_t kWorthThreads = std::size_t{1} << 16;
    const auto height = static_cast<std::size_t>(plane.height);
    if (plane.values.size() >= kWorthThreads)
        parallel_for(height, function);
    else
        for (std::size_t row = 0; row < height; ++row) function(row);
}

/// Borders are repeated.
Plane filtered_across(const Plane& in, const Kernel& kernel)
{
    const int radius = static_cast<int>(kernel.size() / 2);
    Plane out{in.width, in.height, std::vector<double>(in.values.size())};
    for_rows(in, [&](std::size_t row) {
        const double* const from = in.row(static_cast<int>(row));
        std::vector<double> wide(std::size_t(in.width + 2 * radius), from[0]);
        std::copy(from, from + in.width, wide.begin() + radius);
        std::fill(wide.end() - radius, wide.end(), from[in.width - 1]);
        double* const to = &out.values[row * std::size_t(in.width)];
        for (std::size_t k = 0; k < kernel.size(); ++k)
            for (std::size_t x = 0; x < std::size_t(in.width); ++x) to[x] += kernel[k] * wide[x + k];
    });
    return out;
}

Plane filtered_down(const Plane& in, const Kernel& kernel)
{
    const int radius = static_cast<int>(kernel.size() / 2);
    Plane out{in.width, in.height, std::vector<double>(in.values.size())};
    for_rows(in, [&](std::size_t row) {
        double* const to = &out.values[row * std::size_t(in.width)];
        for (int k = -radius; k <= radius; ++k) {
            const double* const from = in.row(std::clamp(static_cast<int>(row) + k, 0, in.height - 1));
            const double weight = kernel[std::size_t(k + radius)];
            for (std::size_t x = 0; x < std::size_t(in.width); ++x) to[x] += weight * from[x];
        }
    });
    return out;
}

Plane filtered(const Plane& in, const Kernel& horizontal, const Kernel& vertical)
{
    return filtered_down(filtered_across(in, horizontal), vertical);
}

Kernel normalized(Kernel kernel)
{
    double sum = 0;
    for (const double w : kernel) sum += w;
    for (double& w : kernel) w /= sum;
    return kernel;
}

/// a √(π/b) exp(-π² x²/b) of the contrast sensitivity, x in degrees: one dimension without the factor.
Kernel sensitivity(double b, double pixels_per_degree, int radius)
{
    Kernel out;
    for (int k = -radius; k <= radius; ++k) {
        const double x = k / pixels_per_degree;
        out.push_back(std::exp(-kPi * kPi * x * x / b));
    }
    return out;
}

double sum_of(const Kernel& kernel)
{
    double sum = 0;
    for (const double w : kernel) sum += w;
    return sum;
}

dvec3 xyz_from_linear(const dvec3& c)
{
    return dvec3((10135552 * c.x + 8788810 * c.y + 4435075 * c.z) / 24577794,
                 (2613072 * c.x + 8788810 * c.y + 887015 * c.z) / 12288897,
                 (1425312 * c.x + 8788810 * c.y + 70074185 * c.z) / 73733382);
}

const dvec3& white()
{
    static const dvec3 value = xyz_from_linear(dvec3(1));
    return value;
}

/// Luminance and two opponent colours, linear in light.
dvec3 opponent_from_linear(const dvec3& linear)
{
    const dvec3 v = xyz_from_linear(linear) / white();
    return dvec3(116 * v.y - 16, 500 * (v.x - v.y), 200 * (v.y - v.z));
}

dvec3 linear_from_opponent(const dvec3& c)
{
    const double y = (c.x + 16) / 116;
    const dvec3 xyz = dvec3(y + c.y / 500, y, y - c.z / 200) * white();
    static const dmat3 linear_from_xyz = glm::inverse(
        dmat3(xyz_from_linear(dvec3(1, 0, 0)), xyz_from_linear(dvec3(0, 1, 0)), xyz_from_linear(dvec3(0, 0, 1))));
    return linear_from_xyz * xyz;
}

/// CIELab with Hunt's adjustment: colours fade as they darken.
dvec3 hunt_lab(const dvec3& linear)
{
    constexpr double kDelta = 6.0 / 29;
    const auto f = [](double t) {
        return t > kDelta * kDelta * kDelta ? std::cbrt(t) : t / (3 * kDelta * kDelta) + 4.0 / 29;
    };
    const dvec3 v = xyz_from_linear(linear) / white();
    const double lightness = 116 * f(v.y) - 16;
    const double fade = 0.01 * lightness;
    return dvec3(lightness, fade * 500 * (f(v.x) - f(v.y)), fade * 200 * (f(v.y) - f(v.z)));
}

/// Abasi, Tehran, Fairchild 2020: absolute in lightness, Euclidean in colour.
double hyab(const dvec3& a, const dvec3& b)
{
    return std::abs(a.x - b.x) + std::hypot(a.y - b.y, a.z - b.z);
}

/// Colour difference to [0, 1]: linear up to the knee, compressed above it.
double redistributed(double difference)
{
    static const double most = std::pow(hyab(hunt_lab(dvec3(0, 1, 0)), hunt_lab(dvec3(0, 0, 1))), kExponent);
    const double power = std::pow(difference, kExponent);
    const double knee = kKnee * most;
    if (power < knee) return kAtKnee / knee * power;
    return kAtKnee + (power - knee) / (most - knee) * (1 - kAtKnee);
}

std::array<Plane, 3> opponent_planes(const Image& image)
{
    std::array<Plane, 3> out;
    for (Plane& plane : out) plane = {image.width, image.height, std::vector<double>(image.pixel_count())};
    for (std::size_t i = 0; i < image.pixel_count(); ++i) {
        dvec3 linear;
        for (int c = 0; c < 3; ++c) {
            const float value = image.values[i * std::size_t(image.channels) + std::size_t(c)];
            linear[c] = std::isfinite(value) ? linear_from_srgb(std::clamp(double(value), 0.0, 1.0)) : 0;
        }
        const dvec3 opponent = opponent_from_linear(linear);
        for (int c = 0; c < 3; ++c) out[std::size_t(c)].values[i] = opponent[c];
    }
    return out;
}

/// What an eye at that distance can resolve of each opponent colour.
std::array<Plane, 3> seen(const std::array<Plane, 3>& planes, double pixels_per_degree)
{
    struct Gaussian {
        double a, b;
    };
    constexpr Gaussian kLuminance{1, 0.0047}, kRedGreen{1, 0.0053}, kBlueYellow[] = {{34.1, 0.04}, {13.5, 0.025}};
    const int radius = static_cast<int>(std::ceil(3 * std::sqrt(0.04 / (2 * kPi * kPi)) * pixels_per_degree));
    const auto by = [&](const Plane& plane, const Gaussian& g) {
        const Kernel kernel = normalized(sensitivity(g.b, pixels_per_degree, radius));
        return filtered(plane, kernel, kernel);
    };
    std::array<Plane, 3> out{by(planes[0], kLuminance), by(planes[1], kRedGreen), by(planes[2], kBlueYellow[0])};
    // A sum of two Gaussians of two dimensions: each is separable, and weighs what its window holds.
    const Plane narrow = by(planes[2], kBlueYellow[1]);
    const auto weight = [&](const Gaussian& g) {
        const double sum = sum_of(sensitivity(g.b, pixels_per_degree, radius));
        return g.a * std::sqrt(kPi / g.b) * sum * sum;
    };
    const double w0 = weight(kBlueYellow[0]), w1 = weight(kBlueYellow[1]);
    for (std::size_t i = 0; i < narrow.values.size(); ++i)
        out[2].values[i] = (w0 * out[2].values[i] + w1 * narrow.values[i]) / (w0 + w1);
    return out;
}

/// Strength of edges and of points at each pixel.
struct Features {
    std::vector<double> edges, points;
};

Features features(const Plane& luminance, double pixels_per_degree)
{
    Plane y = luminance;
    for (double& value : y.values) value = (value + 16) / 116;
    const double sigma = 0.5 * kFeatureWidth * pixels_per_degree;
    const int radius = static_cast<int>(std::ceil(3 * sigma));
    Kernel smooth, first, second;
    double positive_first = 0, positive_second = 0, negative_second = 0;
    for (int k = -radius; k <= radius; ++k) {
        const double g = std::exp(-k * k / (2 * sigma * sigma));
        smooth.push_back(g);
        first.push_back(-k * g);
        second.push_back((k * k / (sigma * sigma) - 1) * g);
        positive_first += std::max(first.back(), 0.0);
        positive_second += std::max(second.back(), 0.0);
        negative_second -= std::min(second.back(), 0.0);
    }
    smooth = normalized(smooth);
    for (double& w : first) w /= positive_first;
    for (double& w : second) w /= w > 0 ? positive_second : negative_second;
    const auto strength = [&](const Kernel& kernel) {
        const Plane across = filtered(y, kernel, smooth), down = filtered(y, smooth, kernel);
        std::vector<double> out(across.values.size());
        for (std::size_t i = 0; i < out.size(); ++i) out[i] = std::hypot(across.values[i], down.values[i]);
        return out;
    };
    return {strength(first), strength(second)};
}

}  // namespace

Image flip(const Image& reference, const Image& test, double pixels_per_degree)
{
    if (reference.width != test.width || reference.height != test.height)
        throw Error(Blame::input, "cannot compare pictures of different sizes by FLIP", "compare pictures of one size");
    if (reference.values.empty()) throw Error(Blame::input, "cannot compare pictures without pixels");
    assume(reference.channels >= 3 && test.channels >= 3 && pixels_per_degree > 0);
    const std::array<Plane, 3> a = opponent_planes(reference), b = opponent_planes(test);
    const std::array<Plane, 3> seen_a = seen(a, pixels_per_degree), seen_b = seen(b, pixels_per_degree);
    const Features features_a = features(a[0], pixels_per_degree), features_b = features(b[0], pixels_per_degree);

    const auto lab = [](const std::array<Plane, 3>& planes, std::size_t i) {
        const dvec3 linear = linear_from_opponent(dvec3(planes[0].values[i], planes[1].values[i], planes[2].values[i]));
        return hunt_lab(glm::clamp(linear, dvec3(0), dvec3(1)));
    };
    Image out(reference.width, reference.height, 1);
    for (std::size_t i = 0; i < out.values.size(); ++i) {
        const double colour = redistributed(hyab(lab(seen_a, i), lab(seen_b, i)));
        const double feature = std::max(std::abs(features_a.edges[i] - features_b.edges[i]),
                                        std::abs(features_a.points[i] - features_b.points[i]));
        const double visible = std::pow(feature / std::sqrt(2.0), kFeatureExponent);
        out.values[i] = static_cast<float>(std::pow(colour, 1 - std::min(visible, 1.0)));
    }
    return out;
}

double mean_flip(const Image& reference, const Image& test, double pixels_per_degree)
{
    const Image map = flip(reference, test, pixels_per_degree);
    double sum = 0;
    for (const float value : map.values) sum += double(value);
    return sum / double(map.values.size());
}

}  // namespace etalon
