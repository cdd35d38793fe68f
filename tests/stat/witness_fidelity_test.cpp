// Ten other engines as witnesses of what our renderers share: the importer, posing, cameras, textures' alpha.
// Silhouettes only: colours differ between engines by more than our faults would; fidelity_table prints those.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdio>

#include "witness_fidelity.h"

namespace etalon::fidelity {
namespace {

/// Scenes whose pictures have a silhouette and need nothing of a later issue (no iridescence). InterpolationTest is not
/// among them: the engines photographed it at different times.
const std::vector<std::string>& names()
{
    static const std::vector<std::string> kNames{"AnimatedMorphCube",
                                                 "AnimatedTriangle",
                                                 "Avocado",
                                                 "Box",
                                                 "BoxAnimated",
                                                 "BoxInterleaved",
                                                 "BoxTextured",
                                                 "BoxVertexColors",
                                                 "CesiumMan",
                                                 "DamagedHelmet",
                                                 "Duck",
                                                 "AlphaBlendModeTest",
                                                 "EmissiveStrengthTest",
                                                 "EnvironmentTest",
                                                 "MorphPrimitivesTest",
                                                 "MultiUVTest",
                                                 "NormalTangentTest",
                                                 "OrientationTest",
                                                 "RiggedSimple",
                                                 "SimpleMeshes",
                                                 "SimpleMorph",
                                                 "SimpleSkin",
                                                 "SimpleSparseAccessor",
                                                 "TextureEncodingTest",
                                                 "TextureSettingsTest",
                                                 "TextureTransformTest",
                                                 "Triangle",
                                                 "TwoSidedPlane",
                                                 "UnlitTest",
                                                 "VertexColorTest"};
    return kNames;
}

class FidelityWitness : public ::testing::TestWithParam<std::string> {};

TEST_P(FidelityWitness, silhouette_overlaps_the_engines_by_99_percent)
{
    const std::vector<Scenario> all = scenarios();
    const auto scenario = std::find_if(all.begin(), all.end(), [](const Scenario& s) { return s.name == GetParam(); });
    if (scenario == all.end())
        GTEST_SKIP() << (all.empty() ? "no shared inputs" : "the shared inputs lack this scenario or its model");
    gpu::Device device;
    double best = 0;
    Image ours;
    for (const std::string& engine : scenario->engines) {
        const Image theirs = engine_picture(*scenario, engine);
        if (ours.values.empty())
            ours = our_picture(device, *scenario, ivec2(theirs.width, theirs.height), {.renderer = Renderer::raster});
        ASSERT_EQ(ivec2(ours.width, ours.height), ivec2(theirs.width, theirs.height)) << engine;
        const double overlap = silhouette_overlap(ours, theirs);
        std::printf("%s %s %.4f\n", scenario->name.c_str(), engine.c_str(), overlap);
        best = std::max(best, overlap);
    }
    EXPECT_GE(best, 0.99);
}

INSTANTIATE_TEST_SUITE_P(scene, FidelityWitness, ::testing::ValuesIn(names()));

TEST(SilhouetteOverlap, is_the_share_of_common_pixels)
{
    Image a(4, 1, 4);
    Image b = a;
    EXPECT_EQ(silhouette_overlap(a, b), 1);
    a.at(0, 0, 3) = a.at(1, 0, 3) = b.at(1, 0, 3) = b.at(2, 0, 3) = 1;
    EXPECT_DOUBLE_EQ(silhouette_overlap(a, b), 1.0 / 3);
}

}  // namespace
}  // namespace etalon::fidelity
