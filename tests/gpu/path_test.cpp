// The path tracer as a whole: the same bits whatever the order of work, stops, AOVs, odd sizes, refusals.
#include "engine/render/path.h"

#include <atomic>

#include "engine/base/error.h"
#include "tests/gpu/path_picture.h"

namespace etalon::test {
namespace {

TEST_F(PathPicture, M8_russian_roulette_does_not_change_the_mean)
{
    RenderSettings with = settings(128), without = settings(128);
    without.russian_roulette = false;
    with.seed = 1;
    const Scene scene = make_builtin("cornell");
    expect_equal(measure(render(scene, with, ivec2(32))), measure(render(scene, without, ivec2(32))), "roulette");
}

TEST_F(PathPicture, R20_another_seed_gives_other_samples_of_the_same_mean)
{
    RenderSettings a = settings(64), b = settings(64);
    b.seed = std::uint64_t{1} << 40;  // beyond 32 bits
    const Scene scene = make_builtin("spheres");
    const Film first = render(scene, a, ivec2(32)), second = render(scene, b, ivec2(32));
    EXPECT_FALSE(same_film(first, second));
    expect_equal(measure(first), measure(second), "seed");
}

TEST_F(PathPicture, R17_reading_early_other_passes_and_another_view_in_between_change_no_bit)
{
    const Scene scene = make_builtin("cornell");
    PoseSettings pose_settings;
    pose_settings.size = ivec2(21, 13);
    const PosedScene posed = pose(scene, pose_settings);
    const RenderSettings how = settings(300);  // more than a block
    const Film once = render_path(device(), posed, require(posed, how), how, {});
    EXPECT_EQ(once.samples, 300u);

    PathTracer tracer(device(), posed, require(posed, how), how);
    while (tracer.samples() < 7) tracer.step(7);
    tracer.film();
    View other = posed.view;
    other.width = 40;
    tracer.start(other);
    tracer.step(5);
    tracer.start(posed.view);
    for (const std::uint64_t stop : {1u, 50u, 256u, 300u}) {
        while (tracer.samples() < stop) tracer.step(stop);
        EXPECT_EQ(tracer.film().samples, stop);
    }
    EXPECT_TRUE(same_film(once, tracer.film()));
}

TEST_F(PathPicture, R17_a_film_goes_on_from_its_state_in_another_tracer_to_the_same_bits)
{
    const Scene scene = make_builtin("cornell");
    PoseSettings pose_settings;
    pose_settings.size = ivec2(21, 13);
    const PosedScene posed = pose(scene, pose_settings);
    const RenderSettings how = settings(300);
    const Film once = render_path(device(), posed, require(posed, how), how, {});
    FilmState last;
    for (const std::uint64_t stop : {3u, 256u, 270u, 300u}) {  // within a block, at its end, in the next
        RenderSettings part = how;
        part.spp = stop;
        const FilmState from = last;
        const Checkpoints checkpoints{.from = from.samples > 0 ? &from : nullptr,
                                      .keep = [&](const FilmState& state) { last = state; },
                                      .seconds = 0};
        const Film film = render_path(device(), posed, require(posed, part), part, {}, checkpoints);
        EXPECT_EQ(last.samples, stop);
        EXPECT_EQ(same_film(once, film), stop == 300);
    }
    PoseSettings larger;
    larger.size = ivec2(22, 13);
    const PosedScene other = pose(scene, larger);
    EXPECT_THROW(render_path(device(), other, require(other, how), how, {}, {.from = &last}), Error);
    RenderSettings fewer = how;
    fewer.spp = 299;
    EXPECT_THROW(render_path(device(), posed, require(posed, fewer), fewer, {}, {.from = &last}), Error);
}

TEST_F(PathPicture, R17_shards_have_the_bits_of_their_rows)
{
    const Scene scene = make_builtin("cornell");
    RenderSettings how = settings(5);
    how.aovs = true;
    const ivec2 size(21, 23);
    const Film whole = render(scene, how, size);
    Film together;
    for (how.shard = {.number = 1, .count = 3}; how.shard.number <= 3; ++how.shard.number) {
        const Film part = render(scene, how, size);
        EXPECT_EQ(part.height, how.shard.end_row(23) - how.shard.first_row(23));
        together.mean.insert(together.mean.end(), part.mean.begin(), part.mean.end());
        together.variance.insert(together.variance.end(), part.variance.begin(), part.variance.end());
        together.alpha.insert(together.alpha.end(), part.alpha.begin(), part.alpha.end());
        together.aovs.depth.insert(together.aovs.depth.end(), part.aovs.depth.begin(), part.aovs.depth.end());
    }
    EXPECT_TRUE(same_film(whole, together));
    EXPECT_EQ(whole.aovs.depth, together.aovs.depth);
    how.shard = {.number = 1, .count = 24};
    EXPECT_THROW(render(scene, how, size), Error);
}

TEST_F(PathPicture, R1_scaling_the_world_by_a_power_of_two_changes_no_bit)
{
    const auto room = [](double s) {
        SceneBuilder b("room");
        b.show("floor", make_rectangle(dvec3(0), s * dvec3(4, 0, 0), s * dvec3(0, 0, -4)),
               b.lambert("white", dvec3(0.7)));
        b.show("box", make_box(s * dvec3(0.3, 0.6, 0), s * dvec3(0.5)),
               b.metallic_roughness("gold", dvec3(1, 0.8, 0.3), 1, 0.3));
        Material m;
        m.model = BsdfModel::lambert;
        m.emission = dvec3(8);
        b.sphere("lamp", s * dvec3(-1, 2, 1), s * 0.25, b.material(m));
        b.camera("eye", 40, s * dvec3(2, 2, 4), s * dvec3(0, 0.5, 0));
        b.environment(constant_sky(0.25));
        return std::move(b).finish();
    };
    const Film film = render(room(1), settings(16), ivec2(24));
    EXPECT_GT(measure(film).mean.x, 0.1);
    for (const int exponent : {-20, -10, 13, 40}) {
        const Film scaled = render(room(std::ldexp(1, exponent)), settings(16), ivec2(24));
        EXPECT_TRUE(same_film(film, scaled)) << "2^" << exponent;
    }
}

TEST_F(PathPicture, a_stop_keeps_the_passes_that_are_done)
{
    const Scene scene = make_builtin("cornell");
    PoseSettings pose_settings;
    pose_settings.size = ivec2(64);
    const PosedScene posed = pose(scene, pose_settings);
    const RenderSettings how = settings(1u << 30);
    std::atomic<bool> stop = false;
    const Progress progress(
        [&](const ProgressUpdate& update) {
            if (update.samples.value_or(0) >= 16) stop = true;
        },
        &stop);
    const Film film = render_path(device(), posed, require(posed, how), how, progress);
    EXPECT_GE(film.samples, 16u);
    EXPECT_LT(film.samples, 64u);
    EXPECT_GT(measure(film).mean.x, 0);
    // Stopped before it began: one pass all the same.
    EXPECT_GE(render_path(device(), posed, require(posed, how), how, progress).samples, 1u);
}

TEST_F(PathPicture, a_stop_in_the_first_pass_keeps_the_pixels_that_have_a_sample)
{
    SceneBuilder sky("sky");
    sky.environment(constant_sky(2));
    const Scene scene = std::move(sky).finish();
    PoseSettings pose_settings;
    pose_settings.size = ivec2(701, 333);
    const PosedScene posed = pose(scene, pose_settings);
    const RenderSettings how = settings(8);
    PathTracer tracer(device(), posed, require(posed, how), how);
    ASSERT_FALSE(tracer.step(8)) << "more pixels than a step";
    const double reached = tracer.pass_fraction();
    tracer.stop_pass();
    const Film film = tracer.film();
    EXPECT_EQ(film.samples, 1u);
    EXPECT_TRUE(film.variance.empty());
    std::size_t lit = 0;
    for (std::size_t i = 0; i < film.mean.size(); ++i) {
        EXPECT_EQ(film.mean[i], vec3(2 * film.alpha[i])) << i;
        lit += film.alpha[i] == 1;
    }
    EXPECT_NEAR(double(lit), reached * double(film.mean.size()), 0.5);
    EXPECT_EQ(film.metadata.at("pixels.unreached"), std::to_string(film.mean.size() - lit));
    tracer.start(posed.view);
    while (tracer.samples() < 8) tracer.step(8);
    EXPECT_TRUE(same_film(tracer.film(), render_path(device(), posed, require(posed, how), how, {})));
}

TEST_F(PathPicture, aovs_say_what_the_centre_of_each_pixel_sees)
{
    SceneBuilder b("aovs");
    Material m;
    m.model = BsdfModel::lambert;
    m.base_color = dvec4(0.25, 0.5, 0.75, 1);
    m.emission = dvec3(2);
    b.show("card", make_rectangle(dvec3(-5, 0, 0), dvec3(5, 0, 0), dvec3(0, 5, 0)), b.material(m));
    b.sphere("ball", dvec3(0.6, 0, 0), 0.5, half_grey(b));
    b.camera("eye", 20, dvec3(0, 0, 5), dvec3(0));
    RenderSettings how = settings(1);
    how.aovs = true;
    const Film film = render(std::move(b).finish(), how, ivec2(17));
    const Aovs& a = film.aovs;
    const std::size_t left = 8 * 17 + 2, ball = 8 * 17 + 14, miss = 16;
    EXPECT_FLOAT_EQ(a.depth[left], 5);
    EXPECT_EQ(a.normal[left], vec3(0, 0, 1));
    EXPECT_EQ(a.albedo[left], vec3(0.25f, 0.5f, 0.75f));
    EXPECT_EQ(a.emission[left], vec3(2));
    EXPECT_EQ(a.object_id[left], 1u);
    EXPECT_EQ(a.object_id[ball], 2u);
    EXPECT_EQ(a.material_id[ball], 2u);
    EXPECT_NEAR(length(a.normal[ball]), 1, 1e-6);
    EXPECT_LT(a.depth[ball], 5);
    EXPECT_TRUE(std::isinf(a.depth[miss]));
    EXPECT_EQ(a.object_id[miss], 0u);
    EXPECT_EQ(a.albedo[miss], vec3(0));
}

TEST_F(PathPicture, every_kind_of_traversal_gives_the_same_bits)
{
    // Shells within shells: rays cross hundreds of boxes, and the stack in registers is too small for some.
    SceneBuilder b("shells");
    Material m;
    m.double_sided = true;
    m.base_color = dvec4(0.8, 0.8, 0.8, 0.1);
    m.alpha_mode = AlphaMode::blend;
    Primitive shells = make_sphere(dvec3(0), 1, 60, 30);
    for (int i = 1; i < 12; ++i) shells = joined(shells, make_sphere(dvec3(0.01 * i, 0, 0), 1 + 0.003 * i, 60, 30));
    b.show("shells", shells, b.material(m));
    b.sphere("ball", dvec3(0), 0.4, b.lambert("red", dvec3(0.8, 0.1, 0.1)));
    b.camera("eye", 40, dvec3(0, 0.3, 4), dvec3(0));
    b.light(Light{}, translation(dvec3(2, 3, 4)));
    b.environment(constant_sky(0.5));
    const Scene scene = std::move(b).finish();
    PoseSettings pose_settings;
    pose_settings.size = ivec2(48);
    const PosedScene posed = pose(scene, pose_settings);
    RenderSettings how = settings(4);
    how.aovs = true;
    PathTracer fitting(device(), posed, require(posed, how), how);
    PathTracer exact(device(), posed, require(posed, how), how, {}, Traversal::exact);
    for (PathTracer* tracer : {&fitting, &exact})
        while (tracer->samples() < how.spp) tracer->step(how.spp);
    const Film a = fitting.film(), e = exact.film();
    EXPECT_TRUE(same_film(a, e));
    EXPECT_EQ(a.aovs.object_id, e.aovs.object_id);
    EXPECT_EQ(a.nonfinite, 0u);
    EXPECT_GT(measure(a).mean.x, 0.05);
}

/// By whole paths in one kernel where the device is one for that, through queues, and as on GPUs.
void expect_the_same_bits(gpu::Device& device, const Scene& scene, const RenderSettings& how, const char* name)
{
    PoseSettings pose_settings;
    pose_settings.size = ivec2(33, 21);
    const PosedScene posed = pose(scene, pose_settings);
    const auto draw = [&](Traversal traversal) {
        PathTracer tracer(device, posed, require(posed, how), how, {}, traversal);
        while (tracer.samples() < how.spp) tracer.step(how.spp);
        return tracer.film();
    };
    const Film fitting = draw(Traversal::by_device);
    EXPECT_GT(measure(fitting).mean.x, 0.001) << name;
    EXPECT_TRUE(same_film(fitting, draw(Traversal::queues))) << name;
    EXPECT_TRUE(same_film(fitting, draw(Traversal::exact))) << name;
}

TEST_F(PathPicture, whole_paths_in_one_kernel_have_the_bits_of_those_through_queues)
{
    for (const char* name : {"cornell", "glass", "lights", "thin-lens"})
        expect_the_same_bits(device(), make_builtin(name), settings(5), name);
}

TEST_F(PathPicture, paths_longer_than_a_lane_may_step_are_followed_to_their_ends)
{
    // Too many steps for all paths that a lane would take: the rest is left to the queues.
    SceneBuilder b("mirrors");
    Material mirror;
    mirror.model = BsdfModel::mirror;
    mirror.base_color = dvec4(0.999, 0.999, 0.999, 1);
    mirror.double_sided = true;
    b.show("room", make_box(dvec3(0), dvec3(4)), b.material(mirror));
    Material lamp;
    lamp.model = BsdfModel::lambert;
    lamp.base_color = dvec4(0, 0, 0, 1);
    lamp.emission = dvec3(1);
    b.sphere("lamp", dvec3(1, 1, 1), 0.05, b.material(lamp));
    b.camera("eye", 60, dvec3(-1, -0.5, 0.3), dvec3(1, 0.2, 0));
    RenderSettings how = settings(3);
    how.max_depth = 300;
    how.russian_roulette = false;
    const Scene scene = std::move(b).finish();
    expect_the_same_bits(device(), scene, how, "mirrors");
    PoseSettings pose_settings;
    pose_settings.size = ivec2(33, 21);
    const PosedScene posed = pose(scene, pose_settings);
    PathTracer tracer(device(), posed, require(posed, how), how);
    tracer.measure_kernels(true);
    while (tracer.samples() < how.spp) tracer.step(how.spp);
    const auto is_shade = [](const KernelTime& kernel) { return kernel.name == "shade"; };
    const std::vector<KernelTime>& times = tracer.kernel_times();
    EXPECT_TRUE(std::any_of(times.begin(), times.end(), is_shade)) << "nothing was left to the queues";
}

TEST_F(PathPicture, R29_requirements_too_many_change_no_bit)
{
    for (const char* name : {"cornell", "maps"}) {
        const Scene scene = make_builtin(name);
        PoseSettings pose_settings;
        pose_settings.size = ivec2(24);
        const PosedScene posed = pose(scene, pose_settings);
        Requirements required = require(posed, settings(4));
        const Film needed = render_path(device(), posed, required, settings(4), {});
        required.bits.set();
        EXPECT_TRUE(same_film(needed, render_path(device(), posed, required, settings(4), {}))) << name;
    }
}

TEST_F(PathPicture, R29_requirements_too_many_change_layers_by_rounding_alone)
{
    // The driver rounds a longer kernel otherwise: not the same bits, but the same mean.
    for (const char* name : {"clearcoat", "sheen", "volume", "specular-glossiness"}) {
        const Scene scene = make_builtin(name);
        PoseSettings pose_settings;
        pose_settings.size = ivec2(24);
        const PosedScene posed = pose(scene, pose_settings);
        Requirements required = require(posed, settings(16));
        const Film needed = render_path(device(), posed, required, settings(16), {});
        required.bits.set();
        expect_equal(measure(needed), measure(render_path(device(), posed, required, settings(16), {})), name);
    }
}

TEST_F(PathPicture, R29_each_layer_shows_where_it_is_required)
{
    const std::pair<const char*, Feature> rows[] = {
        {"specular", Feature::specular},         {"specular", Feature::layer_textures},
        {"clearcoat", Feature::clearcoat},       {"sheen", Feature::sheen},
        {"transmission", Feature::transmission}, {"volume", Feature::volume},
        {"iridescence", Feature::iridescence},   {"anisotropy", Feature::anisotropy},
        {"dispersion", Feature::dispersion},     {"diffuse-transmission", Feature::diffuse_transmission}};
    for (const auto& [name, feature] : rows) {
        const Scene scene = make_builtin(name);
        PoseSettings pose_settings;
        pose_settings.size = ivec2(24, 12);
        const PosedScene posed = pose(scene, pose_settings);
        Requirements required = require(posed, settings(2));
        ASSERT_TRUE(required.has(feature)) << name;
        const Film with = render_path(device(), posed, required, settings(2), {});
        EXPECT_EQ(with.nonfinite, 0u) << name;
        required.bits.reset(static_cast<std::size_t>(feature));
        EXPECT_FALSE(same_film(with, render_path(device(), posed, required, settings(2), {}))) << name;
    }
}

TEST_F(PathPicture, odd_pictures_and_empty_scenes_render)
{
    SceneBuilder empty("empty");
    empty.environment(constant_sky(3));
    const Scene scene = std::move(empty).finish();
    for (const ivec2 size : {ivec2(1, 1), ivec2(1, 37), ivec2(37, 1), ivec2(13, 9)}) {
        const Film film = render(scene, settings(3), size);
        for (const vec3& pixel : film.mean) EXPECT_EQ(pixel, vec3(3));
    }
}

TEST_F(PathPicture, a_material_whose_model_is_not_required_is_refused)
{
    SceneBuilder b = above_floor(half_grey);
    const Scene scene = std::move(b).finish();
    const PosedScene posed = pose(scene, {});
    Requirements required = require(posed, settings());
    required.bits.reset(static_cast<std::size_t>(Feature::lambert));
    EXPECT_THROW(render_path(device(), posed, required, settings(), {}), Error);
}

}  // namespace
}  // namespace etalon::test
