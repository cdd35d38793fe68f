// What the reference draws of layered materials and averages over bodies, against what it should be. Seeded; the rates
// are the chance that an honest program would have met a seed that fails.
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <optional>
#include <string>

#include "engine/math/stats.h"
#include "engine/reference/reference.h"
#include "engine/scene/builder.h"
#include "tests/stat/reference_chi_square.h"
#include "tests/unit/reference/layered_models.h"
#include "tests/unit/reference/random.h"

namespace etalon::reference {
namespace {

using test::Bins;
using test::chi_square;
using test::layered_models;
using test::LayeredModel;
using test::Random;

/// Of the whole file: 1e-3, over about this many comparisons.
constexpr double kFalseAlarm = 1e-3;
constexpr int kComparisons = 70;

double level()
{
    return sidak_level(kFalseAlarm, kComparisons);
}

TEST(ReferenceLayers, MC_6_SH_64_every_lobe_draws_what_its_density_says)
{
    Random random(171);
    for (const LayeredModel& model : layered_models())
        for (const double theta : {0.2, 1.3}) {
            const dvec3 wo(std::sin(theta) * 0.8, std::sin(theta) * 0.6, std::cos(theta));
            const double p = chi_square(
                Bins(wo),
                [&]() -> std::optional<dvec3> {
                    const auto drawn = sample(model.bsdf, wo, {random.uniform(), random.uniform(), random.uniform()});
                    return drawn && !drawn->delta ? std::optional(drawn->wi) : std::nullopt;
                },
                [&](const dvec3& wi) { return pdf(model.bsdf, wo, wi); });
            EXPECT_GT(p, level()) << model.name << " at " << theta;
        }
}

TEST(ReferenceLayers, the_chi_square_finds_a_lobe_that_is_slightly_wrong)
{
    Random random(172);
    LayeredBsdf said = layered_models()[1].bsdf, drawn_from = said;
    drawn_from.alpha.x *= 1.06;
    const dvec3 wo(std::sin(0.9) * 0.8, std::sin(0.9) * 0.6, std::cos(0.9));
    const double p = chi_square(
        Bins(wo),
        [&]() -> std::optional<dvec3> {
            const auto drawn = sample(drawn_from, wo, {random.uniform(), random.uniform(), random.uniform()});
            return drawn ? std::optional(drawn->wi) : std::nullopt;
        },
        [&](const dvec3& wi) { return pdf(said, wo, wi); });
    EXPECT_LT(p, 1e-6);
}

struct Estimate {
    dvec3 mean{0};
    dvec3 variance{0};  ///< of the mean
};

Estimate picture(const Scene& scene, const RenderSettings& settings, ivec2 size)
{
    PoseSettings pose_settings;
    pose_settings.size = size;
    const PosedScene posed = pose(scene, pose_settings);
    const Film film = render_path(posed, require(posed, settings), settings, {});
    Estimate out;
    const auto n = static_cast<double>(film.pixel_count());
    for (std::size_t i = 0; i < film.pixel_count(); ++i) {
        out.mean += dvec3(film.mean[i]) / n;
        out.variance += dvec3(film.variance[i]) / (n * n);
    }
    return out;
}

Material body(double ior, double roughness)
{
    Material m;
    m.metallic = 0;
    m.roughness = roughness;
    m.layers.emplace();
    m.layers->ior = ior;
    m.layers->transmission = 1;
    m.layers->thickness = 1;
    return m;
}

/// A ball of the material in a furnace of radiance 1.
Scene ball_in_furnace(const Material& material, double half_extent)
{
    SceneBuilder b("ball");
    b.sphere("ball", dvec3(0), 1, b.material(material));
    b.environment({.radiance = dvec3(1)});
    b.camera(Camera{.orthographic = true, .xmag = half_extent, .ymag = half_extent},
             rotation_y(0.4) * translation({0, 0, 5}));
    return std::move(b).finish();
}

TEST(ReferenceLayers, R22_SH_58_a_clear_body_in_a_furnace_is_not_to_be_seen)
{
    for (const double ior : {1.0, 1.33, 2.4})
        for (const double dispersion : {0.0, 2.0}) {
            Material glass = body(ior, 0);
            glass.layers->dispersion = dispersion;
            const Estimate e = picture(ball_in_furnace(glass, 0.7), {.spp = 128, .seed = 5, .max_depth = 64}, {16, 16});
            for (int c = 0; c < 3; ++c) {
                // What its smallest roughness, 0.001, loses and spreads, and five standard errors.
                EXPECT_NEAR(e.mean[c], 1, 5 * std::sqrt(e.variance[c]) + 4e-3) << ior << " " << dispersion;
            }
            EXPECT_LT(std::sqrt(e.variance.y), 0.02);
        }
}

TEST(ReferenceLayers, R22_SH_58_a_rough_body_in_a_furnace_is_darker_by_what_one_bounce_loses)
{
    const Estimate e = picture(ball_in_furnace(body(1.5, 0.5), 0.7), {.spp = 64, .seed = 6, .max_depth = 64}, {16, 16});
    EXPECT_LT(e.mean.y, 1 + 4 * std::sqrt(e.variance.y));
    EXPECT_GT(e.mean.y, 0.8);
}

TEST(ReferenceLayers, SH_59_light_that_goes_through_a_body_is_absorbed_by_Beer_and_Lambert)
{
    Material amber = body(1, 0);
    amber.layers->attenuation_color = {0.9, 0.5, 0.1};
    amber.layers->attenuation_distance = 0.7;
    // Through the middle: 2 m, straight. Index 1 reflects nothing head on.
    const Estimate e = picture(ball_in_furnace(amber, 1e-4), {.spp = 400, .seed = 7}, {4, 4});
    const double lengths = 2 / 0.7;
    const dvec3 expected(std::pow(0.9, lengths), std::pow(0.5, lengths), std::pow(0.1, lengths));
    for (int c = 0; c < 3; ++c)
        EXPECT_NEAR(e.mean[c], expected[c], 5 * std::sqrt(e.variance[c]) + 1e-6 * expected[c]) << c;
    EXPECT_LT(std::sqrt(e.variance.x), 0.02 * e.mean.x);
    // Black absorbs all, an endless distance nothing.
    amber.layers->attenuation_color = dvec3(0);
    EXPECT_LT(picture(ball_in_furnace(amber, 1e-4), {.spp = 16}, {4, 4}).mean.y, 1e-6);
    amber.layers->attenuation_distance = std::numeric_limits<double>::infinity();
    EXPECT_NEAR(picture(ball_in_furnace(amber, 1e-4), {.spp = 400}, {4, 4}).mean.y, 1, 0.05);
}

TEST(ReferenceLayers, SH_59_a_lamp_inside_a_body_is_seen_through_what_lies_between)
{
    // A matt floor inside a body of index 1 is lit by a sphere inside it; the camera looks in from outside.
    const auto scene = [](bool absorbing) {
        SceneBuilder b("bowl");
        Material bowl = body(1, 0);
        if (absorbing) {
            bowl.layers->attenuation_color = dvec3(0.5);
            bowl.layers->attenuation_distance = 1;
        }
        b.sphere("bowl", dvec3(0), 4, b.material(bowl));
        b.show("floor", make_rectangle(dvec3(0), {0, 0, 0.2}, {0.2, 0, 0}), b.lambert("white", dvec3(1)));
        Material lamp;
        lamp.model = BsdfModel::lambert;
        lamp.base_color = dvec4(0, 0, 0, 1);
        lamp.emission = dvec3(100);
        b.sphere("lamp", {2, 2, 0}, 0.05, b.material(lamp));
        b.camera(Camera{.orthographic = true, .xmag = 1e-3, .ymag = 1e-3},
                 translation({0, 6, 0}) * rotation_x(-kPi / 2));
        return std::move(b).finish();
    };
    const Estimate clear = picture(scene(false), {.spp = 256, .seed = 8, .max_depth = 4}, {4, 4});
    const Estimate dim = picture(scene(true), {.spp = 256, .seed = 9, .max_depth = 4}, {4, 4});
    // 4 m up to the rim, 2√2 m to the lamp's middle; its near side is 0.05 m closer at most.
    const double expected = clear.mean.y * std::pow(0.5, 4 + 2 * std::sqrt(2.0));
    EXPECT_NEAR(dim.mean.y, expected, 5 * std::sqrt(dim.variance.y + clear.variance.y * 1e-4) + 0.05 * expected);
    EXPECT_GT(dim.mean.y, 0);
}

TEST(ReferenceLayers, SH_62_a_coat_dims_the_emission_below_it)
{
    SceneBuilder b("lamp");
    Material lamp;
    lamp.base_color = dvec4(0, 0, 0, 1);
    lamp.metallic = 0;
    lamp.emission = dvec3(2);
    lamp.layers.emplace();
    lamp.layers->clearcoat = 1;
    b.show("lamp", make_rectangle(dvec3(0), {1, 0, 0}, {0, 1, 0}), b.material(lamp));
    b.camera(Camera{.orthographic = true, .xmag = 1e-3, .ymag = 1e-3}, translation({0, 0, 2}));
    const Scene scene = std::move(b).finish();
    EXPECT_NEAR(picture(scene, {.spp = 4, .max_depth = 1}, {2, 2}).mean.y, 2 * 0.96, 1e-6);
}

TEST(ReferenceLayers, S17_SH_53_a_white_rough_metal_ball_in_a_furnace_is_not_to_be_seen)
{
    for (const double roughness : {0.0, 0.4, 1.0}) {
        Material metal;
        metal.roughness = roughness;
        const Estimate e = picture(ball_in_furnace(metal, 0.6), {.spp = 64, .seed = 10, .max_depth = 3}, {16, 16});
        EXPECT_NEAR(e.mean.y, 1, 5 * std::sqrt(e.variance.y) + 1e-3) << roughness;
        EXPECT_LT(std::sqrt(e.variance.y), 0.01);
    }
}

}  // namespace
}  // namespace etalon::reference
