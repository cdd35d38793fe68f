// What is taken from materials because no picture shows it changes no bit of what rasterizers and references draw.
#include <cmath>

#include "engine/reference/reference.h"
#include "engine/scene/unseen.h"
#include "tests/gpu/raster_stage.h"
#include "tests/gpu/simplify_scene.h"

namespace etalon::test {
namespace {

class RasterSimplify : public DeviceTest {};

constexpr ivec2 kSize(54, 36);

vec3 middle_of(const Film& film)
{
    return film.mean[std::size_t(film.height / 2 * film.width + film.width / 2)];
}

TEST_F(RasterSimplify, changes_no_bit)
{
    const SimplifiableScene wall = simplifiable_scene();
    const PosedScene whole = pose_whole(wall.scene, {.size = kSize});
    const PosedScene posed = pose(wall.scene, {.size = kSize});
    // Several probes of a footprint, the number of which depends on its shape.
    RenderSettings settings;
    settings.anisotropy = 4;
    const Film before = render_raster(device(), whole, require(whole, settings), settings, {});
    const Film after = render_raster(device(), posed, require(posed, settings), settings, {});
    EXPECT_TRUE(before.mean == after.mean && before.alpha == after.alpha);
    EXPECT_NE(before.mean[0], middle_of(before));  // something was drawn
}

TEST_F(RasterSimplify, changes_no_bit_of_the_references)
{
    const SimplifiableScene wall = simplifiable_scene();
    const PosedScene whole = pose_whole(wall.scene, {.size = ivec2(36, 24)});
    const PosedScene posed = pose(wall.scene, {.size = ivec2(36, 24)});
    RenderSettings settings;
    settings.spp = 1;
    settings.renderer = Renderer::reference;
    EXPECT_EQ(reference::render_path(whole, require(whole, settings), settings, {}).mean,
              reference::render_path(posed, require(posed, settings), settings, {}).mean);
    settings.renderer = Renderer::reference_raster;
    EXPECT_EQ(reference::render_raster(whole, require(whole, settings), settings, {}).mean,
              reference::render_raster(posed, require(posed, settings), settings, {}).mean);
}

/// A floor whose texture is checks of single texels, or the grey that they average to: alike from level 1 on.
Scene floor_of(bool checks)
{
    SceneBuilder build("floor");
    Texels texels{.width = 64, .height = 64, .is_8_bit = false, .bytes = {}, .wide = {}};
    constexpr float kHalf = 0.735356927f;  // of linear light, in sRGB
    for (int i = 0; i < 64 * 64; ++i) {
        const float value = !checks ? kHalf : (i / 64 + i) % 2 == 0 ? 0.f : 1.f;
        texels.wide.insert(texels.wide.end(), {value, value, value, 1});
    }
    Material material = unlit(dvec4(1));
    material.base_color_texture = build.texture("t", std::move(texels), {});
    build.show("floor", make_rectangle({0, 0, 0}, {1, 0, 0}, {0, 0, -1}), build.material(material));
    build.camera("eye", 30, {0, 2, 3}, {0, 0, 0});
    return std::move(build).finish();
}

TEST_F(RasterSimplify, levels_that_are_said_not_to_be_read_are_not)
{
    const auto draw_floor = [&](bool checks) {
        const Scene scene = floor_of(checks);
        const PosedScene posed = pose(scene, {.size = ivec2(16, 12), .no_environment = true});
        const Requirements required = require(posed, {});
        EXPECT_GE(find_unseen(posed, required, {}).levels.at(0).first, 1);
        return render_raster(device(), posed, required, {}, {});
    };
    const Film checks = draw_floor(true), plain = draw_floor(false);
    // Both averages are one half to the 16 bits that texels have.
    for (std::size_t i = 0; i < checks.pixel_count(); ++i) EXPECT_NEAR(checks.mean[i].x, plain.mean[i].x, 3e-5) << i;
    EXPECT_GT(middle_of(checks).x, 0.4);
}

TEST_F(RasterSimplify, what_lies_outside_the_view_leaves_no_trace)
{
    const auto draw_ring = [&](bool all) {
        SceneBuilder build("ring");
        const Index stone = build.metallic_roughness("stone", dvec3(0.6), 0, 0.7);
        for (int i = 0; i < 12; ++i) {
            const double angle = 2 * kPi * i / 12;
            // Seen from the middle, towards -z: a quarter of the boxes at most.
            if (all || std::cos(angle) < -0.2)
                build.show("box", make_box({0, 0, 0}, {0.6, 0.8, 0.4}), stone,
                           translation({4 * std::sin(angle), 0, 4 * std::cos(angle)}));
        }
        build.environment(constant_environment(dvec3(1)));
        build.camera("eye", 50, {0, 0.2, 0}, {0, 0, -1});
        const Scene scene = std::move(build).finish();
        const PosedScene posed = pose(scene, {.size = ivec2(40, 30)});
        RenderSettings settings;
        settings.aovs = true;
        EXPECT_EQ(find_unseen(posed, require(posed, settings), settings).draws > 5, all);
        return render_raster(device(), posed, require(posed, settings), settings, {});
    };
    const Film ring = draw_ring(true), front = draw_ring(false);
    EXPECT_EQ(ring.mean, front.mean);
    EXPECT_EQ(ring.aovs.depth, front.aovs.depth);
}

}  // namespace
}  // namespace etalon::test
