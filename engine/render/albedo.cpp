#include "engine/render/albedo.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "engine/base/parallel.h"
#include "shaders/shared/albedo.h"

namespace etalon {
namespace {

/// Cosines of the midpoints of `count` intervals of half a turn: both integrands are even in the azimuth.
template <std::size_t count>
std::array<double, count> azimuths()
{
    std::array<double, count> out{};
    for (std::size_t i = 0; i < count; ++i) out[i] = std::cos((double(i) + 0.5) / double(count) * kPi);
    return out;
}

double smith_lambda(double cosine, double alpha)
{
    return (std::sqrt(1 + alpha * alpha * (1 / (cosine * cosine) - 1)) - 1) / 2;
}

/// Λ of (SH-61), the fit of Estevez and Kulla 2017.
class SheenShadowing {
 public:
    explicit SheenShadowing(double alpha)
    {
        constexpr std::array<double, 5> kRough{21.5473, 3.82987, 0.19823, -1.97760, -4.32054};
        constexpr std::array<double, 5> kSmooth{25.3245, 3.32435, 0.16801, -1.27393, -4.85967};
        for (std::size_t i = 0; i < 5; ++i) p_[i] = kRough[i] + (1 - alpha) * (1 - alpha) * (kSmooth[i] - kRough[i]);
    }
    double operator()(double cosine) const
    {
        return std::exp(cosine < 0.5 ? fit(cosine) : 2 * fit(0.5) - fit(1 - cosine));
    }

 private:
    double fit(double x) const { return p_[0] / (1 + p_[1] * std::pow(x, p_[2])) + p_[3] * x + p_[4]; }
    std::array<double, 5> p_{};
};

/// Values at the corners of nx × ny cells, as cells.
template <class Value>
void add_table(std::vector<vec4>& out, std::size_t nx, std::size_t ny, unsigned threads, const Value& value)
{
    std::vector<float> corners((nx + 1) * (ny + 1));
    parallel_for(
        ny + 1,
        [&](std::size_t y) {
            for (std::size_t x = 0; x <= nx; ++x)
                corners[y * (nx + 1) + x] = static_cast<float>(value(double(x) / double(nx), double(y) / double(ny)));
        },
        threads);
    for (std::size_t y = 0; y < ny; ++y)
        for (std::size_t x = 0; x < nx; ++x) {
            const float* at = &corners[y * (nx + 1) + x];
            out.emplace_back(at[0], at[1], at[nx + 1], at[nx + 2]);
        }
}

/// Inverse of x^power = (1 + scale) c / (c + scale).
double cosine_at(double x_to_power, double scale)
{
    const double t = x_to_power / (1 + scale);
    return t < 1 ? std::min(scale * t / (1 - t), 1.0) : 1.0;
}

}  // namespace

namespace {

/// E, and the same with each normal weighed by (1 - wo·h)⁵.
dvec2 ggx_shares(double cosine, double alpha)
{
    // The mean of G2/G1 over visible normals (spherical caps of Dupuy and Benyoub 2023), u = 1 - v³: few rare normals
    // carry the tail of rough or grazing surfaces.
    constexpr int kSteps = 48;
    static const std::array<double, 24> kAzimuths = azimuths<24>();
    const double sine = std::sqrt(std::max(0.0, 1 - cosine * cosine));
    const double stretch = std::hypot(alpha * sine, cosine);
    const double x = alpha * sine / stretch, z = cosine / stretch;
    const double lambda_o = smith_lambda(cosine, alpha);
    dvec2 sum(0);
    for (int i = 0; i < kSteps; ++i) {
        const double v = (i + 0.5) / kSteps;
        const double cap = 1 - (1 - v * v * v) * (1 + z);
        const double radius = std::sqrt(std::max(0.0, (1 - cap) * (1 + cap)));
        dvec2 row(0);
        for (const double azimuth : kAzimuths) {
            const double hx = alpha * (radius * azimuth + x), hz = std::max(cap + z, 0.0);
            const double hy2 = alpha * alpha * radius * radius * (1 - azimuth * azimuth);
            const double size = std::sqrt(hx * hx + hy2 + hz * hz);
            const double along = (sine * hx + cosine * hz) / size;
            const double cosine_i = 2 * along * hz / size - cosine;
            if (cosine_i <= 0) continue;
            const double share = (1 + lambda_o) / (1 + lambda_o + smith_lambda(cosine_i, alpha));
            row += share * dvec2(1, std::pow(std::max(0.0, 1 - along), 5));
        }
        sum += 3 * v * v * row;
    }
    return sum / (kSteps * double(kAzimuths.size()));
}

}  // namespace

double ggx_albedo(double cosine, double alpha)
{
    return ggx_shares(cosine, alpha).x;
}

double schlick_share(double cosine, double alpha)
{
    const dvec2 shares = ggx_shares(cosine, alpha);
    return shares.y / shares.x;
}

double sheen_albedo(double cosine, double roughness)
{
    // cos θ_i = v², since the distribution is steep near the horizon.
    constexpr int kSteps = 32;
    static const std::array<double, 32> kAzimuths = azimuths<32>();
    const double alpha = roughness * roughness;
    const double sine = std::sqrt(std::max(0.0, 1 - cosine * cosine));
    const SheenShadowing shadowing(alpha);
    const double lambda_o = shadowing(cosine);
    double sum = 0;
    for (int i = 0; i < kSteps; ++i) {
        const double v = (i + 0.5) / kSteps;
        const double cosine_i = v * v, sine_i = std::sqrt(1 - cosine_i * cosine_i);
        const double hz = cosine + cosine_i;
        double row = 0;
        for (const double azimuth : kAzimuths) {
            const double flat2 = sine * sine + 2 * sine * sine_i * azimuth + sine_i * sine_i;
            row += std::pow(flat2 / (flat2 + hz * hz), 0.5 / alpha);
        }
        sum += 2 * v * row / (1 + lambda_o + shadowing(cosine_i));
    }
    const double mean = sum / (kSteps * double(kAzimuths.size()));
    return 2 * kPi * mean * (2 + 1 / alpha) / (2 * kPi) / (4 * cosine);
}

std::vector<vec4> make_albedo_cells(bool with_sheen, unsigned threads)
{
    using namespace shared;
    std::vector<vec4> out;
    out.reserve(with_sheen ? kAlbedoCells : kSheenAlbedoFirst);
    add_table(out, kGgxAlbedoX, kGgxAlbedoY, threads, [](double x, double y) {
        const double alpha = kGgxAlbedoAlpha + y * (1.0 - kGgxAlbedoAlpha);
        return ggx_albedo(std::max(cosine_at(x * x, alpha), 1e-9), alpha);
    });
    if (!with_sheen) return out;
    add_table(out, kSheenAlbedoX, kSheenAlbedoY, threads, [](double x, double y) {
        const double r = kSheenAlbedoRoughness + y * (1.0 - kSheenAlbedoRoughness);
        const double lowest = std::cbrt((1 + r) * kSheenAlbedoCosine / (kSheenAlbedoCosine + r));
        const double root = lowest + x * (1 - lowest);
        return r * sheen_albedo(cosine_at(root * root * root, r), r);
    });
    return out;
}

std::vector<vec4> make_raster_albedo_cells(bool with_sheen, unsigned threads)
{
    std::vector<vec4> out = make_albedo_cells(with_sheen, threads);
    out.resize(shared::kSchlickShareFirst, vec4(0));
    add_table(out, shared::kSchlickShareX, shared::kSchlickShareY, threads, [](double x, double y) {
        return schlick_share(std::max(x, 1e-9), std::max(y * y, double{shared::kGgxAlbedoAlpha}));
    });
    return out;
}

}  // namespace etalon
