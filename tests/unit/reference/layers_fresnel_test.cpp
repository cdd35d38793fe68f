#include "engine/reference/layers_fresnel.h"

#include <gtest/gtest.h>

#include <cmath>
#include <complex>

namespace etalon::reference {
namespace {

TEST(LayersFresnel, SH_50_head_on_the_base_reflects_what_its_index_and_factors_say)
{
    EXPECT_NEAR(dielectric_f0(1.5, 1, dvec3(1)).x, 0.04, 1e-16);
    EXPECT_EQ(dielectric_f0(1, 1, dvec3(1)), dvec3(0));
    EXPECT_EQ(dielectric_f0(0, 1, dvec3(1, 0.5, 0)), dvec3(1, 0.5, 0));  // an infinite index
    EXPECT_NEAR(dielectric_f0(1e12, 1, dvec3(1)).x, 1, 1e-11);
    EXPECT_EQ(dielectric_f0(3, 0.5, dvec3(100)), dvec3(0.5));  // the colour is cut at 1 before the factor
    EXPECT_NEAR(dielectric_f0(1.5, 0.5, dvec3(2)).x, 0.04, 1e-16);
}

TEST(LayersFresnel, SH_50_angles_and_metals_lie_between_F0_and_F90)
{
    BaseReflectance half{
        .color = dvec3(0.8, 0.4, 0.2), .metallic = 0.5, .f0 = dvec3(0.1, 0.2, 0.3), .f90 = 0.6, .film = {}};
    EXPECT_NEAR(half.at(1).f.x, 0.5 * (0.1 + 0.8), 1e-15);
    EXPECT_NEAR(half.at(1).hat.x, 0.5 * (0.3 + 0.8), 1e-15);  // F̂: the dielectric's strongest channel, the metal's own
    EXPECT_NEAR(half.at(0).f.y, 0.5 * (0.6 + 1), 1e-15);
    EXPECT_EQ(half.total().f, dvec3(0.8));
    EXPECT_EQ(half.total().hat, half.at(0).hat);
    const double x = std::pow(0.5, 5);
    EXPECT_NEAR(half.at(0.5).f.z, 0.5 * (0.3 + 0.3 * x) + 0.5 * (0.2 + 0.8 * x), 1e-15);
}

TEST(LayersFresnel, SH_51_a_film_of_no_thickness_or_strength_changes_nothing)
{
    const BaseReflectance bare{.color = dvec3(0.9, 0.6, 0.3), .metallic = 0.3, .f0 = dvec3(0.05), .film = {}};
    BaseReflectance thin = bare, weak = bare;
    thin.film = {.strength = 1, .ior = 1.8, .thickness = 0};
    weak.film = {.strength = 0, .ior = 1.8, .thickness = 300};
    for (const double c : {0.0, 0.01, 0.5, 1.0}) {
        EXPECT_EQ(thin.at(c).f, bare.at(c).f);
        EXPECT_EQ(weak.at(c).f, bare.at(c).f);
        EXPECT_EQ(weak.at(c).hat, bare.at(c).hat);
    }
    // Head on it is approached without a jump, but for the floor of R. (Aslant the extension's Schlick curve of the
    // film's own face stays, whatever its index.)
    thin.film.thickness = 1e-6;
    EXPECT_NEAR(thin.at(1).f.y, bare.at(1).f.y, 2 * std::sqrt(1e-5));
}

double schlick(double f0, double c)
{
    return f0 + (1 - f0) * std::pow(1 - c, 5);
}

// What a film reflects at one wave number ν = 1/λ, m⁻¹, by the complex sum over all orders, less its mean over the
// phase.
double ripple(double wave_number, double r12, double r23, double film_sign, double base_sign, double path)
{
    const double a12 = film_sign * std::sqrt(r12), a23 = base_sign * std::sqrt(r23);
    const std::complex<double> turn = std::polar(1.0, 2 * kPi * wave_number * path * 1e-9);
    const double all = std::norm((a12 + a23 * turn) / (1.0 + a12 * a23 * turn));
    const double t = 1 - r12;
    return all - (r12 + t * t * r23 / (1 - r12 * r23));
}

// The observer's curves as Gaussians over ν (Belcour & Barla 2017), integrated by midpoints.
dvec3 direct_film(double cosine, double f0, double film_ior, double thickness)
{
    const double c2 = std::sqrt(1 - (1 - cosine * cosine) / (film_ior * film_ior));
    const double r12 = schlick(std::pow((film_ior - 1) / (film_ior + 1), 2), cosine);
    const double base_ior = (1 + std::sqrt(f0)) / (1 - std::sqrt(f0));
    const double r23 = schlick(std::pow((base_ior - film_ior) / (base_ior + film_ior), 2), c2);
    const double t = 1 - r12, mean = r12 + t * t * r23 / (1 - r12 * r23);
    const auto curve = [&](double height, double center, double width, double wave_number) {
        const double d = wave_number - center;
        return height / std::sqrt(2.0) * std::exp(-d * d / (4 * width));
    };
    dvec3 xyz(0);
    constexpr int kSteps = 20000;
    constexpr double kLow = 0.5e6, kHigh = 4e6;
    for (int i = 0; i < kSteps; ++i) {
        const double nu = kLow + (kHigh - kLow) * (i + 0.5) / kSteps;
        const double r =
            ripple(nu, r12, r23, film_ior > 1 ? -1 : 1, base_ior > film_ior ? -1 : 1, 2 * film_ior * thickness * c2) *
            (kHigh - kLow) / kSteps / 1.0685e-7;
        xyz.x += r * (curve(5.4856e-13, 1.6810e6, 4.3278e9, nu) + curve(9.7470e-14, 2.2399e6, 4.5282e9, nu));
        xyz.y += r * curve(4.4201e-13, 1.7953e6, 9.3046e9, nu);
        xyz.z += r * curve(5.2481e-13, 2.2084e6, 6.6121e9, nu);
    }
    return dvec3(mean) + dvec3(3.2404542 * xyz.x - 1.5371385 * xyz.y - 0.4985314 * xyz.z,
                               -0.9692660 * xyz.x + 1.8760108 * xyz.y + 0.0415560 * xyz.z,
                               0.0556434 * xyz.x - 0.2040259 * xyz.y + 1.0572252 * xyz.z);
}

TEST(LayersFresnel, SH_51_a_film_reflects_what_the_sum_over_waves_of_all_orders_does)
{
    for (const double f0 : {0.04, 0.2, 0.5})
        for (const double ior : {1.2, 1.5, 2.0})
            for (const double thickness : {60.0, 250.0, 480.0, 900.0})
                for (const double cosine : {0.35, 0.7, 1.0}) {
                    const dvec3 direct = direct_film(cosine, f0, ior, thickness);
                    const dvec3 fitted = thin_film(cosine, dvec3(f0), ior, thickness);
                    // Two orders are kept: the third and all above are at most 2 r³/(1 − r), times the rows' sums.
                    // Where R is below its floor of 10⁻⁵ the first order is that of the floor.
                    const double c2 = std::sqrt(1 - (1 - cosine * cosine) / (ior * ior));
                    const double base = (1 + std::sqrt(f0)) / (1 - std::sqrt(f0));
                    const double both = schlick(std::pow((ior - 1) / (ior + 1), 2), cosine) *
                                        schlick(std::pow((base - ior) / (base + ior), 2), c2);
                    const double r = std::sqrt(both);
                    const double bound = 1e-4 + 6 * r * r * r / (1 - r) + (both < 1e-5 ? 0.02 : 0);
                    EXPECT_LT(bound, 0.15);
                    for (int c = 0; c < 3; ++c)
                        EXPECT_NEAR(fitted[c], std::min(1.0, std::max(0.0, direct[c])), bound)
                            << "F0 " << f0 << " ior " << ior << " " << thickness << " nm at " << cosine;
                }
}

TEST(LayersFresnel, SH_51_no_film_reflects_more_than_all_or_less_than_nothing)
{
    for (const double f0 : {0.0, 0.04, 0.9, 1.0})
        for (const double ior : {1.0, 1.3, 3.0, 1e6})
            for (double thickness = 1; thickness < 3000; thickness *= 1.7)
                for (const double cosine : {0.0, 1e-9, 0.1, 0.6, 1.0}) {
                    const dvec3 i = thin_film(cosine, dvec3(f0, 1 - f0, 0.5), ior, thickness);
                    for (int c = 0; c < 3; ++c) ASSERT_TRUE(i[c] >= 0 && i[c] <= 1) << i[c];
                }
    EXPECT_EQ(thin_film(0, dvec3(0.04), 1, 300), dvec3(1));  // along a film of air's index
}

}  // namespace
}  // namespace etalon::reference
