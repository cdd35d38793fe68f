#include <gtest/gtest.h>

#include <atomic>
#include <cmath>
#include <functional>
#include <vector>

#include "engine/base/error.h"
#include "engine/reference/reference.h"
#include "engine/scene/builder.h"
#include "engine/scene/load.h"

namespace etalon::reference {
namespace {

Film render(const Scene& scene, RenderSettings settings, ivec2 size, const Progress& progress = {},
            const Environment* environment = nullptr)
{
    PoseSettings pose_settings;
    pose_settings.size = size;
    if (environment != nullptr) pose_settings.environment = *environment;
    const PosedScene posed = pose(scene, pose_settings);
    settings.renderer = Renderer::reference;
    return render_path(posed, require(posed, settings), settings, progress);
}

Scene built(const std::function<void(SceneBuilder&)>& fill)
{
    SceneBuilder builder("test");
    fill(builder);
    return std::move(builder).finish();
}

const vec3& at(const Film& film, int x, int y)
{
    return film.mean[std::size_t(y) * std::size_t(film.width) + std::size_t(x)];
}

TEST(ReferencePath, R22_a_white_sphere_in_a_white_furnace_cannot_be_seen)
{
    const Scene scene = built([](SceneBuilder& b) {
        b.sphere("white", dvec3(0), 1, b.lambert("white", dvec3(1)));
        b.environment({.radiance = dvec3(1)});
        b.camera("camera", 40, {0, 0, 5}, dvec3(0));
    });
    const Film film = render(scene, {.spp = 16, .max_depth = 32, .russian_roulette = false}, {32, 32});
    for (const vec3& pixel : film.mean) EXPECT_EQ(pixel, vec3(1));
    for (const vec3& v : film.variance) EXPECT_EQ(v, vec3(0));
    for (const float a : film.alpha) EXPECT_EQ(a, 1);
    EXPECT_EQ(film.nonfinite, 0u);
    EXPECT_EQ(film.truncated, 0u);
}

TEST(ReferencePath, MC_2_a_grey_sphere_in_a_furnace_is_exactly_its_albedo)
{
    const Scene scene = built([](SceneBuilder& b) {
        b.sphere("grey", dvec3(0), 2, b.lambert("grey", {0.5, 0.25, 0.75}));
        b.environment({.radiance = dvec3(2)});
        b.camera("camera", 20, {0, 0, 5}, dvec3(0));
    });
    const Film film = render(scene, {.spp = 4, .max_depth = 3}, {16, 16});
    for (const vec3& pixel : film.mean) EXPECT_EQ(pixel, vec3(1, 0.5, 1.5));
}

TEST(ReferencePath, a_point_light_gives_the_plane_below_the_inverse_square_and_the_cosine)
{
    const Scene scene = built([](SceneBuilder& b) {
        b.show("floor", make_rectangle(dvec3(0), {0, 0, 5}, {5, 0, 0}), b.lambert("half", dvec3(0.5)));
        b.light({.type = LightType::point, .intensity = 30}, translation({0.5, 2, -0.25}));
        Camera camera{.orthographic = true, .xmag = 4, .ymag = 4};
        b.camera(camera, translation({0, 3, 0}) * rotation_x(-kPi / 2));
    });
    const Film film = render(scene, {.spp = 64, .max_depth = 2}, {16, 16});
    for (int y = 0; y < 16; ++y)
        for (int x = 0; x < 16; ++x) {
            double expected = 0;  // mean over the pixel, 8×8 midpoints
            for (int j = 0; j < 64; ++j) {
                const dvec3 p((x + (j % 8 + 0.5) / 8) / 2 - 4, 0, (y + (j / 8 + 0.5) / 8) / 2 - 4);
                const dvec3 to_light = dvec3(0.5, 2, -0.25) - p;
                const double d2 = dot(to_light, to_light);
                expected += 0.5 / kPi * 30 / d2 * (to_light.y / std::sqrt(d2)) / 64;
            }
            const std::size_t i = std::size_t(y) * 16 + std::size_t(x);
            EXPECT_NEAR(at(film, x, y).x, expected, 6 * std::sqrt(film.variance[i].x) + 1e-3 * expected)
                << x << " " << y;
        }
}

TEST(ReferencePath, SH_20_depth_counts_segments_from_the_camera_to_the_light)
{
    // One white wall lit by a sky: 1 shows emission alone, 2 the wall. A closed grey room with a glowing wall goes on
    // further.
    const Scene wall = built([](SceneBuilder& b) {
        b.show("wall", make_rectangle(dvec3(0), {1, 0, 0}, {0, 1, 0}), b.lambert("white", dvec3(1)));
        b.environment({.radiance = dvec3(1)});
        b.camera("camera", 20, {0, 0, 2}, dvec3(0));
    });
    const Film one = render(wall, {.spp = 4, .max_depth = 1}, {8, 8});
    EXPECT_EQ(at(one, 4, 4), vec3(0));
    EXPECT_EQ(one.truncated, 4u * 64u);
    EXPECT_EQ(at(render(wall, {.spp = 4, .max_depth = 2}, {8, 8}), 4, 4), vec3(1));

    const Scene glow = built([](SceneBuilder& b) {
        Material m;
        m.model = BsdfModel::lambert;
        m.base_color = dvec4(0.5, 0.5, 0.5, 1);
        m.emission = dvec3(1);
        m.double_sided = true;
        b.sphere("room", dvec3(0), 10, b.material(m));
        b.camera("camera", 40, {0, 0, 1}, dvec3(0));
    });
    for (int depth = 1; depth <= 5; ++depth) {  // inside an emitter of radiance 1 and albedo ½: Σ 2⁻ᵏ
        const Film film = render(glow, {.spp = 64, .max_depth = depth, .russian_roulette = false}, {4, 4});
        double mean = 0, variance = 0;
        for (std::size_t i = 0; i < 16; ++i) mean += film.mean[i].x / 16, variance += film.variance[i].x / 256;
        EXPECT_NEAR(mean, 2 - std::exp2(1 - depth), 5 * std::sqrt(variance) + 1e-6) << depth;
    }
}

TEST(ReferencePath, S11_glass_of_index_one_cannot_be_seen_and_real_glass_keeps_a_furnace_white)
{
    for (const double ior : {1.0, 1.5})
        for (const BsdfModel model : {BsdfModel::dielectric, BsdfModel::rough_dielectric}) {
            if (ior > 1 && model == BsdfModel::rough_dielectric) continue;  // loses what single scattering loses
            const Scene scene = built([&](SceneBuilder& b) {
                Material m;
                m.model = model;
                m.eta = dvec3(ior);
                m.ggx_alpha = 0.2;
                b.sphere("glass", dvec3(0), 1, b.material(m));
                b.environment({.radiance = dvec3(1)});
                b.camera("camera", 30, {0, 0, 5}, dvec3(0));
            });
            const Film film = render(scene, {.spp = 8, .max_depth = 64, .russian_roulette = false}, {16, 16});
            for (const vec3& pixel : film.mean) EXPECT_NEAR(pixel.x, 1, 1e-6) << ior;
        }
}

TEST(ReferencePath, M4_the_same_bits_for_any_number_of_threads)
{
    const Scene scene = make_builtin("cornell");
    const Film one = render(scene, {.spp = 3, .aovs = true, .threads = 1}, {40, 40});
    for (const unsigned threads : {2u, 3u, 7u}) {
        const Film other = render(scene, {.spp = 3, .aovs = true, .threads = threads}, {40, 40});
        EXPECT_EQ(one.mean, other.mean);
        EXPECT_EQ(one.variance, other.variance);
        EXPECT_EQ(one.aovs.normal, other.aovs.normal);
        EXPECT_EQ(one.truncated, other.truncated);
    }
    EXPECT_NE(one.mean, render(scene, {.spp = 3, .seed = 1}, {40, 40}).mean);
}

TEST(ReferencePath, a_stopped_picture_keeps_whole_passes_and_equals_a_shorter_one)
{
    const Scene scene = make_builtin("cornell");
    std::atomic<bool> stop = false;
    const Progress progress([&](const ProgressUpdate& update) { stop = stop || update.samples.value_or(0) >= 3; },
                            &stop);
    const Film stopped = render(scene, {.spp = 1000000, .threads = 2}, {24, 24}, progress);
    EXPECT_GE(stopped.samples, 3u);
    EXPECT_LT(stopped.samples, 1000u);
    const Film whole = render(scene, {.spp = stopped.samples}, {24, 24});
    EXPECT_EQ(stopped.mean, whole.mean);
    EXPECT_EQ(stopped.variance, whole.variance);
}

TEST(ReferencePath, goes_on_from_its_state_to_the_same_bits)
{
    const Scene scene = make_builtin("cornell");
    const PosedScene posed = pose(scene, {.size = ivec2(12, 9)});
    RenderSettings settings;
    settings.renderer = Renderer::reference;
    settings.spp = 11;
    const Film once = render_path(posed, require(posed, settings), settings, {});
    FilmState state;
    const auto keep = [&](const FilmState& s) { state = s; };
    settings.spp = 4;
    render_path(posed, require(posed, settings), settings, {}, {.keep = keep});
    EXPECT_EQ(state.samples, 4u);
    settings.spp = 11;
    const FilmState from = state;
    const Film resumed = render_path(posed, require(posed, settings), settings, {}, {.from = &from, .keep = keep});
    EXPECT_EQ(once.mean, resumed.mean);
    EXPECT_EQ(once.variance, resumed.variance);
    EXPECT_EQ(once.truncated, resumed.truncated);
    EXPECT_EQ(state.samples, 11u);
    const PosedScene other = pose(scene, {.size = ivec2(12, 8)});
    EXPECT_THROW(render_path(other, require(other, settings), settings, {}, {.from = &from}), Error);
}

TEST(ReferencePath, shards_have_the_bits_of_their_rows)
{
    const Scene scene = make_builtin("cornell");
    RenderSettings settings;
    settings.spp = 3;
    settings.aovs = true;
    const Film whole = render(scene, settings, ivec2(20, 37));
    std::vector<vec3> mean, variance, normal;
    for (unsigned i = 1; i <= 5; ++i) {
        settings.shard = {.number = i, .count = 5};
        const Film part = render(scene, settings, ivec2(20, 37));
        mean.insert(mean.end(), part.mean.begin(), part.mean.end());
        variance.insert(variance.end(), part.variance.begin(), part.variance.end());
        normal.insert(normal.end(), part.aovs.normal.begin(), part.aovs.normal.end());
    }
    EXPECT_EQ(whole.mean, mean);
    EXPECT_EQ(whole.variance, variance);
    EXPECT_EQ(whole.aovs.normal, normal);
}

TEST(ReferencePath, a_stop_before_the_first_pass_still_gives_one_sample)
{
    const std::atomic<bool> stop = true;
    const Film film = render(make_builtin("cornell"), {.spp = 100}, {16, 16}, Progress({}, &stop));
    EXPECT_EQ(film.samples, 1u);
    EXPECT_TRUE(film.variance.empty());
}

TEST(ReferencePath, progress_tells_samples_fraction_and_error_from_the_second_sample_on)
{
    double last_fraction = 0;
    std::uint64_t last_samples = 0;
    const Progress progress(
        [&](const ProgressUpdate& update) {
            if (!update.samples) return;
            EXPECT_GT(*update.samples, last_samples);
            last_samples = *update.samples;
            last_fraction = update.fraction;
            EXPECT_EQ(update.error.has_value(), *update.samples > 1);
        },
        nullptr);
    render(make_builtin("cornell"), {.spp = 5}, {16, 16}, progress);
    EXPECT_EQ(last_samples, 5u);
    EXPECT_EQ(last_fraction, 1);
}

TEST(ReferencePath, no_samples_are_refused)
{
    EXPECT_THROW(render(make_builtin("cornell"), {.spp = 0}, {8, 8}), Error);
}

TEST(ReferencePath, SH_23_the_background_is_what_was_asked_for)
{
    const Scene scene = built([](SceneBuilder& b) {
        b.sphere("ball", dvec3(0), 1, b.lambert("grey", dvec3(0.5)));
        b.environment({.radiance = dvec3(3)});
        b.camera("camera", 60, {0, 0, 4}, dvec3(0));
    });
    const Film seen = render(scene, {.background = Background::environment, .spp = 2}, {16, 16});
    EXPECT_EQ(at(seen, 0, 0), vec3(3));
    EXPECT_EQ(seen.alpha[0], 1);
    const Film clear = render(scene, {.background = Background::transparent, .spp = 2}, {16, 16});
    EXPECT_EQ(at(clear, 0, 0), vec3(0));
    EXPECT_EQ(clear.alpha[0], 0);
    EXPECT_EQ(clear.alpha[8 * 16 + 8], 1);
    EXPECT_EQ(at(clear, 8, 8), vec3(1.5));  // still lit by it
    const Film blue =
        render(scene, {.background = Background::colour, .background_color = {0, 0, 1}, .spp = 2}, {16, 16});
    EXPECT_EQ(at(blue, 0, 0), vec3(0, 0, 1));
    EXPECT_EQ(blue.alpha[0], 1);
}

Material glTF_material(dvec4 color)
{
    Material m;
    m.base_color = color;
    m.model = BsdfModel::unlit;
    return m;
}

TEST(ReferencePath, SH_6_backs_and_masked_parts_are_passed_and_exact_backs_are_black)
{
    const auto picture = [](const std::function<void(SceneBuilder&, Primitive)>& place, bool towards) {
        return built([&](SceneBuilder& b) {
            place(b, make_rectangle(dvec3(0), towards ? dvec3(2, 0, 0) : dvec3(-2, 0, 0), {0, 2, 0}));
            b.environment({.radiance = dvec3(5)});
            b.camera("camera", 20, {0, 0, 4}, dvec3(0));
        });
    };
    const auto color = [](const Scene& scene) { return at(render(scene, {.spp = 4, .max_depth = 2}, {4, 4}), 2, 2); };
    const auto with = [](Material m) {
        return [m](SceneBuilder& b, const Primitive& p) { b.show("pane", p, b.material(m)); };
    };
    Material unlit = glTF_material({1, 0.5, 0.25, 1});
    EXPECT_EQ(color(picture(with(unlit), true)), vec3(1, 0.5, 0.25));
    EXPECT_EQ(color(picture(with(unlit), false)), vec3(5));  // culled
    unlit.double_sided = true;
    EXPECT_EQ(color(picture(with(unlit), false)), vec3(1, 0.5, 0.25));
    unlit.alpha_mode = AlphaMode::mask;
    unlit.base_color.w = 0.49;
    EXPECT_EQ(color(picture(with(unlit), true)), vec3(5));
    unlit.base_color.w = 0.5;  // not below the cutoff
    EXPECT_EQ(color(picture(with(unlit), true)), vec3(1, 0.5, 0.25));
    Material exact;
    exact.model = BsdfModel::lambert;
    EXPECT_EQ(color(picture(with(exact), false)), vec3(0));
    EXPECT_EQ(color(picture(with(exact), true)), vec3(5));
}

TEST(ReferencePath, AOVs_tell_what_the_pixels_centre_meets)
{
    const Scene scene = built([](SceneBuilder& b) {
        Material m = glTF_material({0.25, 0.5, 0.75, 1});
        m.model = BsdfModel::metallic_roughness;
        m.emission = {1, 2, 3};
        b.show("wall", make_rectangle({0, 0, -3}, {1, 0, 0}, {0, 1, 0}), b.material(m));
        b.sphere("ball", {0, 0, 2}, 0.1, b.lambert("grey", dvec3(0.5)));
        b.environment({.radiance = dvec3(1)});
        b.camera("camera", 60, {0, 0, 4}, dvec3(0));
    });
    const Film film = render(scene, {.spp = 1, .aovs = true}, {33, 33});
    const auto pixel = [](int x, int y) { return std::size_t(y) * 33 + std::size_t(x); };
    EXPECT_EQ(film.aovs.object_id[pixel(16, 16)], 2u);  // draws first, then spheres
    EXPECT_NEAR(film.aovs.depth[pixel(16, 16)], 1.9, 1e-6);
    EXPECT_NEAR(film.aovs.normal[pixel(16, 16)].z, 1, 1e-6);
    EXPECT_EQ(film.aovs.object_id[pixel(18, 18)], 1u);
    EXPECT_NEAR(film.aovs.depth[pixel(18, 18)], 7, 1e-6);  // along the axis, not along the ray
    EXPECT_EQ(film.aovs.albedo[pixel(18, 18)], vec3(0.25, 0.5, 0.75));
    EXPECT_EQ(film.aovs.emission[pixel(18, 18)], vec3(1, 2, 3));
    EXPECT_EQ(film.aovs.material_id[pixel(18, 18)], 1u);
    EXPECT_EQ(film.aovs.object_id[pixel(0, 0)], 0u);
    EXPECT_TRUE(std::isinf(film.aovs.depth[pixel(0, 0)]));
    const double u = 0.5 + 7 * std::tan(kPi / 6) * (2 * 18.5 / 33 - 1) / 2;  // rectangle of width 2 about the axis
    EXPECT_NEAR(film.aovs.uv[pixel(18, 18)].x, u, 1e-5);
    EXPECT_NEAR(film.aovs.uv[pixel(18, 18)].y, u, 1e-5);  // v grows downwards
}

TEST(ReferencePath, M13_samples_that_are_not_finite_are_counted_and_left_out)
{
    const Scene scene = built([](SceneBuilder& b) {
        b.environment({.radiance = {std::numeric_limits<double>::infinity(), 1, 1}});
        b.sphere("ball", dvec3(0), 1, b.lambert("black", dvec3(0)));
        b.camera("camera", 60, {0, 0, 4}, dvec3(0));
    });
    const Film film = render(scene, {.spp = 3}, {8, 8});
    // The ball, 1.8 pixels in radius, fills the innermost 4 pixels and reaches none beyond the innermost 16.
    EXPECT_GE(film.nonfinite, 3u * (64 - 16));
    EXPECT_LE(film.nonfinite, 3u * (64 - 4));
    EXPECT_EQ(at(film, 0, 0), vec3(0));
}

TEST(ReferencePath, R1_scaling_the_scene_by_a_power_of_two_changes_no_bit)
{
    const auto scaled = [](double s) {
        return built([&](SceneBuilder& b) {
            b.show("floor", make_rectangle(dvec3(0), {0, 0, 4 * s}, {4 * s, 0, 0}), b.lambert("white", dvec3(0.8)));
            b.show("box", make_box({0.3 * s, 0.5 * s, 0}, dvec3(0.5 * s)),
                   b.metallic_roughness("gold", {1, 0.8, 0.3}, 1, 0.4));
            Material glow;
            glow.emission = dvec3(4);
            glow.model = BsdfModel::lambert;
            b.show("light", make_rectangle({0, 3 * s, 0}, {s, 0, 0}, {0, 0, s}), b.material(glow));
            b.light({.type = LightType::point, .intensity = 3 * s * s}, translation({s, 2 * s, s}));
            b.camera("camera", 45, {0, 2 * s, 5 * s}, {0, 0.5 * s, 0});
        });
    };
    const RenderSettings settings{.spp = 4, .max_depth = 4};
    const Film one = render(scaled(1), settings, {16, 16});
    EXPECT_EQ(one.mean, render(scaled(0x1p-20), settings, {16, 16}).mean);
    EXPECT_EQ(one.mean, render(scaled(0x1p20), settings, {16, 16}).mean);
}

}  // namespace
}  // namespace etalon::reference
