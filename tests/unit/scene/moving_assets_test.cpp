// Animated files of the shared inputs: posed at any time they are whole, and compressed ones are what they were.
#include <gtest/gtest.h>

#include "engine/base/error.h"
#include "engine/scene/load.h"
#include "engine/scene/pose.h"
#include "tests/support/files.h"

namespace etalon {
namespace {

void expect_whole(const PosedScene& posed, const std::string& name)
{
    EXPECT_TRUE(is_finite(posed.bounds_min) && is_finite(posed.bounds_max)) << name;
    for (const Draw& draw : posed.draws) {
        const Primitive& p = posed.primitive(draw);
        for (const std::uint32_t i : p.indices) ASSERT_LT(i, p.positions.size()) << name;
        ASSERT_TRUE(p.normals.empty() || p.normals.size() == p.positions.size()) << name;
        ASSERT_TRUE(p.tangents.empty() || p.tangents.size() == p.positions.size()) << name;
        for (const vec3& n : p.normals) ASSERT_NEAR(length(n), 1, 1e-5) << name;
        for (const auto& uv : p.uv) ASSERT_TRUE(uv.empty() || uv.size() == p.positions.size()) << name;
    }
}

TEST(MovingAssets, are_whole_at_any_time_and_move)
{
    const auto folder = test::find_shared("assets");
    if (!folder) GTEST_SKIP() << "no shared inputs";
    for (const char* file :
         {"CesiumMan/CesiumMan.glb", "RiggedSimple/RiggedSimple.glb", "SimpleSkin/SimpleSkin.gltf",
          "AnimatedMorphCube/AnimatedMorphCube.glb", "SimpleMorph/SimpleMorph.gltf", "BoxAnimated/BoxAnimated.glb",
          "InterpolationTest/InterpolationTest.glb", "AnimatedTriangle/AnimatedTriangle.gltf"}) {
        const Scene scene = load_scene((*folder / "khronos" / file).string());
        ASSERT_FALSE(scene.animations.empty()) << file;
        const double end = scene.animations[0].duration;
        for (const double time : {-1.0, 0.0, 0.37 * end, end, 1e6})
            expect_whole(pose(scene, {.time = time, .animation = kEveryAnimation}), file);
        const PosedScene early = pose(scene, {.time = 0.2 * end});
        const PosedScene late = pose(scene, {.time = 0.5 * end});
        bool moves = early.deformed.size() != late.deformed.size();
        for (std::size_t d = 0; d < early.draws.size(); ++d)
            moves = moves || early.draws[d].world_from_object != late.draws[d].world_from_object ||
                    early.primitive(early.draws[d]).positions != late.primitive(late.draws[d]).positions;
        EXPECT_TRUE(moves) << file;
    }
}

TEST(MovingAssets, draco_and_meshopt_files_are_the_shapes_that_were_compressed)
{
    const auto folder = test::find_shared("assets");
    if (!folder) GTEST_SKIP() << "no shared inputs";
    const std::pair<const char*, const char*> pairs[] = {
        {"khronos-encodings/CesiumMan-Draco/CesiumMan.gltf", "khronos/CesiumMan/CesiumMan.glb"},
        {"khronos-encodings/Duck-Draco/Duck.gltf", "khronos/Duck/Duck.glb"},
        {"khronos-encodings/Box-Draco/Box.gltf", "khronos/Box/Box.gltf"},
        {"gltf-transform/BoxMeshopt/BoxMeshopt.gltf", "khronos/Box/Box.gltf"}};
    for (const auto& [coded, plain] : pairs) {
        const Scene a = load_scene((*folder / coded).string());
        const Scene b = load_scene((*folder / plain).string());
        for (const double time : {0.0, 0.7}) {
            const PosedScene pa = pose(a, {.time = time});
            const PosedScene pb = pose(b, {.time = time});
            expect_whole(pa, coded);
            EXPECT_EQ(pa.primitive(pa.draws.at(0)).indices.size(), pb.primitive(pb.draws.at(0)).indices.size());
            // Quantized to 11 bits of the extent at the least; skins of 8-bit weights move some more.
            const double budget = 4e-3 * length(pb.bounds_max - pb.bounds_min);
            EXPECT_LT(length(pa.bounds_min - pb.bounds_min), budget) << coded << " at " << time;
            EXPECT_LT(length(pa.bounds_max - pb.bounds_max), budget) << coded << " at " << time;
        }
    }
}

}  // namespace
}  // namespace etalon
