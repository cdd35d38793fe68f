#include <fmt/format.h>
#include <gtest/gtest.h>

#include <optional>

#include "engine/scene/load.h"
#include "tests/agree/raster_pair.h"
#include "tests/support/files.h"

namespace etalon::agree {
namespace {

class RasterAgrees : public testing::Test {
 protected:
    gpu::Device& device()
    {
        if (!device_) device_.emplace();
        return *device_;
    }

 private:
    std::optional<gpu::Device> device_;
};

constexpr ivec2 kSize(96, 72);

TEST_F(RasterAgrees, with_the_reference_on_every_built_in_scene)
{
    for (const BuiltinScene& builtin : builtin_scenes()) {
        const Scene scene = make_builtin(builtin.name);
        expect_rasters_agree(device(), std::string(builtin.name), pose(scene, {.size = kSize}), {});
    }
}

TEST_F(RasterAgrees, with_one_sample_a_pixel_and_without_mipmaps)
{
    RenderSettings settings;
    settings.msaa = 1;
    settings.mipmaps = false;
    for (const char* name : {"cornell", "texture-plane", "normals", "glass"}) {
        const Scene scene = make_builtin(name);
        expect_rasters_agree(device(), name, pose(scene, {.size = kSize}), settings);
    }
}

TEST_F(RasterAgrees, with_other_filters_of_textures)
{
    const Scene scene = make_builtin("texture-plane");
    const PosedScene posed = pose(scene, {.size = kSize});
    for (const int probes : {2, 16}) {
        RenderSettings settings;
        settings.anisotropy = probes;
        expect_rasters_agree(device(), fmt::format("texture-plane, {} probes", probes), posed, settings);
    }
    for (const TextureFilter filter : {TextureFilter::bilinear, TextureFilter::trilinear}) {
        RenderSettings settings;
        settings.texture_filter = filter;
        const Scene maps = make_builtin("maps");
        expect_rasters_agree(device(), fmt::format("maps, filter {}", static_cast<int>(filter)),
                             pose(maps, {.size = kSize}), settings);
    }
}

TEST_F(RasterAgrees, on_points_and_lines_of_any_width)
{
    const Scene scene = make_builtin("wires");
    for (const int ssaa : {1, 2}) {
        RenderSettings settings;
        settings.point_size = 5;
        settings.line_width = 3;
        settings.ssaa = ssaa;
        expect_rasters_agree(device(), fmt::format("wires, 5 and 3 pixels, ssaa {}", ssaa),
                             pose(scene, {.size = kSize}), settings);
    }
    // From within the cube: lines that begin behind the viewer.
    const PosedScene inside = pose(
        scene,
        {.orbit = Orbit{.azimuth = 20, .elevation = 10, .distance = 0.7, .target = {}, .yfov = 70}, .size = kSize});
    RenderSettings settings;
    settings.line_width = 4;
    expect_rasters_agree(device(), "wires from within", inside, settings);
}

TEST_F(RasterAgrees, when_several_drawn_pixels_make_one)
{
    struct Case {
        int msaa, ssaa;
        PixelFilter filter;
    };
    for (const Case& c : {Case{1, 3, PixelFilter::box}, Case{4, 2, PixelFilter::tent},
                          Case{1, 2, PixelFilter::gaussian}, Case{4, 1, PixelFilter::blackman_harris}}) {
        RenderSettings settings;
        settings.msaa = c.msaa;
        settings.ssaa = c.ssaa;
        settings.pixel_filter = c.filter;
        for (const char* name : {"furnace", "texture-plane", "transmission"}) {
            const Scene scene = make_builtin(name);
            expect_rasters_agree(device(), fmt::format("{} msaa {} ssaa {}", name, c.msaa, c.ssaa),
                                 pose(scene, {.size = ivec2(48, 36)}), settings);
        }
    }
}

TEST_F(RasterAgrees, with_blinn_phong_shading_and_a_transparent_background)
{
    RenderSettings settings;
    settings.shading = Shading::blinn_phong;
    settings.background = Background::transparent;
    for (const char* name : {"blinn-phong", "lights", "spheres", "alpha"}) {
        const Scene scene = make_builtin(name);
        expect_rasters_agree(device(), name, pose(scene, {.size = kSize}), settings);
    }
}

/// Where a real scene lies below the shared inputs, and whether it is lit by the studio's map (which takes the
/// reference a second to tabulate) or by a constant environment.
struct RealScene {
    const char* path;
    bool studio = false;
};

void PrintTo(const RealScene& scene, std::ostream* out)
{
    *out << scene.path;
}

class RasterAgreesOn : public testing::TestWithParam<RealScene> {};

TEST_P(RasterAgreesOn, a_real_scene)
{
    const auto path = test::find_shared(std::string("assets/khronos/") + GetParam().path);
    if (!path) GTEST_SKIP() << "no shared inputs";
    gpu::Device device;
    const Scene scene = load_scene(path->string());
    PoseSettings settings{.size = kSize};
    if (!GetParam().studio) {
        settings.environment = Environment{};
        settings.environment->radiance = dvec3(1, 0.9, 0.8);
    }
    expect_rasters_agree(device, scene.name, pose(scene, settings), {});
}

INSTANTIATE_TEST_SUITE_P(
    Khronos, RasterAgreesOn,
    testing::Values(RealScene{"BoxTextured/BoxTextured.gltf"}, RealScene{"BoxVertexColors/BoxVertexColors.glb"},
                    RealScene{"Duck/Duck.glb"}, RealScene{"Avocado/Avocado.gltf", true},
                    RealScene{"DamagedHelmet/DamagedHelmet.glb", true}, RealScene{"MultiUVTest/MultiUVTest.glb"},
                    RealScene{"AlphaBlendModeTest/AlphaBlendModeTest.glb"},
                    RealScene{"TextureTransformTest/TextureTransformTest.gltf"},
                    RealScene{"NormalTangentTest/NormalTangentTest.glb"},
                    RealScene{"TextureSettingsTest/TextureSettingsTest.glb"}, RealScene{"UnlitTest/UnlitTest.glb"},
                    RealScene{"LightsPunctualLamp/LightsPunctualLamp.gltf"},
                    RealScene{"MeshPrimitiveModes/MeshPrimitiveModes.gltf"}));

}  // namespace
}  // namespace etalon::agree
