#include "engine/measure/stability.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "engine/base/error.h"
#include "engine/measure/invariants.h"
#include "engine/scene/builder.h"
#include "engine/scene/load.h"

namespace etalon {
namespace {

double distance_of_eye(const PosedScene& posed)
{
    return glm::length(dvec3(posed.view.world_from_camera[3]));
}

// A path tracer of one grey whose value a fault beyond some distance from the origin makes a tenth brighter.
struct Pretended {
    double breaks_at = 1e30;

    Film operator()(const PosedScene& posed, const RenderSettings& settings, const Progress& /*progress*/) const
    {
        Film film;
        film.width = posed.view.width;
        film.height = posed.view.height;
        film.samples = settings.spp;
        const double deviation = 0.01 * std::sqrt(64.0 / double(settings.spp));
        std::mt19937_64 random(settings.seed);
        std::normal_distribution<float> normal(distance_of_eye(posed) > breaks_at ? 1.1f : 1.0f, float(deviation));
        for (std::size_t i = 0; i < film.pixel_count(); ++i) {
            film.mean.emplace_back(normal(random), normal(random), normal(random));
            film.variance.emplace_back(float(deviation * deviation));
            film.alpha.push_back(1);
        }
        return film;
    }
};

struct Tried {
    Stability table;
    const StabilityRow* row(std::string_view name) const
    {
        for (const StabilityRow& row : table.rows)
            if (row.name == name) return &row;
        return nullptr;
    }
};

Tried try_all(const std::function<Film(const PosedScene&, const RenderSettings&, const Progress&)>& render)
{
    const Scene scene = make_builtin("triangle");
    const PoseSettings view{.size = ivec2(32, 32)};
    const PosedScene posed = pose(scene, view);
    const StabilitySettings settings{.renderers = {Renderer::path}, .bisections = 6};
    return {
        measure_stability({.scene = "triangle"}, posed, view, settings, {.render = render, .judge_raster = {}}, {})};
}

TEST(Stability, a_fault_is_found_between_the_sizes_that_it_lies_between)
{
    const Tried tried = try_all(Pretended{.breaks_at = 3e4});
    const StabilityRow* row = tried.row("translation");
    ASSERT_NE(row, nullptr);
    EXPECT_EQ(row->promise, Holding::breaks);
    ASSERT_TRUE(row->breaks_at().has_value());
    EXPECT_GT(row->holds_to(), 1e3);
    EXPECT_LT(row->holds_to(), 3e4);
    EXPECT_GE(*row->breaks_at(), 3e4 * 0.99);
    EXPECT_LT(*row->breaks_at(), 1e6);
    EXPECT_LT(*row->breaks_at() / row->holds_to(), 4);
    EXPECT_FALSE(passed(tried.table));
    EXPECT_EQ(tried.row("triangle order")->promise, Holding::holds);
    EXPECT_THAT(stability_table(tried.table), testing::HasSubstr("BREAKS"));
}

TEST(Stability, a_renderer_that_holds_passes_and_the_scene_is_not_asked_for_what_it_lacks)
{
    const Tried tried = try_all(Pretended{});
    EXPECT_TRUE(passed(tried.table));
    EXPECT_EQ(tried.row("instances flattened"), nullptr);
    EXPECT_EQ(tried.row("near plane nearer"), nullptr) << "a path tracer has none";
    EXPECT_EQ(tried.row("scale up")->holds_to(), 1e12);
    EXPECT_THAT(stability_json(tried.table), testing::HasSubstr("\"etalon-stability/1\""));
    EXPECT_THAT(stability_html(tried.table), testing::HasSubstr("Every promised range"));
}

TEST(Stability, what_a_variant_throws_is_a_break_with_its_words)
{
    const Tried tried = try_all([](const PosedScene& posed, const RenderSettings& settings, const Progress& progress) {
        if (distance_of_eye(posed) > 1e5) throw Error(Blame::machine, "too far");
        return Pretended{}(posed, settings, progress);
    });
    const StabilityRow* row = tried.row("translation");
    ASSERT_NE(row, nullptr);
    EXPECT_EQ(row->promise, Holding::breaks);
    EXPECT_THAT(row->probes.front().why, testing::HasSubstr("too far"));
}

TEST(Relations, the_canonical_scene_shows_what_the_scene_shows)
{
    for (const char* name : {"cornell", "lights", "thin-lens", "orthographic", "instances"}) {
        const Scene scene = make_builtin(name);
        const PoseSettings view{.size = ivec2(40, 30)};
        const PosedScene posed = pose(scene, view);
        const Scene same = canonical_scene(posed, view);
        const PosedScene again = pose(same, canonical_view(posed, view));
        EXPECT_EQ(again.draws.size(), posed.draws.size()) << name;
        EXPECT_EQ(again.lights.size(), posed.lights.size()) << name;
        EXPECT_EQ(again.view.camera.orthographic, posed.view.camera.orthographic) << name;
        EXPECT_EQ(again.view.camera.xmag, posed.view.camera.xmag) << name;
        EXPECT_EQ(again.environment.is_black(), posed.environment.is_black()) << name;
        for (int column = 0; column < 4; ++column)
            for (int row = 0; row < 4; ++row)
                EXPECT_NEAR(again.view.world_from_camera[column][row], posed.view.world_from_camera[column][row], 1e-12)
                    << name;
    }
}

TEST(Relations, R1_lengths_scale_and_point_lights_by_the_square)
{
    const Scene scene = make_builtin("lights");
    const PoseSettings view{.size = ivec2(40, 30)};
    const PosedScene posed = pose(scene, view);
    const Scene base = canonical_scene(posed, view);
    const Relation& up = relations().front();
    ASSERT_EQ(up.name, "scale up");
    const std::optional<Variant> variant = up.apply(base, 10);
    ASSERT_TRUE(variant.has_value());
    const PosedScene scaled = pose(variant->scene, canonical_view(posed, view));
    ASSERT_EQ(scaled.lights.size(), posed.lights.size());
    for (std::size_t i = 0; i < posed.lights.size(); ++i) {
        const double factor = posed.lights[i].light.type == LightType::directional ? 1 : 100;
        EXPECT_NEAR(scaled.lights[i].light.intensity, factor * posed.lights[i].light.intensity, 1e-9 * factor);
        EXPECT_NEAR(glm::length(scaled.lights[i].position - 10.0 * posed.lights[i].position), 0, 1e-9);
    }
    EXPECT_NEAR(distance_of_eye(scaled), 10 * distance_of_eye(posed), 1e-9);
}

TEST(Invariants, R21_a_slope_of_one_half_holds_and_any_other_does_not)
{
    const auto pretend = [](double power) {
        return [power, seed = 0u](std::uint64_t samples) mutable {
            Film film{.width = 32, .height = 32, .samples = samples};
            std::mt19937_64 random(++seed);
            std::normal_distribution<double> normal(1, 0.5 * std::pow(double(samples), power));
            for (std::size_t i = 0; i < film.pixel_count(); ++i)
                film.mean.emplace_back(normal(random), normal(random), normal(random));
            return film;
        };
    };
    EXPECT_TRUE(error_slope(pretend(-0.5), 1e-3).holds);
    EXPECT_FALSE(error_slope(pretend(-0.4), 1e-3).holds) << "a bias, or samples that are not independent";
    EXPECT_FALSE(error_slope(pretend(-0.6), 1e-3).holds);
    EXPECT_TRUE(error_slope([](std::uint64_t) { return Film{.width = 1, .height = 1, .mean = {vec3(1)}}; }, 1e-3).holds)
        << "a picture without noise has no slope";
}

TEST(Invariants, R22_a_furnace_that_loses_light_is_seen)
{
    const auto film = [](float value, std::size_t dark) {
        Film out{.width = 64, .height = 32, .samples = 64};
        out.mean.assign(out.pixel_count(), vec3(1));
        for (std::size_t i = 0; i < dark; ++i) out.mean[i] = vec3(value);
        out.variance.assign(out.pixel_count(), vec3(1e-6f));
        out.alpha.assign(out.pixel_count(), 1);
        return out;
    };
    EXPECT_TRUE(judge_furnace(film(1, 0), 1e-3).holds);
    EXPECT_TRUE(judge_furnace(film(0.999f, 2048), 1e-3).holds) << "what the tables may be off by";
    EXPECT_FALSE(judge_furnace(film(0.98f, 2048), 1e-3).holds);
    EXPECT_FALSE(judge_furnace(film(1.5f, 64), 1e-3).holds) << "light from nowhere";
}

TEST(Relations, R8_a_subdivided_scene_has_the_same_surface)
{
    SceneBuilder bumpy("bumpy");
    Material bumps{.name = "bumps"};
    bumps.normal_texture = bumpy.texture("flat", 1, 1, {}, [](int, int) {
        return std::array<std::uint8_t, 4>{128, 128, 255, 255};
    });
    bumpy.show("wall", make_rectangle(dvec3(0), dvec3(1, 0, 0), dvec3(0, 1, 0)), bumpy.material(bumps));
    const Scene normal_mapped = std::move(bumpy).finish();
    const Scene scene = canonical_scene(pose(normal_mapped), {});
    const Relation* split = nullptr;
    for (const Relation& relation : relations())
        if (relation.id == "R8") split = &relation;
    ASSERT_NE(split, nullptr);
    EXPECT_FALSE(split->apply(scene, 1)) << "tangents are not linear";
    SceneBuilder builder("one");
    const Index grey = builder.lambert("grey", dvec3(0.5));
    builder.show("wall", make_rectangle(dvec3(0), dvec3(1, 0, 0), dvec3(0, 1, 0)), grey);
    builder.camera("eye", 45, dvec3(0, 0, 5), dvec3(0));
    const Scene wall = std::move(builder).finish();
    const auto twice = split->apply(canonical_scene(pose(wall), {}), 2);
    ASSERT_TRUE(twice);
    const Primitive& p = twice->scene.meshes[0].primitives[0];
    EXPECT_EQ(p.indices.size(), 2u * 16 * 3);
    EXPECT_EQ(p.positions.size(), 25u) << "edges are shared: no crack";
    double area = 0;
    for (std::size_t i = 0; i < p.indices.size(); i += 3) {
        const auto at = [&](std::size_t k) { return dvec3(p.positions[p.indices[i + k]]); };
        const dvec3 a = at(0), b = at(1), c = at(2);
        const dvec3 n = cross(b - a, c - a);
        EXPECT_GT(n.z, 0) << "still seen from the front";
        area += 0.5 * length(n);
    }
    EXPECT_NEAR(area, 4, 1e-6);
}

}  // namespace
}  // namespace etalon
