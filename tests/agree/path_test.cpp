// The Vulkan path tracer against the reference, which shares none of its code, by Welch's test on tiles.
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>

#include "engine/scene/load.h"
#include "path_pair.h"
#include "tests/support/files.h"

namespace etalon::agree {
namespace {

struct Subject {
    std::string name;  ///< built-in scene, or a file of the shared assets
    Shot shot{};
    double must_find = 0.01;  ///< relative difference of the whole picture that the test finds with probability 0.9
};

void PrintTo(const Subject& subject, std::ostream* out)
{
    *out << subject.name;
}

std::string test_name(const ::testing::TestParamInfo<Subject>& tested)
{
    std::string name = std::filesystem::path(tested.param.name).stem().string();
    std::replace_if(
        name.begin(), name.end(), [](char c) { return !std::isalnum(static_cast<unsigned char>(c)); }, '_');
    return name;
}

// More samples and a wider `must_find` where little light carries much of the picture (a small lamp, caustics).
std::vector<Subject> builtin_subjects()
{
    return {{"cornell", {.size = {64, 64}, .spp = 256, .max_depth = 8}, 0.03},
            {"spheres", {.size = {96, 48}}},
            {"texture-plane"},
            {"furnace", {.size = {96, 48}, .max_depth = 32}},
            {"furnace-lambert"},
            {"lights"},
            {"alpha"},
            {"normals"},
            {"maps"},
            {"instances"},
            {"blinn-phong"},
            {"glass", {.size = {64, 64}, .spp = 256, .max_depth = 10}, 0.02},
            {"triangle"},
            {"wires"},
            {"orthographic"},
            {"thin-lens"},
            {"siemens-star", {.spp = 256, .max_depth = 2}, 0.015},
            {"specular"},
            {"clearcoat"},
            {"sheen"},
            {"transmission", {.spp = 256}, 0.02},
            {"volume", {.spp = 256, .max_depth = 8}, 0.02},
            {"iridescence"},
            {"anisotropy"},
            {"dispersion", {.spp = 512, .max_depth = 8}, 0.03},
            {"diffuse-transmission"},
            {"specular-glossiness"}};
}

class PathAgreesOnBuiltin : public ::testing::TestWithParam<Subject> {};

TEST_P(PathAgreesOnBuiltin, ST2_no_tile_differs)
{
    const Scene scene = make_builtin(GetParam().name);
    gpu::Device device({.validate = true});
    expect_agreement(GetParam().name, by_vulkan(device, scene, GetParam().shot), by_reference(scene, GetParam().shot),
                     GetParam().must_find);
    EXPECT_TRUE(device.validation_messages().empty()) << device.validation_messages().front();
}

INSTANTIATE_TEST_SUITE_P(scene, PathAgreesOnBuiltin, ::testing::ValuesIn(builtin_subjects()), test_name);

TEST(PathAgreement, covers_every_built_in_scene)
{
    for (const BuiltinScene& scene : builtin_scenes()) {
        const auto subjects = builtin_subjects();
        EXPECT_TRUE(std::any_of(subjects.begin(), subjects.end(), [&](const Subject& subject) {
            return subject.name == scene.name;
        })) << scene.name;
    }
}

class PathAgreesOnAsset : public ::testing::TestWithParam<Subject> {};

TEST_P(PathAgreesOnAsset, ST2_no_tile_differs)
{
    const auto file = test::find_shared("assets/" + GetParam().name);
    if (!file) GTEST_SKIP() << "no shared inputs";
    const Scene scene = load_scene(file->string());
    gpu::Device device;
    expect_agreement(GetParam().name, by_vulkan(device, scene, GetParam().shot), by_reference(scene, GetParam().shot),
                     GetParam().must_find);
}

INSTANTIATE_TEST_SUITE_P(
    asset, PathAgreesOnAsset,
    ::testing::Values(Subject{"khronos/BoxTextured/BoxTextured.gltf"}, Subject{"khronos/Avocado/Avocado.gltf"},
                      Subject{"khronos/DamagedHelmet/DamagedHelmet.glb"}, Subject{"khronos/Duck/Duck.glb"},
                      Subject{"khronos/AlphaBlendModeTest/AlphaBlendModeTest.glb"},
                      Subject{"khronos/NormalTangentTest/NormalTangentTest.glb"},
                      Subject{"khronos/TextureSettingsTest/TextureSettingsTest.glb"},
                      Subject{"khronos/MetalRoughSpheresNoTextures/MetalRoughSpheresNoTextures.glb"},
                      Subject{"khronos/OrientationTest/OrientationTest.glb"},
                      Subject{"khronos/BoxVertexColors/BoxVertexColors.glb"},
                      Subject{"khronos/UnlitTest/UnlitTest.glb"},
                      Subject{"khronos/EmissiveStrengthTest/EmissiveStrengthTest.glb",
                              {.size = {96, 64}, .spp = 512, .max_depth = 4},
                              0.02},
                      Subject{"khronos/LightsPunctualLamp/LightsPunctualLamp.gltf",
                              {.size = {32, 32}, .spp = 2048, .max_depth = 2},
                              0.2},
                      Subject{"khronos/MultiUVTest/MultiUVTest.glb"},
                      Subject{"khronos/TextureTransformTest/TextureTransformTest.gltf"},
                      Subject{"khronos/VertexColorTest/VertexColorTest.glb"},
                      Subject{"webxr-scenes/cube-room/cube-room.gltf", {.size = {64, 48}, .spp = 256}}),
    test_name);

}  // namespace
}  // namespace etalon::agree
