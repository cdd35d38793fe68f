#include "engine/reference/bsdf.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <string>
#include <vector>

#include "tests/unit/reference/random.h"
#include "tests/unit/reference/sphere_integral.h"

namespace etalon::reference {
namespace {

using test::integrate;
using test::Random;

dvec3 at_angle(double theta, double phi = 0)
{
    return {std::sin(theta) * std::cos(phi), std::sin(theta) * std::sin(phi), std::cos(theta)};
}

struct Named {
    std::string name;
    Bsdf bsdf;
};

Bsdf conductor(double alpha, double eta, double k)
{
    return {.model = BsdfModel::rough_conductor, .alpha = alpha, .eta = dvec3(eta), .k = dvec3(k)};
}

Bsdf metallic_roughness(dvec3 color, double metallic, double alpha)
{
    return {.model = BsdfModel::metallic_roughness,
            .color = color * (1 - metallic),
            .f0 = dvec3(0.04) + metallic * (color - dvec3(0.04)),
            .alpha = alpha};
}

/// Every model that is no delta, smooth to rough.
std::vector<Named> rough_models()
{
    std::vector<Named> all{{"lambert", {.model = BsdfModel::lambert, .color = dvec3(0.8, 0.5, 0.2)}}};
    for (const double alpha : {0.1, 0.4, 1.0}) {
        const std::string a = " alpha " + std::to_string(alpha);
        all.push_back({"gold" + a, conductor(alpha, 0.2, 3.9)});
        all.push_back({"plastic" + a, metallic_roughness({0.8, 0.3, 0.1}, 0, alpha)});
        all.push_back({"half metal" + a, metallic_roughness({0.8, 0.3, 0.1}, 0.5, alpha)});
        all.push_back({"glass from outside" + a, {.model = BsdfModel::rough_dielectric, .alpha = alpha, .ior = 1.5}});
        all.push_back(
            {"glass from inside" + a, {.model = BsdfModel::rough_dielectric, .alpha = alpha, .ior = 1 / 1.5}});
    }
    return all;
}

TEST(Bsdf, reflection_is_reciprocal_to_the_last_digits)
{
    Random random(31);
    for (const auto& [name, bsdf] : rough_models())
        for (int i = 0; i < 500; ++i) {
            const dvec3 a = random.upper_direction(), b = random.upper_direction();
            const dvec3 forth = evaluate(bsdf, a, b) / b.z, back = evaluate(bsdf, b, a) / a.z;
            for (int c = 0; c < 3; ++c) ASSERT_NEAR(forth[c], back[c], 1e-12 * (1 + std::abs(forth[c]))) << name;
        }
}

TEST(Bsdf, transmission_is_reciprocal_but_for_the_radiance_scaling)
{
    Random random(32);
    for (const double alpha : {0.1, 0.4}) {
        const Bsdf in{.model = BsdfModel::rough_dielectric, .alpha = alpha, .ior = 1.5};
        const Bsdf out{.model = BsdfModel::rough_dielectric, .alpha = alpha, .ior = 1 / 1.5};
        int lit = 0;
        for (int i = 0; i < 2000; ++i) {
            const dvec3 o = random.upper_direction(), t = -random.upper_direction();
            const double forth = evaluate(in, o, t).x / std::abs(t.z);
            // Seen from below the surface is upside down.
            const double back = evaluate(out, -t, -o).x / o.z;
            ASSERT_NEAR(forth * 1.5 * 1.5, back / (1.5 * 1.5) * 1.5 * 1.5, 1e-10 * (1 + back));
            lit += forth > 0;
        }
        EXPECT_GT(lit, 300);
    }
}

TEST(Bsdf, densities_integrate_to_one_less_the_draws_that_are_dropped)
{
    for (const Named& model : rough_models())
        for (const double theta : {0.0, 0.8, 1.4}) {
            const Bsdf& bsdf = model.bsdf;
            const dvec3 wo = at_angle(theta, 0.3);
            const double total = integrate(wo, [&](const dvec3& wi) { return pdf(bsdf, wo, wi); });
            Random random(33);
            int kept = 0;
            constexpr int kDraws = 4000;
            for (int i = 0; i < kDraws; ++i)
                kept += sample(bsdf, wo, {random.uniform(), random.uniform(), random.uniform()}).has_value();
            const double share = static_cast<double>(kept) / kDraws;
            // Five standard errors of the share, and the quadrature's own error.
            EXPECT_NEAR(total, share, 5 * std::sqrt(share * (1 - share) / kDraws) + 4e-3)
                << model.name << " at " << theta;
        }
}

TEST(Bsdf, S16_weight_times_density_is_the_value)
{
    Random random(34);
    for (const auto& [name, bsdf] : rough_models())
        for (int i = 0; i < 300; ++i) {
            const dvec3 wo = random.upper_direction();
            const auto drawn = sample(bsdf, wo, {random.uniform(), random.uniform(), random.uniform()});
            if (!drawn) continue;
            const dvec3 value = evaluate(bsdf, wo, drawn->wi);
            EXPECT_NEAR(drawn->pdf, pdf(bsdf, wo, drawn->wi), 1e-9 * drawn->pdf) << name;
            for (int c = 0; c < 3; ++c)
                ASSERT_NEAR(drawn->weight[c] * drawn->pdf, value[c], 1e-9 * (1e-3 + value[c])) << name;
        }
}

TEST(Bsdf, R22_white_furnace_lambert_gives_all_of_it_back)
{
    const Bsdf white{.model = BsdfModel::lambert, .color = dvec3(1)};
    EXPECT_NEAR(integrate(at_angle(0.7), [&](const dvec3& wi) { return evaluate(white, at_angle(0.7), wi).x; }), 1,
                1e-4);
    Random random(35);
    for (int i = 0; i < 100; ++i)
        EXPECT_EQ(sample(white, at_angle(0.7), {random.uniform(), random.uniform(), 0})->weight, dvec3(1));
}

// What single scattering loses head on, F = 1, separable Smith: wo = n, so 1 - ∫ D G₁(2θ_h) cosθ_h dω_h (MC-6 with
// G₁(wo) = 1), an integral over one angle.
double lost_head_on(double alpha)
{
    double kept = 0;
    constexpr int kSteps = 20000;
    for (int i = 0; i < kSteps; ++i) {
        const double theta = kPi / 4 * (i + 0.5) / kSteps;  // beyond 45° the light goes below the horizon
        const double c = std::cos(theta), s = std::sin(theta), a2 = alpha * alpha;
        const double d = a2 / (kPi * std::pow(c * c * (a2 - 1) + 1, 2)), tangent = std::tan(2 * theta);
        kept += d * 2 / (1 + std::sqrt(1 + a2 * tangent * tangent)) * c * 2 * kPi * s * kPi / 4 / kSteps;
    }
    return 1 - kept;
}

TEST(Bsdf, S17_white_furnace_ggx_with_full_reflection_loses_what_single_scattering_loses)
{
    for (const double alpha : {0.1, 0.5, 1.0}) {
        const Bsdf bsdf = conductor(alpha, 0, 1);
        const double by_quadrature = integrate({0, 0, 1}, [&](const dvec3& wi) {
            return evaluate(bsdf, {0, 0, 1}, wi).x;
        });
        Random random(36);
        double by_samples = 0;
        constexpr int kDraws = 20000;
        for (int i = 0; i < kDraws; ++i)
            if (const auto drawn = sample(bsdf, {0, 0, 1}, {random.uniform(), random.uniform(), 0}))
                by_samples += drawn->weight.x / kDraws;
        EXPECT_NEAR(by_quadrature, by_samples, 0.01) << alpha;
        EXPECT_LT(by_quadrature, 1);
        EXPECT_NEAR(by_quadrature, 1 - lost_head_on(alpha), 2e-3) << alpha;
    }
}

TEST(Bsdf, R22_no_model_gives_back_more_than_it_gets)
{
    for (const Named& model : rough_models())
        for (const double theta : {0.0, 0.9, 1.5}) {
            const Bsdf& bsdf = model.bsdf;
            const bool transmits = bsdf.model == BsdfModel::rough_dielectric;
            // A dielectric's radiance is scaled by (η_i/η_t)²; undo it to count energy.
            const dvec3 wo = at_angle(theta);
            const double albedo = integrate(wo, [&](const dvec3& wi) {
                const double f = evaluate(bsdf, wo, wi).x;
                return transmits && wi.z < 0 ? f * bsdf.ior * bsdf.ior : f;
            });
            // glTF's (1 - F) c_diff/π + F D V takes F at the half vector of each pair of directions: near grazing it
            // gives back up to a tenth more than it gets. The equation is what (SH-14) asks for, so it is stated here,
            // not mended.
            const double bound = bsdf.model == BsdfModel::metallic_roughness && theta > 1 ? 1.12 : 1.0;
            EXPECT_LE(albedo, bound + 2e-3) << model.name << " at " << theta;
            EXPECT_GT(albedo, 0.02) << model.name << " at " << theta;
        }
}

TEST(Bsdf, S6_ggx_distribution_is_normalized_over_projected_area)
{
    for (const double alpha : {0.05, 0.3, 1.0}) {
        // ∫ D cosθ dω with t = tan²θ / α²: uniform in t / (1 + t), independent of how narrow the lobe is.
        double sum = 0;
        constexpr int kSteps = 2000;
        for (int i = 0; i < kSteps; ++i) {
            const double q = (i + 0.5) / kSteps, t = q / (1 - q) * alpha * alpha;
            const double c = 1 / std::sqrt(1 + t), s = std::sqrt(t) * c;
            // dω cosθ = π d(tan²θ) cos⁴θ, dt = α² dq / (1 - q)²
            sum += ggx_d({s, 0, c}, alpha) * kPi * c * c * c * c * alpha * alpha / ((1 - q) * (1 - q)) / kSteps;
        }
        EXPECT_NEAR(sum, 1, 1e-12) << alpha;
    }
}

TEST(Bsdf, S8_masking_lies_between_0_and_1_and_falls_to_0_at_grazing)
{
    for (const double alpha : {1e-4, 0.1, 1.0}) {
        EXPECT_NEAR(ggx_g1(1, alpha), 1, 1e-15);
        EXPECT_LT(ggx_g1(1e-12, alpha), 1e-7);
        double before = 1.1;
        for (double c = 1; c > 1e-6; c *= 0.9) {
            const double g = ggx_g1(c, alpha);
            EXPECT_TRUE(g >= 0 && g <= 1 && g <= before);
            before = g;
            EXPECT_NEAR(ggx_v(c, 0.3, alpha), ggx_v(0.3, c, alpha), 1e-15 / c);
            EXPECT_LE(4 * c * 0.3 * ggx_v(c, 0.3, alpha), 1 + 1e-12);
        }
    }
}

TEST(Bsdf, Fresnel_of_a_dielectric_meets_its_known_values)
{
    EXPECT_NEAR(fresnel_dielectric(1, 1.5), 0.04, 1e-15);
    EXPECT_NEAR(fresnel_dielectric(1, 1 / 1.5), 0.04, 1e-15);
    EXPECT_EQ(fresnel_dielectric(0.3, 1), 0);
    EXPECT_NEAR(fresnel_dielectric(0, 1.5), 1, 1e-15);
    // At Brewster's angle the parallel part vanishes: R = ½ cos²(2θ_B) (reflected and refracted rays are at right
    // angles).
    const double brewster = std::atan(1.5);
    EXPECT_NEAR(fresnel_dielectric(std::cos(brewster), 1.5), 0.5 * std::pow(std::cos(2 * brewster), 2), 1e-15);
    EXPECT_EQ(fresnel_dielectric(std::cos(std::asin(1 / 1.5) + 1e-6), 1 / 1.5), 1);
}

TEST(Bsdf, S10_Fresnel_keeps_its_digits_where_the_index_is_nearly_one)
{
    for (const double delta : {1e-4, 1e-8, 1e-12}) {
        const double expected = delta * delta / ((2 + delta) * (2 + delta));  // at normal incidence
        EXPECT_NEAR(fresnel_dielectric(1, 1 + delta) / expected, 1, 1e-3 * 1e-12 / delta + 1e-12);
    }
}

TEST(Bsdf, S10_S11_both_sides_of_an_interface_reflect_alike_and_Snell_holds)
{
    Random random(37);
    for (int i = 0; i < 2000; ++i) {
        const double ior = random.uniform(1.01, 3);
        const dvec3 wo = random.upper_direction();
        const auto wi = refract(wo, {0, 0, 1}, ior);
        ASSERT_TRUE(wi);
        EXPECT_NEAR(length(*wi), 1, 1e-15);
        EXPECT_NEAR(std::hypot(wo.x, wo.y), ior * std::hypot(wi->x, wi->y), 1e-14);
        EXPECT_NEAR(fresnel_dielectric(wo.z, ior), fresnel_dielectric(-wi->z, 1 / ior), 1e-14 / wo.z);
    }
}

TEST(Bsdf, S11_total_reflection_and_refraction_never_disagree)
{
    const double ior = 1 / 1.5, critical = std::asin(ior);
    for (int i = -2000; i <= 2000; ++i) {
        const dvec3 wo = at_angle(critical + i * 1e-17 * (std::abs(i) > 1000 ? 1e6 : 1.0));
        EXPECT_EQ(refract(wo, {0, 0, 1}, ior).has_value(),
                  fresnel_dielectric(wo.z, ior) < 1 || (ior - 1) * (ior + 1) + wo.z * wo.z == 0);
    }
}

TEST(Bsdf, S13_Fresnel_of_a_conductor_meets_dielectric_and_perfect_mirror)
{
    for (const double c : {0.0, 0.1, 0.5, 0.9, 1.0}) {
        EXPECT_NEAR(fresnel_conductor(c, 1.5, 0), fresnel_dielectric(c, 1.5), 1e-14);
        EXPECT_NEAR(fresnel_conductor(c, 0, 1), 1, 1e-15);
        EXPECT_LE(fresnel_conductor(c, 1, 1e6), 1);
    }
    EXPECT_NEAR(fresnel_conductor(1, 0.2, 3.9), 1 - 4 * 0.2 / (1.2 * 1.2 + 3.9 * 3.9), 1e-15);
}

TEST(Bsdf, S14_Schlick_stays_between_F0_and_1_even_beyond_its_domain)
{
    EXPECT_EQ(fresnel_schlick(dvec3(0.04), 1 + 1e-15), dvec3(0.04));
    EXPECT_EQ(fresnel_schlick(dvec3(0.04), -0.1), dvec3(1));
    EXPECT_NEAR(fresnel_schlick(dvec3(0.04), 0.5).x, 0.04 + 0.96 / 32, 1e-16);
}

TEST(Bsdf, delta_models_send_light_one_way_and_evaluate_to_nothing)
{
    const dvec3 wo = at_angle(0.5, 1);
    const Bsdf mirror{.model = BsdfModel::mirror, .color = dvec3(0.9)};
    const auto reflected = sample(mirror, wo, dvec3(0.5));
    ASSERT_TRUE(reflected && reflected->delta);
    EXPECT_EQ(reflected->wi, dvec3(-wo.x, -wo.y, wo.z));
    EXPECT_EQ(reflected->weight, dvec3(0.9));
    EXPECT_EQ(evaluate(mirror, wo, reflected->wi), dvec3(0));
    const Bsdf glass{.model = BsdfModel::dielectric, .ior = 1.5};
    const auto through = sample(glass, wo, {0, 0, 0.999});
    ASSERT_TRUE(through && through->delta);
    EXPECT_LT(through->wi.z, 0);
    EXPECT_NEAR(through->weight.x, 1 / 2.25, 1e-15);  // (SH-18): radiance is diluted in the denser medium
    const Bsdf vacuum{.model = BsdfModel::rough_dielectric, .alpha = 0.3, .ior = 1};
    EXPECT_EQ(sample(vacuum, wo, dvec3(0.5))->wi, -wo);  // S29: invisible, exactly
    EXPECT_EQ(sample(vacuum, wo, dvec3(0.5))->weight, dvec3(1));
}

TEST(Bsdf, S15_no_draw_at_any_angle_and_roughness_is_bad)
{
    Random random(38);
    for (const double alpha : {1e-4, 1e-3, 0.1, 1.0})
        for (const double cosine : {1e-12, 1e-7, 1e-3, 0.5, 1.0})
            for (int i = 0; i < 300; ++i) {
                const dvec3 wo = normalize(dvec3(std::sqrt(1 - cosine * cosine), 0, cosine));
                const dvec3 h = sample_visible_normal(wo, alpha, random.square());
                ASSERT_TRUE(is_finite(h) && h.z > 0 && dot(wo, h) > -1e-12);
                for (const Bsdf& bsdf : {conductor(alpha, 0.2, 3.9),
                                         Bsdf{.model = BsdfModel::rough_dielectric, .alpha = alpha, .ior = 1.5},
                                         metallic_roughness(dvec3(0.5), 0, alpha)})
                    if (const auto drawn = sample(bsdf, wo, {random.uniform(), random.uniform(), random.uniform()})) {
                        ASSERT_TRUE(is_finite(drawn->weight) && is_finite(drawn->wi)) << alpha << " " << cosine;
                        // F ≤ 1 and masking ≤ 1; the mixed model's weight is bounded by its smallest lobe share.
                        ASSERT_LE(drawn->weight.x, bsdf.model == BsdfModel::metallic_roughness ? 12 : 1 + 1e-9);
                    }
            }
}

}  // namespace
}  // namespace etalon::reference
