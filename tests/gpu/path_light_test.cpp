// How bright pictures of the path tracer are, against arithmetic.
#include "tests/gpu/path_picture.h"

namespace etalon::test {
namespace {

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

// Lamps of both kinds over a floor, some of them turned away, small and far from one another.
Scene many_lamps()
{
    SceneBuilder b("many lamps");
    b.show("floor", make_rectangle(dvec3(0), dvec3(12, 0, 0), dvec3(0, 0, -12)), b.lambert("grey", dvec3(0.5)));
    Material glow;
    glow.model = BsdfModel::lambert;
    glow.base_color = dvec4(0, 0, 0, 1);
    for (int i = 0; i < 40; ++i) {
        glow.emission = dvec3(20 + 10 * (i % 5), 30, 40);
        glow.double_sided = i % 3 == 0;
        const dvec3 at(-5 + i % 8 * 1.4, 0.5 + i % 3, -5 + i / 8 * 2.2);
        const dvec3 along(0.1, 0, 0), across(0, i % 4 == 0 ? 0.1 : 0, i % 2 == 0 ? 0.1 : -0.1);
        b.show("lamp", make_rectangle(at, along, across), b.material(glow));
        if (i % 10 == 0) b.sphere("bulb", at + dvec3(0.5, 0.2, 0), 0.05, b.material(glow));
    }
    b.camera("below them", 40, dvec3(0, 0.45, 3),
             dvec3(0, 0, 2.2));  // sees none itself: their edges are noise of another kind
    return std::move(b).finish();
}

TEST_F(PathPicture, MC9_lights_chosen_by_the_tree_give_the_same_picture_with_less_noise)
{
    const Scene scene = many_lamps();
    RenderSettings how = settings(256);
    how.light_selection = LightSelection::tree;
    const Film tree = render(scene, how);
    how.light_selection = LightSelection::power;
    how.seed = 1;
    const Film power = render(scene, how);
    expect_equal(measure(tree), measure(power), "whole picture");
    for (int quarter = 0; quarter < 4; ++quarter) {
        const auto inside = [&](int x, int y) {
            return (x < tree.width / 2) == (quarter % 2 == 0) && (y < tree.height / 2) == (quarter / 2 == 0);
        };
        expect_equal(measure(tree, inside), measure(power, inside), "a quarter");
    }
    EXPECT_LT(measure(tree).error.y, 0.7 * measure(power).error.y);
}

}  // namespace
}  // namespace etalon::test
