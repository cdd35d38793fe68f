#include "path_pair.h"

#include <gtest/gtest.h>

#include <cstdio>

#include "engine/math/stats.h"
#include "engine/measure/text.h"
#include "engine/reference/reference.h"
#include "engine/render/render.h"
#include "engine/scene/pose.h"
#include "engine/scene/requirements.h"

namespace etalon::agree {
namespace {

RenderSettings render_settings(Renderer renderer, const Shot& shot, std::uint64_t seed)
{
    return {.renderer = renderer, .spp = shot.spp, .seed = seed, .max_depth = shot.max_depth};
}

}  // namespace

Film by_vulkan(gpu::Device& device, const Scene& scene, const Shot& shot)
{
    const PosedScene posed = pose(scene, {.size = shot.size});
    const RenderSettings settings = render_settings(Renderer::path, shot, shot.seed);
    return render_path(device, posed, require(posed, settings), settings, {});
}

Film by_reference(const Scene& scene, const Shot& shot)
{
    const PosedScene posed = pose(scene, {.size = shot.size});
    const RenderSettings settings = render_settings(Renderer::reference, shot, shot.seed + 1000);
    return reference::render_path(posed, require(posed, settings), settings, {});
}

CompareSettings settings()
{
    return {.false_alarm = sidak_level(kFalseAlarm, kComparisons), .rounding = kDeviceRounding};
}

void expect_agreement(const std::string& what, const Film& vulkan, const Film& reference, double must_find,
                      const CompareSettings& how)
{
    const Comparison found = compare(vulkan, reference, how);
    ASSERT_TRUE(found.test.has_value()) << what;
    const StatisticalTest& test = *found.test;
    std::printf("%s: %s; std(z) of tiles %.3f, of pixels %.3f, worst tile z %+.2f, whole %+.3g%% %+.3g%% %+.3g%%\n",
                what.c_str(), verdict_text(found).c_str(), test.tile_z_std, test.pixel_z_std, test.worst_tile.z,
                100 * test.whole[0].relative, 100 * test.whole[1].relative, 100 * test.whole[2].relative);
    ::testing::Test::RecordProperty("detectable_tile", std::to_string(test.detectable_tile));
    ::testing::Test::RecordProperty("detectable_whole", std::to_string(test.detectable_whole));
    for (const std::string& reason : found.reasons) std::printf("  %s\n", reason.c_str());
    EXPECT_EQ(found.verdict, Verdict::indistinguishable) << what;
    EXPECT_LE(test.detectable_whole, must_find) << what << ": too weak to mean anything";
    EXPECT_FALSE(found.check_a.single_colour && found.check_b.single_colour) << what << ": nothing to see";
}

}  // namespace etalon::agree
