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
