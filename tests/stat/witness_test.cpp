// An outside witness: Mitsuba 3's pictures of scenes whose meaning is stated to the last convention, with their
// variance. What our three renderers share (importer, posing, random numbers, conventions) is tested here and nowhere
// else. Inputs: the shared folder. ETALON_WITNESS_SPP=4096 asks for the full test of every scene; without it, the
// scenes marked `always` run with few samples.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <optional>

#include "engine/gpu/device.h"
#include "engine/image/io.h"
#include "engine/math/stats.h"
#include "engine/measure/compare.h"
#include "engine/measure/text.h"
#include "engine/reference/reference.h"
#include "engine/render/render.h"
#include "engine/scene/load.h"
#include "tests/support/files.h"

namespace etalon {
namespace {

/// Together, all comparisons of this file.
constexpr double kFalseAlarm = 1e-3;
constexpr int kComparisons = 30;

struct Witness {
    std::string name;
    std::uint64_t batches;  ///< of the witness: its variance has one degree of freedom less
    std::uint64_t spp;      ///< ours, unless ETALON_WITNESS_SPP says more
    bool always;            ///< false: only with ETALON_WITNESS_SPP
    double must_find;       ///< relative difference of the whole picture that the test must be able to find
};

void PrintTo(const Witness& witness, std::ostream* out)
{
    *out << witness.name;
}

const std::vector<Witness>& witnesses()
{
    static const std::vector<Witness> kWitnesses{
        {"cornell-diffuse", 86, 64, true, 0.01},  {"furnace", 64, 64, true, 0.005},
        {"furnace-lambert", 64, 64, true, 0.002}, {"furnace-ggx", 64, 64, true, 0.005},
        {"env-diffuse", 62, 64, true, 0.01},      {"textured", 64, 64, true, 0.01},
        {"punctual", 152, 64, true, 0.01},        {"cornell-mirror-glass", 44, 512, false, 0.02},
        {"ggx-row", 128, 512, false, 0.02},       {"rough-dielectric", 41, 512, false, 0.02},
        {"thin-lens", 171, 64, false, 0.01},      {"orthographic", 230, 64, false, 0.01},
        {"instanced", 64, 64, false, 0.01},       {"many-lights", 118, 256, false, 0.02},
        {"deep-interior", 58, 256, false, 0.02},
    };
    return kWitnesses;
}

std::optional<std::uint64_t> asked_spp()
{
    const char* text = std::getenv("ETALON_WITNESS_SPP");
    if (text == nullptr) return std::nullopt;
    return std::strtoull(text, nullptr, 10);
}

/// What the witness measured, as a film of `batches` samples.
Film testimony(const std::filesystem::path& folder, std::uint64_t batches)
{
    const Image mean = read_image(folder / "mean.exr");
    const Image variance = read_image(folder / "variance_of_mean.exr");
    Film film;
    film.width = mean.width;
    film.height = mean.height;
    film.samples = batches;
    const auto pixel = [](const Image& image, std::size_t i) {
        const float* values = &image.values[i * std::size_t(image.channels)];
        return vec3(values[0], values[1], values[2]);
    };
    for (std::size_t i = 0; i < mean.pixel_count(); ++i) {
        film.mean.push_back(pixel(mean, i));
        film.variance.push_back(pixel(variance, i));
    }
    film.alpha.assign(film.pixel_count(), 1.0f);
    return film;
}

enum class Maker { vulkan, reference };

Film make(Maker maker, const std::filesystem::path& file, std::uint64_t spp)
{
    const Scene scene = load_scene(file.string());
    const PosedScene posed = pose(scene);
    const RenderSettings settings{.renderer = maker == Maker::vulkan ? Renderer::path : Renderer::reference,
                                  .spp = spp,
                                  .seed = 20261123,
                                  .max_depth = scene.roots[scene.default_root].hints.max_depth.value()};
    if (maker == Maker::reference) return reference::render_path(posed, require(posed, settings), settings, {});
    gpu::Device device;
    return render_path(device, posed, require(posed, settings), settings, {});
}

void expect_same_as_witness(const Witness& witness, Maker maker, std::uint64_t spp, double weaker)
{
    const auto folder = test::find_shared("reference/" + witness.name);
    if (!folder) GTEST_SKIP() << "no shared inputs";
    if (!witness.always && !asked_spp()) GTEST_SKIP() << "by ETALON_WITNESS_SPP only";

    const Film ours = make(maker, *folder / (witness.name + ".gltf"), asked_spp().value_or(spp));
    const Film theirs = testimony(*folder, witness.batches);
    const Comparison found =
        compare(ours, theirs, {.false_alarm = sidak_level(kFalseAlarm, kComparisons), .rounding = kDeviceRounding});
    ASSERT_TRUE(found.test.has_value());
    const StatisticalTest& test = *found.test;
    std::printf(
        "%s at %llu spp: %s; std(z) of tiles %.3f, of pixels %.3f, max |z| %.1f, pixels over bound %llu, worst tile z "
        "%+.2f, whole %+.3g%% "
        "%+.3g%% %+.3g%% "
        "(z %+.2f %+.2f %+.2f)\n",
        witness.name.c_str(), static_cast<unsigned long long>(ours.samples), verdict_text(found).c_str(),
        test.tile_z_std, test.pixel_z_std, test.pixel_z_max, static_cast<unsigned long long>(test.pixel_over_bound),
        test.worst_tile.z, 100 * test.whole[0].relative, 100 * test.whole[1].relative, 100 * test.whole[2].relative,
        test.whole[0].z, test.whole[1].z, test.whole[2].z);
    for (const std::string& reason : found.reasons) std::printf("  %s\n", reason.c_str());
    EXPECT_EQ(found.verdict, Verdict::indistinguishable);
    EXPECT_LE(test.detectable_whole, weaker * witness.must_find) << "too weak to mean anything";
    // Lower: our variance is too large, or samples correlate. Higher: too small. Pixels at the rim of things see so
    // rare events that only thousands of samples give their z a meaning.
    EXPECT_GT(test.tile_z_std, 0.75);
    EXPECT_LT(test.tile_z_std, 1.25);
    if (ours.samples >= 2048) {
        // Of two replicates a pixel the score is about 1: 0.86 to 1.21 over these scenes.
        EXPECT_GT(test.pixel_z_std, 0.8);
        EXPECT_LT(test.pixel_z_std, 1.3);
    }
}

class WitnessOfVulkanPath : public ::testing::TestWithParam<Witness> {};
TEST_P(WitnessOfVulkanPath, ST2_no_tile_differs_from_mitsuba)
{
    expect_same_as_witness(GetParam(), Maker::vulkan, GetParam().spp, 1);
}

/// A quarter of the samples: double precision on a CPU is slow, so it finds twice the difference.
class WitnessOfReference : public ::testing::TestWithParam<Witness> {};
TEST_P(WitnessOfReference, ST2_no_tile_differs_from_mitsuba)
{
    expect_same_as_witness(GetParam(), Maker::reference, GetParam().spp / 4, 2);
}

std::string test_name(const ::testing::TestParamInfo<Witness>& tested)
{
    std::string name = tested.param.name;
    std::replace(name.begin(), name.end(), '-', '_');
    return name;
}

INSTANTIATE_TEST_SUITE_P(mitsuba, WitnessOfVulkanPath, ::testing::ValuesIn(witnesses()), test_name);
INSTANTIATE_TEST_SUITE_P(mitsuba, WitnessOfReference, ::testing::ValuesIn(witnesses()), test_name);

}  // namespace
}  // namespace etalon
