#include "engine/reference/raster_shade.h"

#include <gtest/gtest.h>

#include <cmath>

namespace etalon::reference {
namespace {

const dvec3 kUp(0, 0, 1);

dvec3 at_angle(double theta, double phi = 0)
{
    return {std::sin(theta) * std::cos(phi), std::sin(theta) * std::sin(phi), std::cos(theta)};
}

// ∫ f cosθ dω over the upper hemisphere, rings closest together near the pole.
template <class Function>
double hemisphere(Function&& f)
{
    constexpr int kRings = 4000;
    double sum = 0;
    for (int i = 0; i < kRings; ++i) {
        const double q = (i + 0.5) / kRings, theta = kPi / 2 * q * q * q;
        sum += f(theta) * std::sin(theta) * 2 * kPi * (kPi / 2) * 3 * q * q / kRings;
    }
    return sum;
}

TEST(RasterShade, S2_Blinn_Phong_keeps_its_energy_head_on_for_every_exponent)
{
    for (const double p : {0.0, 1.0, 10.0, 1e3, 1e6}) {
        // Seen head on h lies half way: |n - h| = 2 sin(θ/4).
        const double albedo =
            hemisphere([&](double theta) { return blinn_phong_lobe(p, 2 * std::sin(theta / 4)) * std::cos(theta); });
        EXPECT_NEAR(albedo, 1, 1e-5) << p;
    }
}

TEST(RasterShade, S1_Blinn_Phong_keeps_its_digits_at_the_largest_exponent)
{
    const double p = 1e6;
    for (const double angle : {1e-6, 1e-4, 1e-3, 3e-3}) {
        const long double c = std::cos(static_cast<long double>(angle));
        const double truth = static_cast<double>((static_cast<long double>(p) + 2) * (p + 4) / (8 * kPi * p) *
                                                 std::pow(c, static_cast<long double>(p)));
        EXPECT_NEAR(blinn_phong_lobe(p, 2 * std::sin(angle / 2)) / truth, 1, 1e-9) << angle;
    }
    EXPECT_GT(blinn_phong_lobe(0, 1.2), 0);                         // anything to the power 0 is 1
    EXPECT_EQ(blinn_phong_lobe(5, std::sqrt(2.0) * 1.0000001), 0);  // n·h = 0
}

TEST(RasterShade, S3_light_from_below_the_horizon_is_nothing)
{
    const RasterMaterial m{.diffuse = dvec3(0.5), .f0 = dvec3(0.04), .roughness = 0.5, .alpha = 0.25};
    const dvec3 wo = at_angle(1.0), below = at_angle(kPi / 2 + 0.1, kPi);
    EXPECT_GT(dot(kUp, normalize(wo + below)), 0);  // the half vector alone would let it through
    EXPECT_EQ(reflect_blinn_phong(m, kUp, wo, below), dvec3(0));
    EXPECT_EQ(reflect_pbr(m, kUp, wo, below, wo.z), dvec3(0));
}

TEST(RasterShade, SH_14_the_rasterizers_formula_is_the_path_tracers)
{
    for (const double alpha : {0.05, 0.5, 1.0})
        for (const double theta : {0.1, 0.8, 1.5}) {
            const Bsdf bsdf{.model = BsdfModel::metallic_roughness,
                            .color = {0.5, 0.2, 0.1},
                            .f0 = {0.04, 0.3, 0.9},
                            .alpha = alpha};
            const RasterMaterial m{.diffuse = bsdf.color, .f0 = bsdf.f0, .roughness = std::sqrt(alpha), .alpha = alpha};
            const dvec3 wo = at_angle(0.6, 0.2), wi = at_angle(theta, 2.5);
            const dvec3 expected = evaluate(bsdf, wo, wi), value = reflect_pbr(m, kUp, wo, wi, wo.z);
            for (int c = 0; c < 3; ++c) EXPECT_NEAR(value[c], expected[c], 1e-14 * (1 + expected[c]));
        }
}

TEST(RasterShade, SH_34_the_split_sum_is_the_albedo_it_stands_for)
{
    const RasterShares shares(true, false, 0);
    for (const double roughness : {0.4, 0.7, 1.0})
        for (const double theta : {0.2, 0.8, 1.3}) {
            // One channel metal, one plain dielectric: A and B apart.
            const Bsdf surface{.model = BsdfModel::metallic_roughness,
                               .color = dvec3(0),
                               .f0 = dvec3(1, 0.04, 0),
                               .alpha = roughness * roughness};
            const dvec3 wo = at_angle(theta);
            dvec3 albedo(0);
            constexpr int kSteps = 300;
            for (int i = 0; i < kSteps; ++i)
                for (int j = 0; j < kSteps; ++j) {
                    const double z = (i + 0.5) / kSteps, phi = 2 * kPi * (j + 0.5) / kSteps, r = std::sqrt(1 - z * z);
                    albedo +=
                        evaluate(surface, wo, {r * std::cos(phi), r * std::sin(phi), z}) * (2 * kPi / kSteps / kSteps);
                }
            const dvec2 ab = shares.specular(wo.z, roughness);
            for (int c = 0; c < 3; ++c)
                EXPECT_NEAR(surface.f0[c] * ab.x + ab.y, albedo[c], 1.5e-3) << roughness << " at " << theta;
        }
}

TEST(RasterShade, SH_37_other_models_become_what_the_page_says)
{
    MaterialPoint point;
    point.color = {0.2, 0.4, 0.6};
    Material m;
    m.model = BsdfModel::lambert;
    EXPECT_EQ(raster_material(m, point).diffuse, point.color);
    EXPECT_FALSE(raster_material(m, point).has_specular);
    m.model = BsdfModel::mirror;
    EXPECT_EQ(raster_material(m, point).f0, point.color);
    EXPECT_EQ(raster_material(m, point).roughness, 0);
    m.model = BsdfModel::rough_conductor;
    m.eta = dvec3(0.2);
    m.k = dvec3(3.9);
    m.ggx_alpha = 0.25;
    EXPECT_NEAR(raster_material(m, point).f0.x, fresnel_conductor(1, 0.2, 3.9), 0);
    EXPECT_EQ(raster_material(m, point).roughness, 0.5);
    m.model = BsdfModel::dielectric;
    m.eta = dvec3(1.5);
    EXPECT_NEAR(raster_material(m, point).f0.x, 0.04, 1e-15);
    EXPECT_EQ(raster_material(m, point).diffuse, dvec3(0));
    EXPECT_EQ(blinn_phong_exponent(1), 0);
    EXPECT_EQ(blinn_phong_exponent(1e-3), 1e6);
}

}  // namespace
}  // namespace etalon::reference
