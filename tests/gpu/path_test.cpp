// Whole pictures of the path tracer against arithmetic. Statistical comparisons use fixed seeds and five standard
// errors: a false alarm in two million.
#include "engine/render/path.h"

#include <atomic>
#include <cmath>
#include <cstring>

#include "engine/base/error.h"
#include "engine/render/render.h"
#include "engine/scene/builder.h"
#include "engine/scene/load.h"
#include "tests/gpu/device_test.h"

namespace etalon::test {
namespace {

struct Measured {
    dvec3 mean{0};
    dvec3 error{0};  ///< standard error of the mean
};

/// Of the whole picture, or of the pixels where choose(x, y).
template <class Choose>
Measured measure(const Film& film, const Choose& choose)
{
    Measured out;
    dvec3 variance(0);
    double count = 0;
    for (int y = 0; y < film.height; ++y)
        for (int x = 0; x < film.width; ++x) {
            if (!choose(x, y)) continue;
            const auto i = std::size_t(y) * std::size_t(film.width) + std::size_t(x);
            out.mean += dvec3(film.mean[i]);
            if (!film.variance.empty()) variance += dvec3(film.variance[i]);
            ++count;
        }
    out.mean /= count;
    out.error = glm::sqrt(variance) / count;
    return out;
}
Measured measure(const Film& film)
{
    return measure(film, [](int, int) { return true; });
}

void expect_equal(const Measured& a, const Measured& b, const char* why)
{
    for (int c = 0; c < 3; ++c)
        EXPECT_NEAR(a.mean[c], b.mean[c], 5 * std::hypot(a.error[c], b.error[c]) + 2e-6 * b.mean[c])
            << why << ", channel " << c;
}

bool same_film(const Film& a, const Film& b)
{
    return a.mean.size() == b.mean.size() &&
           std::memcmp(a.mean.data(), b.mean.data(), a.mean.size() * sizeof(vec3)) == 0 &&
           a.variance.size() == b.variance.size() &&
           std::memcmp(a.variance.data(), b.variance.data(), a.variance.size() * sizeof(vec3)) == 0 &&
           a.alpha == b.alpha;
}

class PathPicture : public DeviceTest {
 protected:
    RenderSettings settings(std::uint64_t spp = 64)
    {
        RenderSettings out;
        out.renderer = Renderer::path;
        out.spp = spp;
        return out;
    }
    Film render(const Scene& scene, const RenderSettings& how, ivec2 size = ivec2(16))
    {
        PoseSettings pose_settings;
        pose_settings.size = size;
        const PosedScene posed = pose(scene, pose_settings);
        return render_path(device(), posed, require(posed, how), how, {});
    }
};

Environment constant_sky(double radiance)
{
    Environment out;
    out.radiance = dvec3(radiance);
    return out;
}

/// A floor of 20 m at y = 0, seen from straight enough above that nothing else is in the picture.
SceneBuilder above_floor(Index (*material)(SceneBuilder&), double scale = 1)
{
    SceneBuilder b("floor");
    b.show("floor", make_rectangle(dvec3(0), scale * dvec3(10, 0, 0), scale * dvec3(0, 0, -10)), material(b));
    b.camera("above", 20, scale * dvec3(0, 5, 2), dvec3(0));
    return b;
}
Index half_grey(SceneBuilder& b)
{
    return b.lambert("grey", dvec3(0.5));
}

TEST_F(PathPicture, R22_a_lambert_sphere_in_a_white_furnace_has_its_albedo)
{
    SceneBuilder b("furnace");
    b.sphere("ball", dvec3(0), 1, b.lambert("grey", dvec3(0.5, 0.8, 1)));
    b.camera("eye", 10, dvec3(0, 0, 5), dvec3(0));
    b.environment(constant_sky(1));
    const Film film = render(std::move(b).finish(), settings(32));
    for (const vec3& pixel : film.mean) {
        EXPECT_NEAR(pixel.x, 0.5, 1e-5);
        EXPECT_NEAR(pixel.y, 0.8, 1e-5);
        EXPECT_NEAR(pixel.z, 1, 1e-5);
    }
}

TEST_F(PathPicture, SH20_depth_counts_segments_from_camera_to_light)
{
    SceneBuilder b("glowing floor in a furnace");
    Material m;
    m.model = BsdfModel::lambert;
    m.base_color = dvec4(0.5);
    m.emission = dvec3(3);
    b.show("floor", make_rectangle(dvec3(0), dvec3(10, 0, 0), dvec3(0, 0, -10)), b.material(m));
    b.camera("above", 20, dvec3(0, 5, 2), dvec3(0));
    b.environment(constant_sky(1));
    const Scene scene = std::move(b).finish();
    for (const bool roulette : {false, true}) {
        RenderSettings how = settings(16);
        how.russian_roulette = roulette;
        how.max_depth = 1;
        const Film emission_alone = render(scene, how);
        EXPECT_NEAR(measure(emission_alone).mean.x, 3, 1e-5);
        EXPECT_EQ(emission_alone.truncated, 16u * 256u) << "every path could have gone on";
        for (const int depth : {2, 5}) {
            how.max_depth = depth;
            const Film film = render(scene, how);
            EXPECT_NEAR(measure(film).mean.x, 3.5, 1e-5) << "one reflection of the sky, and no more: the floor is flat";
            EXPECT_EQ(film.truncated, 0u);
        }
    }
}

TEST_F(PathPicture, SH22_a_point_light_gives_albedo_over_pi_times_intensity_cosine_over_distance_squared)
{
    SceneBuilder b = above_floor(half_grey);
    Light light;
    light.intensity = 7;
    light.color = dvec3(1, 0.5, 0.25);
    b.light(light, translation(dvec3(0, 2, 0)));
    const Film film = render(std::move(b).finish(), settings(16), ivec2(1));
    // One pixel sees ± tan(10°) · 5.385 m about the origin; the mean over it by quadrature.
    double sum = 0;
    const double t = std::tan(kPi / 18);
    const dvec3 forward = normalize(dvec3(0, -5, -2)), right(1, 0, 0), up = cross(right, forward);
    for (int i = 0; i < 200; ++i)
        for (int j = 0; j < 200; ++j) {
            const dvec3 d = forward + (2 * (i + 0.5) / 200 - 1) * t * right + (2 * (j + 0.5) / 200 - 1) * t * up;
            const dvec3 p = dvec3(0, 5, 2) - 5 / d.y * d;
            const double distance = length(dvec3(0, 2, 0) - p);
            sum += 0.5 / kPi * 7 * (2 / distance) / (distance * distance) / 40000;
        }
    const Measured got = measure(film);
    EXPECT_NEAR(got.mean.x, sum, 5 * got.error.x);
    EXPECT_NEAR(got.mean.y / got.mean.x, 0.5, 1e-6);
    EXPECT_NEAR(got.mean.z / got.mean.x, 0.25, 1e-6);
    EXPECT_LT(got.error.x / sum, 0.1);
}

TEST_F(PathPicture, SH22_directional_spot_and_range)
{
    const auto lit = [&](const Light& light) {
        SceneBuilder b = above_floor(half_grey);
        b.light(light, translation(dvec3(0, 2, 0)) * rotation_x(-kPi / 2));
        return measure(render(std::move(b).finish(), settings(4), ivec2(16)),
                       [](int x, int y) { return x / 2 == 4 && y / 2 == 4; });
    };
    Light sun;
    sun.type = LightType::directional;
    sun.intensity = 3;
    EXPECT_NEAR(lit(sun).mean.x, 0.5 / kPi * 3, 1e-5);
    Light spot;
    spot.type = LightType::spot;
    spot.intensity = 4;
    spot.inner_cone = 0.3;
    spot.outer_cone = 0.6;
    EXPECT_NEAR(lit(spot).mean.x, 0.5 / kPi * 4 / 4, 0.01) << "inside the inner cone, 2 m below";
    Light near = spot;
    near.range = 2.5;
    EXPECT_NEAR(lit(near).mean.x, 0.5 / kPi * (1 - std::pow(0.8, 4)), 0.01);
    near.range = 1.9;
    EXPECT_EQ(lit(near).mean.x, 0);
}

TEST_F(PathPicture, S19_a_sphere_light_has_the_form_factor_of_its_cone)
{
    SceneBuilder b("sphere light");
    b.show("floor", make_rectangle(dvec3(0), dvec3(10, 0, 0), dvec3(0, 0, -10)), half_grey(b));
    Material m;
    m.model = BsdfModel::lambert;
    m.base_color = dvec4(0, 0, 0, 1);
    m.emission = dvec3(5);
    b.sphere("lamp", dvec3(0, 2, 0), 0.5, b.material(m));
    b.camera("low", 0.2, dvec3(0, 1, 4), dvec3(0));
    const Measured got = measure(render(std::move(b).finish(), settings(512), ivec2(8)));
    EXPECT_NEAR(got.mean.x, 0.5 * 5 * std::pow(0.5 / 2, 2), 5 * got.error.x + 2e-5);
    EXPECT_LT(got.error.x / got.mean.x, 0.01);
}

TEST_F(PathPicture, MC7_an_area_light_has_the_form_factor_of_a_rectangle)
{
    SceneBuilder b("area light");
    b.show("floor", make_rectangle(dvec3(0), dvec3(10, 0, 0), dvec3(0, 0, -10)), half_grey(b));
    Material m;
    m.model = BsdfModel::lambert;
    m.base_color = dvec4(0, 0, 0, 1);
    m.emission = dvec3(5);
    // One metre square, 1 m above, its front down.
    b.show("lamp", make_rectangle(dvec3(0, 1, 0), dvec3(0.5, 0, 0), dvec3(0, 0, 0.5)), b.material(m));
    b.camera("low", 0.2, dvec3(0, 0.5, 4), dvec3(0));
    const Measured got = measure(render(std::move(b).finish(), settings(512), ivec2(8)));
    // Four quarters of sides a = b = 0.5 at distance 1 over their corner.
    const double x = 0.5 / std::sqrt(1.25);
    const double factor = 4 / (2 * kPi) * 2 * x * std::atan(x);
    EXPECT_NEAR(got.mean.x, 0.5 * 5 * factor, 5 * got.error.x + 2e-5);
    EXPECT_LT(got.error.x / got.mean.x, 0.01);
}

TEST_F(PathPicture, S23_an_environment_map_gives_the_irradiance_of_its_integral)
{
    Environment sky;
    Image map(64, 32, 3);
    double irradiance = 0;
    for (int y = 0; y < 32; ++y)
        for (int x = 0; x < 64; ++x) {
            const float value = (x == 20 && y == 9 ? 300.f : 0.5f) + float(y) * 0.01f;
            for (int c = 0; c < 3; ++c) map.at(x, y, c) = value;
        }
    // The bilinear map, upper hemisphere, by a fine midpoint rule.
    const auto texel = [&](int x, int y) { return double(map.at((x + 64) % 64, std::clamp(y, 0, 31), 0)); };
    constexpr int kSide = 1024;
    for (int j = 0; j < kSide / 2; ++j)
        for (int i = 0; i < kSide * 2; ++i) {
            const double u = (i + 0.5) / (2 * kSide) * 64 - 0.5, v = (j + 0.5) / kSide * 32 - 0.5;
            const int x = int(std::floor(u)), y = int(std::floor(v));
            const double fx = u - x, fy = v - y, theta = kPi * (j + 0.5) / kSide;
            const double value = (1 - fy) * ((1 - fx) * texel(x, y) + fx * texel(x + 1, y)) +
                                 fy * ((1 - fx) * texel(x, y + 1) + fx * texel(x + 1, y + 1));
            irradiance += value * std::cos(theta) * std::sin(theta) * (kPi / kSide) * (kPi / kSide);
        }
    sky.map = std::make_shared<Image>(map);
    sky.rotation = 0.7;
    SceneBuilder b = above_floor(half_grey);
    b.environment(sky);
    const Measured got = measure(render(std::move(b).finish(), settings(256)));
    EXPECT_NEAR(got.mean.x, 0.5 / kPi * irradiance, 5 * got.error.x);
    EXPECT_LT(got.error.x / got.mean.x, 0.005) << "the sun is sampled, not hit by chance";
}

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

TEST_F(PathPicture, G23_a_closed_white_box_of_any_size_lets_no_light_in_or_out)
{
    for (const double scale : {1e-3, 1.0, 1e4}) {
        SceneBuilder b("box");
        // Seen from inside; its walls are single triangles' pairs, so rays leave next to coplanar neighbours.
        Material m;
        m.model = BsdfModel::lambert;
        m.base_color = dvec4(0.8);
        m.double_sided = true;
        b.show("box", make_box(dvec3(0), scale * dvec3(1)), b.material(m));
        b.camera("inside", 80, scale * dvec3(0.3, 0.2, 0.9), scale * dvec3(-0.5, -0.4, -1));
        b.environment(constant_sky(1e6));
        RenderSettings how = settings(64);
        how.max_depth = 16;
        const Film film = render(std::move(b).finish(), how, ivec2(32));
        EXPECT_EQ(measure(film).mean.x, 0) << "at scale " << scale;
        EXPECT_EQ(film.nonfinite, 0u);
    }
}

TEST_F(PathPicture, G23_a_uniformly_glowing_closed_box_has_the_radiance_of_its_series)
{
    // Emission e, albedo a, any shape: after n segments L = e (1 + a + … + a^(n-1)). A self-hit or a lost ray shows
    // here.
    for (const double scale : {1e-3, 1.0, 1e4}) {
        SceneBuilder b("glowing box");
        Material m;
        m.model = BsdfModel::lambert;
        m.base_color = dvec4(0.5);
        m.emission = dvec3(1);
        m.double_sided = true;
        b.show("box", make_box(dvec3(0), scale * dvec3(1)), b.material(m));
        b.camera("inside", 80, scale * dvec3(0.3, 0.2, 0.9), scale * dvec3(-0.5, -0.4, -1));
        RenderSettings how = settings(256);
        how.max_depth = 6;
        const Measured got = measure(render(std::move(b).finish(), how, ivec2(24)));
        EXPECT_NEAR(got.mean.x, 1.96875, 5 * got.error.x + 1e-5) << "at scale " << scale;
        EXPECT_LT(got.error.x, 2e-3);
    }
}

TEST_F(PathPicture, SH6_single_sided_backs_are_passed_masks_cut_and_blends_weigh)
{
    const auto seen = [&](const Material& m, bool turned) {
        SceneBuilder b("sheet");
        const Index material = b.material(m);
        b.show("sheet", make_rectangle(dvec3(0), dvec3(turned ? -9 : 9, 0, 0), dvec3(0, 9, 0)), material);
        Material wall;
        wall.model = BsdfModel::unlit;
        wall.base_color = dvec4(0.2, 0.2, 0.2, 1);
        b.show("wall", make_rectangle(dvec3(0, 0, -1), dvec3(9, 0, 0), dvec3(0, 9, 0)), b.material(wall));
        b.camera("eye", 20, dvec3(0, 0, 5), dvec3(0));
        return measure(render(std::move(b).finish(), settings(512), ivec2(8)));
    };
    Material sheet;
    sheet.model = BsdfModel::unlit;
    sheet.base_color = dvec4(1, 1, 1, 0.25);
    EXPECT_NEAR(seen(sheet, false).mean.x, 1, 1e-6) << "opaque";
    EXPECT_NEAR(seen(sheet, true).mean.x, 0.2, 1e-6) << "culled from behind";
    sheet.double_sided = true;
    EXPECT_NEAR(seen(sheet, true).mean.x, 1, 1e-6) << "double-sided from behind";
    sheet.alpha_mode = AlphaMode::mask;
    sheet.alpha_cutoff = 0.25;
    EXPECT_NEAR(seen(sheet, false).mean.x, 1, 1e-6) << "alpha at the cutoff is there";
    sheet.alpha_cutoff = 0.26;
    EXPECT_NEAR(seen(sheet, false).mean.x, 0.2, 1e-6) << "alpha below it is not";
    sheet.alpha_mode = AlphaMode::blend;
    const Measured mixed = seen(sheet, false);
    EXPECT_NEAR(mixed.mean.x, 0.25 + 0.75 * 0.2, 5 * mixed.error.x);
    EXPECT_LT(mixed.error.x, 0.01);
    Material exact;
    exact.model = BsdfModel::lambert;
    EXPECT_EQ(seen(exact, true).mean.x, 0) << "the back of an exact BSDF is black and opaque";
}

TEST_F(PathPicture, SH6_shadow_rays_see_what_camera_rays_see)
{
    const auto lit = [&](const Material& m, bool up = false) {
        SceneBuilder b = above_floor(half_grey);
        Light sun;
        sun.type = LightType::directional;
        sun.intensity = kPi;
        b.light(sun, rotation_x(-kPi / 2));
        // Above the eye; its front is towards the floor, where shadow rays come from.
        const dvec3 half_u(up ? 20 : -20, 0, 0);
        b.show("sheet", make_rectangle(dvec3(0, 7, 0), half_u, dvec3(0, 0, -20)), b.material(m));
        return measure(render(std::move(b).finish(), settings(512), ivec2(8)));
    };
    Material sheet;
    sheet.base_color = dvec4(0, 0, 0, 0.25);
    EXPECT_EQ(lit(sheet).mean.x, 0) << "opaque";
    EXPECT_NEAR(lit(sheet, true).mean.x, 0.5, 1e-5) << "the back of a single-sided sheet casts no shadow";
    sheet.alpha_mode = AlphaMode::blend;
    const Measured through = lit(sheet);
    // A blended sheet also reflects the floor's light back a little (F0 = 0.04 of black), under 1%.
    EXPECT_NEAR(through.mean.x, 0.5 * 0.75, 5 * through.error.x + 0.01);
    sheet.alpha_mode = AlphaMode::mask;
    EXPECT_NEAR(lit(sheet).mean.x, 0.5, 1e-5) << "cut out";
}

TEST_F(PathPicture, SH23_backgrounds)
{
    SceneBuilder b("half a picture");
    b.show("card", make_rectangle(dvec3(-5, 0, 0), dvec3(5, 0, 0), dvec3(0, 9, 0)), half_grey(b));
    b.camera("eye", 20, dvec3(0, 0, 5), dvec3(0));
    b.environment(constant_sky(2));
    const Scene scene = std::move(b).finish();
    RenderSettings how = settings(16);
    const Film sky = render(scene, how);
    EXPECT_NEAR(sky.mean[15].x, 2, 1e-6);
    EXPECT_EQ(sky.alpha[15], 1);
    how.background = Background::transparent;
    const Film clear = render(scene, how);
    EXPECT_EQ(clear.mean[15], vec3(0));
    EXPECT_EQ(clear.alpha[15], 0);
    EXPECT_EQ(clear.alpha[0], 1);
    EXPECT_NEAR(clear.mean[0].x, 1, 1e-5) << "still lit by the sky";
    how.background = Background::colour;
    how.background_color = dvec3(0.1, 0.2, 0.3);
    const Film blue = render(scene, how);
    EXPECT_EQ(blue.mean[15], vec3(0.1f, 0.2f, 0.3f));
    EXPECT_EQ(blue.alpha[15], 1);
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
