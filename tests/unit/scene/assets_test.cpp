// Every glTF file of the shared inputs loads, or is refused with an Error: never anything else.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <sstream>

#include "engine/base/error.h"
#include "engine/scene/load.h"
#include "engine/scene/pose.h"
#include "engine/scene/requirements.h"
#include "tests/support/files.h"

namespace etalon {
namespace {

std::vector<std::filesystem::path> gltf_files_below(const std::filesystem::path& folder)
{
    std::vector<std::filesystem::path> out;
    for (const auto& entry : std::filesystem::recursive_directory_iterator(folder))
        if (entry.is_regular_file() && (entry.path().extension() == ".gltf" || entry.path().extension() == ".glb"))
            out.push_back(entry.path());
    std::sort(out.begin(), out.end());
    return out;
}

// numErrors of the Khronos validator's report beside a file; nothing where there is none.
std::optional<int> validator_errors(const std::filesystem::path& file)
{
    std::ifstream in(file.string() + ".report.json");
    if (!in) return std::nullopt;
    std::stringstream text;
    text << in.rdbuf();
    const std::string report = text.str();
    const std::size_t key = report.find("\"numErrors\"");
    const std::size_t digits = report.find_first_of("0123456789", key);
    return key == std::string::npos || digits == std::string::npos ? std::nullopt
                                                                   : std::optional(std::atoi(report.c_str() + digits));
}

TEST(Assets, each_loads_or_is_refused_and_what_the_validator_passes_loads)
{
    const auto folder = test::find_shared("assets");
    if (!folder) GTEST_SKIP() << "no shared inputs";
    // Without a validator error, but of a later glTF than there is.
    const std::vector<std::string> refused_all_the_same = {"min_version_valid.gltf"};
    int loaded = 0;
    int refused = 0;
    for (const std::filesystem::path& file : gltf_files_below(*folder)) {
        try {
            const Scene scene = load_scene(file.string());
            const PosedScene posed = pose(scene);
            static_cast<void>(require(posed, RenderSettings{}));
            ++loaded;
        } catch (const Error& error) {
            ++refused;
            EXPECT_EQ(error.exit_code(), 2) << error.message();
            EXPECT_THAT(error.message(), testing::HasSubstr(file.filename().string()));
            const bool known = std::find(refused_all_the_same.begin(), refused_all_the_same.end(), file.filename()) !=
                               refused_all_the_same.end();
            const std::optional<int> errors = known ? std::nullopt : validator_errors(file);
            EXPECT_NE(errors, std::optional(0)) << "the validator finds no error in it, but: " << error.message();
        }
    }
    std::printf("%d loaded, %d refused\n", loaded, refused);
    EXPECT_GT(loaded, 300);
}

TEST(Assets, references_are_read_with_their_exact_materials)
{
    const auto file = test::find_shared("reference/rough-dielectric/rough-dielectric.gltf");
    if (!file) GTEST_SKIP() << "no shared inputs";
    const Scene scene = load_scene(file->string());
    const PosedScene posed = pose(scene);
    ASSERT_EQ(posed.spheres.size(), 2u);
    const Material& material = scene.materials[posed.spheres[0].material];
    EXPECT_EQ(material.model, BsdfModel::rough_dielectric);
    EXPECT_EQ(material.ggx_alpha, 0.2);
    EXPECT_EQ(posed.view.width, 256);
    EXPECT_EQ(posed.environment.radiance, dvec3(0.3, 0.35, 0.4));
    EXPECT_EQ(scene.roots[0].hints.max_depth, 16);
}

}  // namespace
}  // namespace etalon
