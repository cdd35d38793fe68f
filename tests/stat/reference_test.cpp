// What the reference draws and averages, against what it should be. Everything is seeded: a run either passes always or
// never; the rates below are the chance that an honest program would have met a seed that fails.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "engine/math/stats.h"
#include "engine/reference/path.h"
#include "engine/reference/pixel_sums.h"
#include "engine/reference/reference.h"
#include "engine/scene/builder.h"
#include "engine/scene/load.h"
#include "tests/stat/reference_chi_square.h"
#include "tests/unit/reference/random.h"

namespace etalon::reference {
namespace {

using test::Bins;
using test::chi_square;
using test::Random;

/// Of the whole file: 1e-3, over about this many comparisons.
constexpr double kFalseAlarm = 1e-3;
constexpr int kComparisons = 120;

double level()
{
    return sidak_level(kFalseAlarm, kComparisons);
}

/// Whether two means with these variances may be one, at the file's level.
::testing::AssertionResult agree(double a, double variance_a, double b, double variance_b)
{
    const double z = (a - b) / std::sqrt(variance_a + variance_b + 1e-14 * a * a);
    if (normal_two_sided_p(z) > level()) return ::testing::AssertionSuccess();
    return ::testing::AssertionFailure() << a << " and " << b << " are " << z << " standard errors apart";
}

dvec3 at_angle(double theta)
{
    return {std::sin(theta), 0, std::cos(theta)};
}

struct Named {
    std::string name;
    Bsdf bsdf;
};

std::vector<Named> models()
{
    std::vector<Named> all{{"lambert", {.model = BsdfModel::lambert, .color = dvec3(0.5)}}};
    for (const double alpha : {0.15, 0.5, 1.0}) {
        const std::string a = " " + std::to_string(alpha);
        all.push_back({"conductor" + a,
                       {.model = BsdfModel::rough_conductor, .alpha = alpha, .eta = dvec3(0.2), .k = dvec3(3.9)}});
        all.push_back(
            {"plastic" + a,
             {.model = BsdfModel::metallic_roughness, .color = dvec3(0.5), .f0 = dvec3(0.04), .alpha = alpha}});
        all.push_back({"glass, outside" + a, {.model = BsdfModel::rough_dielectric, .alpha = alpha, .ior = 1.5}});
        all.push_back({"glass, inside" + a, {.model = BsdfModel::rough_dielectric, .alpha = alpha, .ior = 1 / 1.5}});
    }
    return all;
}

TEST(ReferenceStatistics, MC_6_S15_every_BSDF_draws_what_its_density_says)
{
    Random random(71);
    for (const auto& [name, bsdf] : models())
        for (const double theta : {0.0, 0.9, 1.45}) {
            const dvec3 wo = at_angle(theta);
            const double p = chi_square(
                Bins(wo),
                [&, b = bsdf]() -> std::optional<dvec3> {
                    const auto drawn = sample(b, wo, {random.uniform(), random.uniform(), random.uniform()});
                    return drawn ? std::optional(drawn->wi) : std::nullopt;
                },
                [&, b = bsdf](const dvec3& wi) { return pdf(b, wo, wi); });
            EXPECT_GT(p, level()) << name << " at " << theta;
        }
}

TEST(ReferenceStatistics, the_chi_square_finds_a_sampler_that_is_slightly_wrong)
{
    Random random(72);
    const Bsdf said{.model = BsdfModel::rough_conductor, .alpha = 0.5, .eta = dvec3(0), .k = dvec3(1)};
    Bsdf drawn_from = said;
    drawn_from.alpha = 0.53;
    const dvec3 wo = at_angle(0.9);
    const double p = chi_square(
        Bins(wo),
        [&]() -> std::optional<dvec3> {
            const auto drawn = sample(drawn_from, wo, {random.uniform(), random.uniform(), random.uniform()});
            return drawn ? std::optional(drawn->wi) : std::nullopt;
        },
        [&](const dvec3& wi) { return pdf(said, wo, wi); });
    EXPECT_LT(p, 1e-6);
}

TEST(ReferenceStatistics, S23_environment_draws_follow_their_density)
{
    auto map = std::make_shared<Image>(24, 12, 3);
    for (int y = 0; y < 12; ++y)
        for (int x = 0; x < 24; ++x)
            for (int c = 0; c < 3; ++c)
                map->at(x, y, c) = static_cast<float>(1 + (x * 5 + y * 3) % 7 + (x == 7 && y == 4 ? 200 : 0));
    const EnvironmentSampler sampler({.radiance = dvec3(0), .map = map, .rotation = 1.1, .scale = 1});
    Random random(73);
    // Texels are constant in density, bins are not aligned with them: their quadrature errs by less than a tenth of the
    // noise.
    const double p = chi_square(
        Bins(at_angle(0.4)), [&]() -> std::optional<dvec3> { return sampler.sample(random.square()).direction; },
        [&](const dvec3& w) { return sampler.pdf(w); });
    EXPECT_GT(p, level());
}

struct Estimate {
    double mean = 0;
    double variance = 0;  ///< of the mean
};

/// The whole picture's mean of a path-traced scene, green alone: the channels of a path are not independent.
Estimate picture(const Scene& scene, const RenderSettings& settings, ivec2 size)
{
    PoseSettings pose_settings;
    pose_settings.size = size;
    const PosedScene posed = pose(scene, pose_settings);
    const Film film = render_path(posed, require(posed, settings), settings, {});
    Estimate out;
    const auto n = static_cast<double>(film.pixel_count());
    for (std::size_t i = 0; i < film.pixel_count(); ++i) {
        out.mean += film.mean[i].y / n;
        out.variance += film.variance[i].y / n / n;
    }
    return out;
}

/// The same without light sampling: what BSDF sampling finds alone.
Estimate picture_by_bsdf(const Scene& scene, const RenderSettings& settings, ivec2 size)
{
    PoseSettings pose_settings;
    pose_settings.size = size;
    const PosedScene posed = pose(scene, pose_settings);
    const World world(posed, {}, false);
    const PathTracer tracer(posed, world, settings, {.sample_lights = false});
    Estimate out;
    const double n = static_cast<double>(size.x) * size.y;
    for (int i = 0; i < size.x * size.y; ++i) {
        PixelSum sum;
        for (std::uint32_t s = 0; s < settings.spp; ++s) {
            const PathRandom random(static_cast<std::uint32_t>(i), s, settings.seed);
            sum.add(tracer.trace(dvec2(i % size.x, i / size.x) + random.in_pixel(), random).radiance, 1);
        }
        out.mean += sum.mean().y / n;
        out.variance += sum.variance_of_mean().y / n / n;
    }
    return out;
}

TEST(ReferenceStatistics, R20_light_sampling_changes_the_noise_but_not_the_mean)
{
    for (const char* name : {"cornell", "spheres", "glass"}) {
        const Scene scene = make_builtin(name);
        const Estimate with = picture(scene, {.spp = 24, .seed = 1, .max_depth = 4}, {32, 32});
        const Estimate without = picture_by_bsdf(scene, {.spp = 200, .seed = 2, .max_depth = 4}, {32, 32});
        EXPECT_TRUE(agree(with.mean, with.variance, without.mean, without.variance)) << name;
        EXPECT_LT(std::sqrt(with.variance + without.variance) / with.mean, 0.1) << "the comparison says nothing";
    }
}

TEST(ReferenceStatistics, M8_Russian_roulette_changes_the_noise_but_not_the_mean)
{
    for (const char* name : {"cornell", "glass", "furnace"}) {
        const Scene scene = make_builtin(name);
        const Estimate with =
            picture(scene, {.spp = 48, .seed = 3, .max_depth = 12, .russian_roulette = true}, {32, 32});
        const Estimate without =
            picture(scene, {.spp = 48, .seed = 4, .max_depth = 12, .russian_roulette = false}, {32, 32});
        EXPECT_TRUE(agree(with.mean, with.variance, without.mean, without.variance)) << name;
    }
}

TEST(ReferenceStatistics, the_stated_variance_is_the_scatter_between_seeds)
{
    const Scene scene = make_builtin("cornell");
    double sum = 0, squares = 0, stated = 0;
    constexpr int kSeeds = 40;
    for (int seed = 0; seed < kSeeds; ++seed) {
        const Estimate e = picture(scene, {.spp = 8, .seed = static_cast<std::uint64_t>(seed)}, {16, 16});
        sum += e.mean;
        squares += e.mean * e.mean;
        stated += e.variance / kSeeds;
    }
    const double mean = sum / kSeeds, scatter = (squares / kSeeds - mean * mean) * kSeeds / (kSeeds - 1);
    // (n - 1) s²/σ² is χ² with n - 1 degrees; both tails at the file's level.
    const double p = chi_square_p((kSeeds - 1) * scatter / stated, kSeeds - 1);
    EXPECT_GT(p, level() / 2);
    EXPECT_LT(p, 1 - level() / 2);
}

Scene floor_under(const std::function<void(SceneBuilder&)>& light)
{
    SceneBuilder builder("floor");
    builder.show("floor", make_rectangle(dvec3(0), {0, 0, 0.5}, {0.5, 0, 0}), builder.lambert("white", dvec3(1)));
    light(builder);
    builder.camera(Camera{.orthographic = true, .xmag = 1e-4, .ymag = 1e-4},
                   translation({0, 0.5, 0}) * rotation_x(-kPi / 2));
    return std::move(builder).finish();
}

Material emitter(double radiance)
{
    Material m;
    m.model = BsdfModel::lambert;
    m.base_color = dvec4(0, 0, 0, 1);
    m.emission = dvec3(radiance);
    return m;
}

/// A floor under a square lamp of side 2 at height 2 above its own middle.
Estimate floor_under_square(double radiance)
{
    const Scene scene = floor_under([&](SceneBuilder& b) {
        b.show("light", make_rectangle({0, 2, 0}, {1, 0, 0}, {0, 0, 1}), b.material(emitter(radiance)));
    });
    return picture(scene, {.spp = 400, .max_depth = 2}, {8, 8});
}

/// Its form factor: four corner rectangles of 1 × 1 (Howell's catalogue, C-11).
double square_form_factor()
{
    const double x = 0.5;
    return 4 * 2 * x / std::sqrt(1 + x * x) * std::atan(x / std::sqrt(1 + x * x)) / (2 * kPi);
}

TEST(ReferenceStatistics, a_floor_under_a_sphere_and_a_rectangle_has_their_form_factors)
{
    const Scene scene = floor_under([](SceneBuilder& b) { b.sphere("light", {0, 3, 0}, 1, b.material(emitter(2))); });
    const Estimate ball = picture(scene, {.spp = 400, .max_depth = 2}, {8, 8});
    EXPECT_TRUE(agree(ball.mean, ball.variance, 2.0 / 9, 0));  // L (r/d)²
    const Estimate square = floor_under_square(3);
    EXPECT_TRUE(agree(square.mean, square.variance, 3 * square_form_factor(), 0));
}

TEST(ReferenceStatistics, a_light_that_is_one_percent_too_bright_is_found)
{
    const Estimate off = floor_under_square(3.03);
    EXPECT_FALSE(agree(off.mean, off.variance, 3 * square_form_factor(), 0));
}

TEST(ReferenceStatistics, SH_6_a_blended_pane_lets_its_share_of_the_light_through)
{
    for (const double alpha : {0.25, 0.8}) {
        // Two panes of unlit colour 1 before a sky of 3: 1 - (1-α)² of the pane, the rest sky; sphere shells count
        // twice as well.
        const auto scene = [&](bool sphere) {
            SceneBuilder b("pane");
            Material m;
            m.model = BsdfModel::unlit;
            m.alpha_mode = AlphaMode::blend;
            m.double_sided = true;
            m.base_color = dvec4(1, 1, 1, alpha);
            const Index pane = b.material(m);
            if (sphere)
                b.sphere("shell", dvec3(0), 2, pane);
            else
                for (const double z : {0.0, 1.0}) b.show("pane", make_rectangle({0, 0, z}, {2, 0, 0}, {0, 2, 0}), pane);
            b.environment({.radiance = dvec3(3)});
            b.camera("camera", 10, {0, 0, 5}, dvec3(0));
            return std::move(b).finish();
        };
        for (const bool sphere : {false, true}) {
            const Estimate e = picture(scene(sphere), {.spp = 64, .seed = 7}, {16, 16});
            EXPECT_TRUE(agree(e.mean, e.variance, 1 + 2 * (1 - alpha) * (1 - alpha), 0)) << alpha << " " << sphere;
        }
    }
}

TEST(ReferenceStatistics, SH_6_shadows_of_blended_and_masked_panes_are_their_opacity)
{
    const auto floor_behind = [](AlphaMode mode, double alpha) {
        return floor_under([&](SceneBuilder& b) {
            Material m;
            m.alpha_mode = mode;
            m.base_color = dvec4(0, 0, 0, alpha);
            m.double_sided = true;
            b.show("pane", make_rectangle({2, 1, 0}, {1, 0, 0}, {0, 0, 1}), b.material(m));
            b.light({.type = LightType::point, .intensity = 10 * kPi}, translation({4, 2, 0}));
        });
    };
    const double free = 10 / 20.0 * 2 / std::sqrt(20.0);
    EXPECT_NEAR(picture(floor_behind(AlphaMode::blend, 0.25), {.spp = 8, .max_depth = 2}, {4, 4}).mean, 0.75 * free,
                1e-4);
    EXPECT_NEAR(picture(floor_behind(AlphaMode::mask, 0.25), {.spp = 8, .max_depth = 2}, {4, 4}).mean, free, 1e-4);
    EXPECT_EQ(picture(floor_behind(AlphaMode::mask, 0.75), {.spp = 8, .max_depth = 2}, {4, 4}).mean, 0);
    EXPECT_EQ(picture(floor_behind(AlphaMode::opaque, 0.75), {.spp = 8, .max_depth = 2}, {4, 4}).mean, 0);
}

}  // namespace
}  // namespace etalon::reference
