#include "engine/reference/layers.h"

#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <vector>

#include "engine/reference/layers_lobes.h"
#include "tests/unit/reference/layered_models.h"
#include "tests/unit/reference/random.h"
#include "tests/unit/reference/sphere_integral.h"

namespace etalon::reference {
namespace {

using test::glossy;
using test::integrate;
using test::layered_models;
using test::LayeredModel;
using test::Random;
using test::tables;

dvec3 at_angle(double theta, double phi = 0)
{
    return {std::sin(theta) * std::cos(phi), std::sin(theta) * std::sin(phi), std::cos(theta)};
}

dvec3 three(Random& random)
{
    return {random.uniform(), random.uniform(), random.uniform()};
}

// What comes back and through of a furnace of radiance 1 in the channel that has most of it, counted as energy: each
// medium's (η_i/η_t)² is undone.
double albedo(const LayeredBsdf& bsdf, const dvec3& wo)
{
    const bool grey = !bsdf.body || bsdf.body->ior.x == bsdf.body->ior.z;
    double most = 0;
    for (int c = 0; c < 3; ++c) {
        if (grey && c != 0) continue;  // every model's red is its strongest
        const double outer = bsdf.body ? bsdf.body->ior[c] : 1,
                     ior = bsdf.body && bsdf.body->inside ? 1 / outer : outer;
        most = std::max(most, integrate(wo, [&](const dvec3& wi) {
                            return evaluate(bsdf, wo, wi)[c] * (wi.z < 0 ? ior * ior : 1);
                        }));
    }
    return most;
}

TEST(Layers, SH_14_without_layers_they_are_the_plain_model)
{
    Random random(91);
    for (int i = 0; i < 500; ++i) {
        const dvec3 color(random.uniform(), random.uniform(), random.uniform());
        const double metallic = random.uniform(), alpha = random.uniform(1e-3, 1);
        const Bsdf plain{.model = BsdfModel::metallic_roughness,
                         .color = color * (1 - metallic),
                         .f0 = dvec3(0.04) + metallic * (color - dvec3(0.04)),
                         .alpha = alpha,
                         .energy = &tables().ggx};
        LayeredBsdf layered = glossy(color, metallic, alpha);
        const dvec3 wo = random.upper_direction(), wi = random.upper_direction();
        const dvec3 a = evaluate(plain, wo, wi), b = evaluate(layered, wo, wi);
        for (int c = 0; c < 3; ++c) ASSERT_NEAR(a[c], b[c], 1e-12 * (1 + a[c]));
    }
}

TEST(Layers, a_layer_of_no_strength_changes_no_bit)
{
    Random random(92);
    const LayeredBsdf bare = glossy(dvec3(0.7, 0.5, 0.2), 0.2, 0.1);
    LayeredBsdf none = bare;
    none.coat_alpha = 0.5;
    none.coat_normal = normalize(dvec3(0.3, 0.1, 1));
    none.sheen_alpha = 0.02;
    none.sheen_share = &tables().sheen;
    none.diffuse_transmission_color = dvec3(0.2);
    none.reflectance.film = {.strength = 0, .ior = 2, .thickness = 300};
    for (int i = 0; i < 300; ++i) {
        const dvec3 wo = random.upper_direction(), wi = random.direction(), u = three(random);
        EXPECT_EQ(evaluate(bare, wo, wi), evaluate(none, wo, wi));
        EXPECT_EQ(pdf(bare, wo, wi), pdf(none, wo, wi));
        const auto a = sample(bare, wo, u), b = sample(none, wo, u);
        ASSERT_EQ(a.has_value(), b.has_value());
        if (a) {
            EXPECT_EQ(a->wi, b->wi);
        }
    }
}

TEST(Layers, densities_integrate_to_one_less_the_draws_that_are_dropped)
{
    for (const LayeredModel& model : layered_models())
        for (const double theta : {0.2, 1.3}) {
            const dvec3 wo = at_angle(theta, 0.3);
            const double total = integrate(wo, [&](const dvec3& wi) { return pdf(model.bsdf, wo, wi); });
            Random random(93);
            int kept = 0;
            constexpr int kDraws = 4000;
            for (int i = 0; i < kDraws; ++i) {
                const auto drawn = sample(model.bsdf, wo, three(random));
                kept += drawn && !drawn->delta;
            }
            const double share = static_cast<double>(kept) / kDraws;
            EXPECT_NEAR(total, share, 5 * std::sqrt(share * (1 - share) / kDraws) + 6e-3)
                << model.name << " at " << theta;
        }
}

TEST(Layers, S16_weight_times_density_is_the_value)
{
    Random random(94);
    for (const LayeredModel& model : layered_models())
        for (int i = 0; i < 300; ++i) {
            const dvec3 wo = random.upper_direction();
            const auto drawn = sample(model.bsdf, wo, three(random));
            if (!drawn || drawn->delta) continue;
            const dvec3 value = evaluate(model.bsdf, wo, drawn->wi);
            EXPECT_NEAR(drawn->pdf, pdf(model.bsdf, wo, drawn->wi), 1e-9 * drawn->pdf) << model.name;
            for (int c = 0; c < 3; ++c)
                ASSERT_NEAR(drawn->weight[c] * drawn->pdf, value[c], 1e-9 * (1e-3 + value[c])) << model.name;
        }
}

TEST(Layers, S17_SH_53_a_white_metal_gives_back_all_that_it_gets_at_any_roughness)
{
    for (const double alpha : {0.1, 0.3, 0.7, 1.0})
        for (const double theta : {0.0, 0.7, 1.3})
            EXPECT_NEAR(albedo(glossy(dvec3(1), 1, alpha), at_angle(theta)), 1, 3e-3) << alpha << " " << theta;
    // And by draws, which no quadrature resolves that well: a lobe 0.001 wide.
    Random random(95);
    const LayeredBsdf mirror = glossy(dvec3(1), 1, 1e-3);
    double sum = 0;
    constexpr int kDraws = 4000;
    for (int i = 0; i < kDraws; ++i)
        if (const auto drawn = sample(mirror, at_angle(1), three(random))) sum += drawn->weight.x / kDraws;
    EXPECT_NEAR(sum, 1, 1e-3);
}

TEST(Layers, R22_no_layer_gives_back_more_than_it_gets)
{
    for (const LayeredModel& model : layered_models())
        for (const double theta : {0.0, 1.4}) {
            const double all = albedo(model.bsdf, at_angle(theta, 0.4));
            EXPECT_LE(all, model.bound + 3e-3) << model.name << " at " << theta;
            EXPECT_GT(all, 0.02) << model.name << " at " << theta;
        }
}

TEST(Layers, R21_what_the_model_has_of_reciprocity)
{
    Random random(96);
    for (LayeredModel model : layered_models()) {
        LayeredBsdf& bsdf = model.bsdf;
        bsdf.ggx_share = nullptr;  // M of (SH-53) and K of (SH-62) are wo's alone
        if (bsdf.coat_weight > 0 || bsdf.body) continue;
        for (int i = 0; i < 200; ++i) {
            const dvec3 a = random.upper_direction(), b = random.upper_direction();
            const dvec3 forth = evaluate(bsdf, a, b) / b.z, back = evaluate(bsdf, b, a) / a.z;
            for (int c = 0; c < 3; ++c) ASSERT_NEAR(forth[c], back[c], 1e-10 * (1 + std::abs(forth[c]))) << model.name;
        }
    }
}

TEST(Layers, SH_58_transmission_is_reciprocal_but_for_the_radiance_scaling)
{
    Random random(97);
    LayeredBsdf in = glossy(dvec3(0.9, 0.8, 0.7), 0, 0.2);
    in.transmission = 1;
    in.body = {.ior = dvec3(1.5), .inside = false};
    LayeredBsdf out = in;
    out.body->inside = true;
    int lit = 0;
    for (int i = 0; i < 2000; ++i) {
        const dvec3 o = random.upper_direction(), t = -random.upper_direction();
        const dvec3 forth = evaluate(in, o, t) / -t.z * 2.25, back = evaluate(out, -t, -o) / o.z / 2.25;
        for (int c = 0; c < 3; ++c) ASSERT_NEAR(forth[c], back[c] * 2.25, 1e-9 * (1 + forth[c]));
        lit += forth.x > 0;
    }
    EXPECT_GT(lit, 300);
}

TEST(Layers, SH_58_a_smooth_clear_body_loses_nothing_from_either_side)
{
    for (const bool inside : {false, true})
        for (const double ior : {1.0, 1.0 + 1e-9, 1.001, 1.5, 2.4})
            for (const double theta : {0.0, 0.6, 1.2}) {
                LayeredBsdf glass = glossy(dvec3(1), 0, 1e-3);
                glass.transmission = 1;
                glass.reflectance.f0 = dielectric_f0(ior, 1, dvec3(1));
                glass.body = {.ior = dvec3(ior), .inside = inside};
                Random random(98);
                const dvec3 wo = at_angle(theta);
                double sum = 0, sine = 0, crossed = 0;
                constexpr int kDraws = 2000;
                for (int i = 0; i < kDraws; ++i)
                    if (const auto drawn = sample(glass, wo, three(random))) {
                        const double n = drawn->wi.z < 0 ? glass.relative_ior() : 1;
                        sum += drawn->weight.y * n * n / kDraws;
                        if (drawn->wi.z < 0) {
                            crossed += 1;
                            sine += std::hypot(drawn->wi.x, drawn->wi.y) * n;
                        }
                    }
                if (crossed > 0) {
                    EXPECT_NEAR(sine / crossed, std::sin(theta), 5e-3);  // Snell
                }
                EXPECT_NEAR(sum, 1, 4e-3) << ior << (inside ? " inside at " : " outside at ") << theta;
            }
}

TEST(Layers, SH_58_total_reflection_begins_where_Snell_says)
{
    LayeredBsdf glass = glossy(dvec3(1), 0, 1e-3);
    glass.transmission = 1;
    glass.body = {.ior = dvec3(1.5), .inside = true};
    const double critical = std::asin(1 / 1.5);
    const auto through = [&](double theta) {
        Random random(99);
        int count = 0;
        for (int i = 0; i < 500; ++i) {
            const auto drawn = sample(glass, at_angle(theta), three(random));
            count += drawn && drawn->wi.z < 0 && drawn->weight.x > 0;
        }
        return count;
    };
    EXPECT_EQ(through(critical + 0.05), 0);
    EXPECT_GT(through(critical - 0.05), 200);
}

TEST(Layers, S29_a_body_of_index_one_lets_light_straight_through)
{
    LayeredBsdf air = glossy(dvec3(0.5), 0, 0.3);
    air.transmission = 1;
    air.reflectance.f0 = dvec3(0);
    air.body = {.ior = dvec3(1), .inside = false};
    Random random(100);
    const dvec3 wo = at_angle(0.4);
    double straight = 0;
    constexpr int kDraws = 4000;
    for (int i = 0; i < kDraws; ++i) {
        const auto drawn = sample(air, wo, three(random));
        if (!drawn || drawn->wi.z > 0) continue;
        ASSERT_TRUE(drawn->delta);
        ASSERT_EQ(drawn->wi, -wo);
        straight += drawn->weight.x / kDraws;
    }
    const double expected = 0.5 * (1 - std::pow(1 - wo.z, 5));
    EXPECT_NEAR(straight, expected, 5 * expected * std::sqrt(0.1 / kDraws) + 1e-6);
    EXPECT_EQ(evaluate(air, wo, -wo), dvec3(0));
    // ior 0 is a mirror.
    air.body->ior = dvec3(0);
    for (int i = 0; i < 200; ++i)
        if (const auto drawn = sample(air, wo, three(random))) {
            EXPECT_GT(drawn->wi.z, 0);
        }
}

TEST(Layers, SH_60_a_dispersing_body_bends_blue_most_and_keeps_its_energy_in_each_channel)
{
    LayeredBsdf glass = glossy(dvec3(1), 0, 1e-3);
    glass.transmission = 1;
    glass.body = {.ior = {1.45, 1.5, 1.55}, .inside = false};
    const dvec3 wo = at_angle(1.0);
    Random random(101);
    dvec3 sum(0), sine(0);
    constexpr int kDraws = 30000;
    for (int i = 0; i < kDraws; ++i)
        if (const auto drawn = sample(glass, wo, three(random))) {
            const bool crosses = drawn->wi.z < 0;
            const dvec3 energy = drawn->weight * (crosses ? glass.body->ior * glass.body->ior : dvec3(1));
            sum += energy / static_cast<double>(kDraws);
            if (crosses) sine += energy * std::hypot(drawn->wi.x, drawn->wi.y) / static_cast<double>(kDraws);
        }
    const double reflected = 0.04 + 0.96 * std::pow(1 - wo.z, 5);
    for (int c = 0; c < 3; ++c) {
        EXPECT_NEAR(sum[c], 1, 0.02) << c;  // about three standard errors: a third of the draws carry a channel
        EXPECT_NEAR(sine[c] / (1 - reflected), std::sin(1.0) / glass.body->ior[c], 0.02) << c;
    }
    EXPECT_GT(sine.x, sine.z);
}

TEST(Layers, SH_57_a_smooth_thin_wall_neither_bends_nor_loses)
{
    LayeredBsdf wall = glossy(dvec3(1, 0.5, 0.25), 0, 1e-3);
    wall.transmission = 1;
    Random random(102);
    const dvec3 wo = at_angle(0.9, 0.5);
    dvec3 through(0);
    constexpr int kDraws = 4000;
    for (int i = 0; i < kDraws; ++i)
        if (const auto drawn = sample(wall, wo, three(random)); drawn && drawn->wi.z < 0) {
            through += drawn->weight / static_cast<double>(kDraws);
            EXPECT_LT(length(drawn->wi + wo), 0.2);
        }
    const double kept = 1 - (0.04 + 0.96 * std::pow(1 - wo.z, 5));
    for (int c = 0; c < 3; ++c) EXPECT_NEAR(through[c] / wall.reflectance.color[c], kept, 0.02);
}

TEST(Layers, SH_56_diffuse_transmission_shines_out_of_the_other_side)
{
    LayeredBsdf paper = glossy(dvec3(0.8), 0, 1);
    paper.diffuse_transmission = 0.25;
    paper.diffuse_transmission_color = dvec3(0.6, 0.4, 0.2);
    const dvec3 wo(0, 0, 1);
    const auto half = [&](double side) {
        return integrate(wo, [&](const dvec3& wi) { return wi.z * side > 0 ? evaluate(paper, wo, wi).x : 0; });
    };
    // 1 − F̂ over a hemisphere seen head on: 1 − F0 − (1 − F0) ∫ (1 − cos θ/2)^5 2 cosθ sinθ dθ.
    double grazing = 0;
    for (int i = 0; i < 10000; ++i) {
        const double theta = kPi / 2 * (i + 0.5) / 10000;
        grazing += std::pow(1 - std::cos(theta / 2), 5) * 2 * std::cos(theta) * std::sin(theta) * kPi / 2 / 10000;
    }
    EXPECT_NEAR(half(-1), 0.96 * (1 - grazing) * 0.25 * 0.6, 1e-4);
    LayeredBsdf opaque = paper;
    opaque.diffuse_transmission = 0;
    const double specular = integrate(wo, [&](const dvec3& wi) {
        LayeredBsdf black = opaque;
        black.reflectance.color = dvec3(0);
        return wi.z > 0 ? evaluate(black, wo, wi).x : 0;
    });
    EXPECT_NEAR(half(1) - specular, 0.96 * (1 - grazing) * 0.75 * 0.8, 1e-4);
}

TEST(Layers, SH_61_sheen_takes_from_the_base_what_it_gives_back)
{
    // Over a white base the whole stays near the base's own albedo, for sheens smooth to rough.
    for (const double alpha : {0.07 * 0.07, 0.09, 0.5, 1.0}) {
        LayeredBsdf cloth = glossy(dvec3(1), 1, 0.5);
        cloth.sheen_color = dvec3(1);
        cloth.sheen_alpha = alpha;
        cloth.sheen_share = &tables().sheen;
        for (const double theta : {0.2, 0.9, 1.4, 1.5}) {
            const double all = albedo(cloth, at_angle(theta));
            EXPECT_LE(all, 1.003) << alpha << " " << theta;
            EXPECT_GE(all, alpha < 0.01 ? 0.3 : 0.6) << alpha << " " << theta;
        }
    }
}

TEST(Layers, SH_62_a_coat_takes_its_Fresnel_share_and_reflects_by_its_own_normal)
{
    EXPECT_NEAR(coat_weight(1, 1), 0.04, 1e-16);
    EXPECT_NEAR(coat_weight(0.5, 0), 0.5, 1e-16);
    LayeredBsdf black = glossy(dvec3(0), 0, 1);
    black.reflectance.f0 = dvec3(0);
    black.reflectance.f90 = 0;
    const dvec3 wo = at_angle(0.3);
    black.coat_weight = 0.5;
    black.coat_alpha = 0.01;
    black.coat_normal = normalize(dvec3(0.4, 0, 1));
    // All that comes back is the coat's, about the direction mirrored by n_c, whatever n says.
    const dvec3 mirrored = 2 * dot(wo, black.coat_normal) * black.coat_normal - wo;
    EXPECT_GT(evaluate(black, wo, mirrored).x, 100);
    EXPECT_NEAR(
        integrate({-mirrored.x, -mirrored.y, mirrored.z}, [&](const dvec3& wi) { return evaluate(black, wo, wi).x; }),
        0.5, 5e-3);
    // But not through the surface.
    black.ng = normalize(dvec3(-0.95, 0, 0.3));
    ASSERT_LT(dot(black.ng, mirrored), 0);
    EXPECT_EQ(evaluate(black, wo, mirrored), dvec3(0));
}

TEST(Layers, both_normals_must_agree_which_side_light_comes_from)
{
    for (LayeredModel model : layered_models()) {
        if (model.bsdf.coat_weight > 0) continue;
        model.bsdf.ng = normalize(dvec3(0.6, 0, 0.8));
        Random random(103);
        for (int i = 0; i < 300; ++i) {
            const dvec3 wi = random.direction();
            if (wi.z * dot(model.bsdf.ng, wi) < 0) {
                EXPECT_EQ(evaluate(model.bsdf, at_angle(0.2), wi), dvec3(0));
            }
        }
    }
}

TEST(Layers, S15_no_draw_at_any_extreme_is_bad)
{
    Random random(104);
    for (LayeredModel model : layered_models())
        for (const double alpha : {1e-3, 1.0})
            for (const double cosine : {1e-12, 1e-7, 1e-3, 0.5, 1.0})
                for (const double ior : {0.0, 1.0, 1 + 1e-12, 1.5, 1e6}) {
                    LayeredBsdf bsdf = model.bsdf;
                    bsdf.alpha = dvec2(alpha, bsdf.alpha.y);
                    if (bsdf.body) bsdf.body->ior = dvec3(ior, ior, ior == 0 ? 0 : ior + 0.01);
                    for (int i = 0; i < 12; ++i) {
                        const dvec3 wo = normalize(dvec3(std::sqrt(1 - cosine * cosine), 0, cosine));
                        const auto drawn = sample(bsdf, wo, three(random));
                        if (!drawn) continue;
                        ASSERT_TRUE(is_finite(drawn->weight) && is_finite(drawn->wi) && drawn->pdf > 0)
                            << model.name << " " << alpha << " " << cosine << " " << ior;
                        for (int c = 0; c < 3; ++c) ASSERT_GE(drawn->weight[c], 0) << model.name;
                        ASSERT_NEAR(length(drawn->wi), 1, 1e-9);
                    }
                }
}

}  // namespace
}  // namespace etalon::reference
