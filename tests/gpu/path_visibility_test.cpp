// What rays of the path tracer pass and what stops them.
#include "tests/gpu/path_picture.h"

namespace etalon::test {
namespace {

/// `side` × `side` squares of two triangles that share their corners, 2 `half` wide, normal +y.
Primitive fine_floor(double half, int side)
{
    Primitive out;
    for (int z = 0; z <= side; ++z)
        for (int x = 0; x <= side; ++x) {
            out.positions.push_back(vec3(dvec3(2.0 * x / side - 1, 0, 2.0 * z / side - 1) * half));
            out.normals.push_back(vec3(0, 1, 0));
        }
    const auto corner = [&](int x, int z) { return static_cast<std::uint32_t>(z * (side + 1) + x); };
    for (int z = 0; z < side; ++z)
        for (int x = 0; x < side; ++x)
            for (const std::uint32_t i : {corner(x, z), corner(x, z + 1), corner(x + 1, z), corner(x + 1, z),
                                          corner(x, z + 1), corner(x + 1, z + 1)})
                out.indices.push_back(i);
    return out;
}

TEST_F(PathPicture, G23_no_ray_meets_the_plane_that_it_leaves)
{
    // Coplanar triangles in no axis' plane, under a white sky: what meets them a second time carries no light.
    for (const double scale : {1e-3, 1.0, 1e4}) {
        SceneBuilder b("tilted floor");
        const dmat4 tilt = translation(scale * dvec3(100, -30, 7)) * rotation_x(0.3) * rotation_y(0.7);
        Material m;
        m.model = BsdfModel::lambert;
        m.base_color = dvec4(0.5);
        m.double_sided = true;  // a false hit is from below: it must scatter to be counted
        b.show("floor", fine_floor(20 * scale, 400), b.material(m), tilt);
        Camera camera;
        camera.yfov = 0.9;
        b.camera(camera, tilt * look_from(scale * dvec3(0, 1, 12), dvec3(0)));
        b.environment(constant_sky(1));
        RenderSettings how = settings(96);
        how.max_depth = 2;
        how.background = Background::transparent;
        const Film film = render(std::move(b).finish(), how, ivec2(64));
        EXPECT_EQ(film.truncated, 0u) << "rays that met the floor again, at scale " << scale;
        const Measured got = measure(film, [](int, int y) { return y > 48; });
        EXPECT_NEAR(got.mean.x, 0.5, 1e-5) << "at scale " << scale;
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

}  // namespace
}  // namespace etalon::test
