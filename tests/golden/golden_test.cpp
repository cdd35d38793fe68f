// Checks every row of the manifest. `test_golden --update SCENE --because "…"` makes a golden anew (SCENE `all`: every
// one) and writes the reason into it; no test ever does.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <string>

#include "engine/base/error.h"
#include "engine/image/io.h"
#include "engine/measure/compare.h"
#include "engine/reference/reference.h"
#include "engine/scene/load.h"
#include "manifest.h"

namespace etalon::golden {

void PrintTo(const Row& row, std::ostream* out)
{
    *out << row.scene;
}

namespace {

std::filesystem::path file_of(const Row& row)
{
    return std::filesystem::path(ETALON_GOLDEN_FOLDER) / (std::string(row.scene) + ".exr");
}

Film render(const Row& row, std::uint64_t spp, std::uint64_t seed)
{
    const Scene scene = make_builtin(row.scene);
    const PosedScene posed = pose(scene, {.size = ivec2(row.width, row.height)});
    const RenderSettings settings{
        .renderer = Renderer::reference,
        .spp = spp,
        .seed = seed,
        .max_depth = scene.roots[scene.default_root].hints.max_depth.value_or(RenderSettings{}.max_depth)};
    return reference::render_path(posed, require(posed, settings), settings, {});
}

void update(const Row& row, const std::string& because)
{
    constexpr std::uint64_t kSeed = 1;
    Film film = render(row, row.made_with, kSeed);
    film.metadata["golden.because"] = because;
    film.metadata["golden.spp"] = std::to_string(row.made_with);
    film.metadata["golden.seed"] = std::to_string(kSeed);
    write_film(film, file_of(row));
    std::printf("%s: %s\n", file_of(row).c_str(), because.c_str());
}

class Golden : public ::testing::TestWithParam<Row> {};

TEST_P(Golden, picture_is_what_it_was_by_welch)
{
    const Row& row = GetParam();
    ASSERT_TRUE(std::filesystem::exists(file_of(row)))
        << "no golden: test_golden --update " << row.scene << " --because \"…\"";
    const Film golden = read_film(file_of(row));
    ASSERT_EQ(golden.samples, row.made_with) << "stale: the manifest asks for another number of samples";
    ASSERT_FALSE(golden.variance.empty());

    const Comparison found = compare(render(row, row.spp, row.seed), golden, {.false_alarm = row.false_alarm});
    for (const std::string& reason : found.reasons)
        std::printf("%s: %s\n", std::string(row.scene).c_str(), reason.c_str());
    EXPECT_EQ(found.verdict, Verdict::indistinguishable) << row.why;
    std::printf("%s finds %.2g of the whole, %.2g of a tile\n", std::string(row.scene).c_str(),
                found.test->detectable_whole, found.test->detectable_tile);
    EXPECT_LE(found.test->detectable_whole, row.finds) << "the row has become too weak to mean anything";
}

INSTANTIATE_TEST_SUITE_P(manifest, Golden, ::testing::ValuesIn(manifest().begin(), manifest().end()),
                         [](const auto& tested) {
                             std::string name(tested.param.scene);
                             std::replace(name.begin(), name.end(), '-', '_');
                             return name;
                         });

TEST(Manifest, has_a_golden_for_every_row_and_a_row_for_every_golden)
{
    std::size_t files = 0;
    std::uintmax_t bytes = 0;
    for (const auto& entry : std::filesystem::directory_iterator(ETALON_GOLDEN_FOLDER)) {
        if (entry.path().extension() != ".exr") continue;
        ++files;
        bytes += entry.file_size();
        const std::string stem = entry.path().stem().string();
        EXPECT_TRUE(std::any_of(manifest().begin(), manifest().end(), [&](const Row& row) {
            return row.scene == stem;
        })) << entry.path();
    }
    EXPECT_EQ(files, manifest().size());
    EXPECT_LT(bytes, 1u << 20) << "goldens are kept small: they stay in the history for ever";
}

/// A golden that is 1% off, as a changed BSDF or light would make it, is found.
TEST(Golden, a_row_finds_a_change_of_one_percent)
{
    for (const Row& row : manifest()) {
        if (row.finds > 0.005) continue;
        Film golden = read_film(file_of(row));
        for (vec3& pixel : golden.mean) pixel *= 1.01f;
        EXPECT_EQ(compare(render(row, row.spp, row.seed), golden, {.false_alarm = row.false_alarm}).verdict,
                  Verdict::different)
            << row.scene;
    }
}

int update_from(int count, char** arguments)
{
    const std::string scene = arguments[2];
    if (count != 5 || std::string(arguments[3]) != "--because" || std::string(arguments[4]).size() < 10) {
        std::fprintf(stderr, "usage: test_golden --update SCENE|all --because \"a reason of at least ten letters\"\n");
        return 2;
    }
    std::size_t made = 0;
    for (const Row& row : manifest()) {
        if (scene != "all" && scene != row.scene) continue;
        update(row, arguments[4]);
        ++made;
    }
    if (made == 0) std::fprintf(stderr, "no row of the manifest is called %s\n", scene.c_str());
    return made == 0 ? 2 : 0;
}

}  // namespace
}  // namespace etalon::golden

int main(int count, char** arguments)
{
    if (count > 2 && std::string(arguments[1]) == "--update") {
        try {
            return etalon::golden::update_from(count, arguments);
        } catch (const etalon::Error& error) {
            std::fprintf(stderr, "%s\n", error.message().c_str());
            return error.exit_code();
        }
    }
    ::testing::InitGoogleTest(&count, arguments);
    return RUN_ALL_TESTS();
}
