#include "engine/reference/light.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <memory>

#include "engine/scene/builder.h"
#include "tests/unit/reference/random.h"

namespace etalon::reference {
namespace {

using test::Random;

struct Lit {
    Scene scene;
    PosedScene posed;
    World world;
    explicit Lit(Scene s) : scene(std::move(s)), posed(pose(scene)), world(posed, {}, false) {}
};

Material emitter(double radiance, bool double_sided = false)
{
    Material m;
    m.model = BsdfModel::lambert;
    m.base_color = dvec4(0, 0, 0, 1);
    m.emission = dvec3(radiance);
    m.double_sided = double_sided;
    return m;
}

std::unique_ptr<Lit> lit(const std::function<void(SceneBuilder&)>& fill)
{
    SceneBuilder builder("lit");
    fill(builder);
    return std::make_unique<Lit>(std::move(builder).finish());
}

TEST(Light, SH_22_point_light_falls_off_with_the_square_and_window_of_its_range)
{
    PosedLight light{.light = {.type = LightType::point, .color = {1, 2, 3}, .intensity = 10}, .position = {0, 3, 0}};
    const Incident near = incident(light, {0, 1, 0});
    EXPECT_EQ(near.wi, dvec3(0, 1, 0));
    EXPECT_EQ(near.irradiance, dvec3(2.5, 5, 7.5));
    light.light.range = 4;
    EXPECT_NEAR(incident(light, {0, 1, 0}).irradiance.x, 2.5 * (1 - 1.0 / 16), 1e-15);
    EXPECT_EQ(incident(light, {0, -1.0001, 0}).irradiance, dvec3(0));
    EXPECT_EQ(incident(light, light.position).irradiance, dvec3(0));  // on the light itself (S5)
}

TEST(Light, SH_22_a_spot_has_its_cone_and_a_directional_light_no_distance)
{
    PosedLight spot{.light = {.type = LightType::spot, .intensity = 4, .inner_cone = 0.2, .outer_cone = 0.4},
                    .position = dvec3(0),
                    .direction = {0, 0, -1}};
    const auto at = [&](double angle) {
        return incident(spot, 2.0 * dvec3(std::sin(angle), 0, -std::cos(angle))).irradiance.x;
    };
    EXPECT_NEAR(at(0), 1, 1e-15);
    EXPECT_NEAR(at(0.19), 1, 1e-15);
    EXPECT_EQ(at(0.41), 0);
    const double inside = (std::cos(0.3) - std::cos(0.4)) / (std::cos(0.2) - std::cos(0.4));
    EXPECT_NEAR(at(0.3), inside * inside, 1e-14);
    spot.light.inner_cone = spot.light.outer_cone - 1e-5;  // the witness's hard cone
    EXPECT_EQ(at(0.4 + 1e-9), 0);
    EXPECT_NEAR(at(0.4 - 1.1e-5), 1, 1e-9);
    const PosedLight sun{.light = {.type = LightType::directional, .intensity = 7}, .direction = {0, -1, 0}};
    EXPECT_EQ(incident(sun, {1e6, 0, 5}).irradiance.x, 7);
    EXPECT_EQ(incident(sun, {1e6, 0, 5}).wi, dvec3(0, 1, 0));
}

// E[radiance cosθ / pdf] at p with normal up: the irradiance that a light gives without obstacles.
double irradiance_by_samples(const AreaLights& lights, const dvec3& p, const dvec3& n, int draws, double& error)
{
    Random random(61);
    double sum = 0, squares = 0;
    for (int i = 0; i < draws; ++i) {
        const double pick = random.uniform();
        double x = 0;
        if (const auto s = lights.sample(p, pick, random.square()))
            x = s->radiance.x * std::max(0.0, dot(n, s->wi)) / s->pdf;
        sum += x;
        squares += x * x;
    }
    const double mean = sum / draws;
    error = std::sqrt(std::max(0.0, squares / draws - mean * mean) / draws);
    return mean;
}

TEST(Light, a_rectangle_light_gives_its_form_factor)
{
    // Seen from below its corner at height h, sides a, b (Howell's catalogue, C-11): exact.
    const auto scene = lit([](SceneBuilder& b) {
        b.show("light", make_rectangle({1, 2, 1.5}, {1, 0, 0}, {0, 0, 1.5}),
               b.material(emitter(3)));  // normal: x × z = -y
    });
    const AreaLights lights(scene->world);
    const double a = 2 / 2.0, b = 3 / 2.0;
    const double factor = (a / std::sqrt(1 + a * a) * std::atan(b / std::sqrt(1 + a * a)) +
                           b / std::sqrt(1 + b * b) * std::atan(a / std::sqrt(1 + b * b))) /
                          (2 * kPi);
    double error;
    const double found = irradiance_by_samples(lights, {0, 0, 0}, {0, 1, 0}, 40000, error);
    EXPECT_NEAR(found, 3 * kPi * factor, 5 * error);
    EXPECT_LT(error, 0.01 * found);
}

TEST(Light, S19_a_sphere_light_gives_its_form_factor_from_near_and_far)
{
    for (const double distance : {1.01, 3.0, 1e3, 1e6}) {
        const auto scene = lit([&](SceneBuilder& b) {
            b.sphere("light", {0, distance, 0}, 1, b.material(emitter(2)));
        });
        const AreaLights lights(scene->world);
        double error;
        const double found = irradiance_by_samples(lights, dvec3(0), {0, 1, 0}, 20000, error);
        // E = π L (r/d)² of a sphere wholly above the horizon.
        EXPECT_NEAR(found * distance * distance, 2 * kPi, 5 * error * distance * distance + 1e-9) << distance;
    }
}

TEST(Light, the_density_of_a_met_light_is_the_density_of_drawing_it)
{
    const auto scene = lit([](SceneBuilder& b) {
        const Index both = b.material(emitter(3, true));
        b.show("panel", make_rectangle({0, 2, 0}, {0.5, 0, 0}, {0, 0, 0.5}), both);
        b.sphere("ball", {2, 1, 0}, 0.5, both);
        b.sphere("around", {0, 0, 0}, 9, both);
    });
    const AreaLights lights(scene->world);
    Random random(62);
    int compared = 0;
    for (int i = 0; i < 3000; ++i) {
        const dvec3 p = random.box(0.9);
        const auto drawn = lights.sample(p, random.uniform(), random.square());
        if (!drawn) continue;
        const Ray ray{.origin = p, .direction = drawn->wi};
        const auto hit = scene->world.index.closest(ray, [&](const Hit& h) { return h.shape == drawn->shape; });
        ASSERT_TRUE(hit);
        EXPECT_NEAR(lights.pdf(p, ray, *hit) / drawn->pdf, 1, 1e-6);
        ++compared;
    }
    EXPECT_GT(compared, 2900);
}

TEST(Light, SH_21_sides_that_do_not_emit_are_dark)
{
    const auto scene = lit([](SceneBuilder& b) {
        b.show("light", make_rectangle({0, 2, 0}, {0, 0, 1}, {1, 0, 0}), b.material(emitter(3)));  // normal: z × x = +y
    });
    const AreaLights lights(scene->world);
    ASSERT_FALSE(lights.empty());
    EXPECT_FALSE(lights.sample({0, 0, 0}, 0.5, {0.3, 0.3}));
    EXPECT_TRUE(lights.sample({0, 4, 0}, 0.5, {0.3, 0.3}));
}

TEST(Light, S20_emitters_without_area_or_light_are_no_lights)
{
    const auto scene = lit([](SceneBuilder& b) {
        Primitive flat;
        flat.positions = {vec3(0), vec3(1), vec3(2)};
        flat.indices = {0, 1, 2};
        b.show("flat", flat, b.material(emitter(3)));
        b.show("dark", make_rectangle({0, 2, 0}, {1, 0, 0}, {0, 0, 1}), b.material(emitter(0)));
        Material unlit;
        unlit.model = BsdfModel::unlit;
        b.show("unlit", make_rectangle({0, 3, 0}, {1, 0, 0}, {0, 0, 1}), b.material(unlit));
    });
    EXPECT_TRUE(AreaLights(scene->world).empty());
}

TEST(Light, S25_MIS_weights_add_to_one_however_large_the_densities)
{
    for (const double p : {1e-300, 1e-25, 1.0, 1e38, 1e300})
        for (const double q : {1e-300, 1e-25, 1.0, 1e38, 1e300})
            EXPECT_NEAR(power_heuristic(p, q) + power_heuristic(q, p), 1, 1e-15);
    EXPECT_EQ(power_heuristic(0, 1), 0);
    EXPECT_EQ(power_heuristic(1, 0), 1);
    EXPECT_EQ(power_heuristic(0, 0), 0);
    EXPECT_NEAR(power_heuristic(2, 1), 0.8, 1e-15);
}

}  // namespace
}  // namespace etalon::reference
