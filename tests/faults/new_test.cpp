// Every allocation of ours, failed: "out of memory" or an Error of the machine that says so, nothing left behind, and
// what was there before as it was.
#include <sys/wait.h>
#include <unistd.h>

#include <cstdio>

#include "engine/base/memory.h"
#include "engine/image/io.h"
#include "engine/scene/load.h"
#include "tests/faults/new_hook.h"
#include "tests/faults/picture.h"
#include "tests/support/files.h"
#include "tests/unit/scene/gltf_writer.h"

namespace etalon::test {
namespace {

using testing::AnyOf;
using testing::IsEmpty;

/// How many allocations `action` makes when everything is warm.
std::size_t count_allocations(const std::function<void()>& action)
{
    action();  // what is allocated once in a process is not to be counted
    const FailingNew none(~std::size_t{0}, 0);
    action();
    return none.counted();
}

/// Fails allocations of `action` one after another, for once and for good. `check` is called after each with whether
/// the action succeeded all the same.
void fail_allocations(const std::function<void()>& action, std::size_t few, const std::function<void(bool)>& check)
{
    const std::size_t count = count_allocations(action);
    ASSERT_GT(count, 10u);
    for (const std::size_t times : {std::size_t{1}, ~std::size_t{0}})
        for (const std::size_t n : faults_to_try(count, few)) {
            Outcome outcome;
            {
                const FailingNew memory(n, times);
                outcome = attempt(action);
                if (!memory.failed()) continue;  // threads and waves vary by a few allocations
            }
            EXPECT_NE(outcome.blame, Blame::input) << "allocation " << n << " of " << count << ": " << outcome.message;
            check(!outcome.blame);
            if (testing::Test::HasFailure()) return;
        }
    std::printf("%zu allocations, %zu failed twice\n", count, faults_to_try(count, few).size());
}

/// The same, each in a process of its own, which libraries may end where a destructor lacks memory: then, too, as an
/// Error of the machine ends it.
void fail_allocations_of_a_process(const std::function<void()>& action, std::size_t few,
                                   const std::function<void()>& check)
{
    const std::size_t count = count_allocations(action);
    ASSERT_GT(count, 10u);
    for (const std::size_t times : {std::size_t{1}, ~std::size_t{0}})
        for (const std::size_t n : faults_to_try(count, few)) {
            const pid_t child = ::fork();
            if (child == 0) {
                ::close(STDERR_FILENO);
                exit_when_out_of_memory();
                const FailingNew memory(n, times);
                const Outcome outcome = attempt(action);
                ::_exit(outcome.blame ? static_cast<int>(*outcome.blame) : 0);
            }
            int status = 0;
            ::waitpid(child, &status, 0);
            ASSERT_TRUE(WIFEXITED(status)) << "allocation " << n << " of " << count << ": signal " << WTERMSIG(status);
            EXPECT_THAT(WEXITSTATUS(status), AnyOf(0, 3)) << "allocation " << n << " of " << count;
            check();
        }
    std::printf("%zu allocations, %zu failed twice\n", count, faults_to_try(count, few).size());
}

class Allocations : public testing::TestWithParam<Renderer> {};

std::string_view label_of(Renderer renderer)
{
    constexpr std::string_view kNames[] = {"raster", "path", "reference_raster", "reference"};
    return kNames[static_cast<int>(renderer)];
}
INSTANTIATE_TEST_SUITE_P(Of, Allocations,
                         testing::Values(Renderer::raster, Renderer::path, Renderer::reference_raster,
                                         Renderer::reference),
                         [](const auto& which) { return std::string(label_of(which.param)); });

TEST_P(Allocations, a_picture_survives_each_that_fails)
{
    const Picture picture("maps", GetParam());
    std::vector<std::string> messages;
    std::optional<gpu::Device> device;
    const bool on_device = GetParam() == Renderer::raster || GetParam() == Renderer::path;
    if (on_device)
        device.emplace(gpu::DeviceOptions{.validate = true,
                                          .on_message = [&](const std::string& text) { messages.push_back(text); }});
    gpu::Device* const used = on_device ? &*device : nullptr;
    const Film expected = picture.render(used);
    Film film;
    fail_allocations([&] { film = picture.render(used); }, on_device ? 12 : 40,
                     [&](bool succeeded) {
                         EXPECT_TRUE(!succeeded || same_bits(film, expected));
                         EXPECT_TRUE(!on_device || device->memory().in_use == 0);
                         EXPECT_THAT(messages, IsEmpty());
                     });
    EXPECT_TRUE(same_bits(picture.render(used), expected));
}

TEST_F(Allocations, creation_of_a_device_survives_each_that_fails)
{
    std::vector<std::string> messages;
    const gpu::DeviceOptions options{.validate = true,
                                     .on_message = [&](const std::string& text) { messages.push_back(text); }};
    fail_allocations([&] { const gpu::Device device(options); }, 30, [&](bool) { EXPECT_THAT(messages, IsEmpty()); });
}

/// A textured triangle with two instances.
std::vector<std::byte> small_file(const Image& picture)
{
    GltfWriter gltf;
    const int positions = gltf.add_floats({-1, -1, 0, 1, -1, 0, 0, 1, 0}, 3);
    const int uvs = gltf.add_floats({0, 0, 1, 0, 0, 1}, 2);
    const std::vector<std::byte> png = encode_png(picture, {});
    gltf.add("images", fmt::format(R"({{"bufferView":{},"mimeType":"image/png"}})", gltf.add_view(png)));
    gltf.add("textures", R"({"source":0})");
    gltf.add("materials", R"({"pbrMetallicRoughness":{"baseColorTexture":{"index":0}},"normalTexture":{"index":0}})");
    gltf.add("meshes",
             fmt::format(R"({{"primitives":[{{"attributes":{{"POSITION":{},"TEXCOORD_0":{}}},"material":0}}]}})",
                         positions, uvs));
    gltf.add("nodes", R"({"mesh":0,"name":"a name that is too long to be kept within a string"})");
    gltf.add("scenes", R"({"nodes":[0]})");
    return gltf.glb();
}

Image gradient(int side)
{
    Image image(side, side, 3);
    for (std::size_t i = 0; i < image.values.size(); ++i) image.values[i] = float(i % 97) / 97;
    return image;
}

TEST_F(Allocations, loading_a_file_survives_each_that_fails)
{
    const std::vector<std::byte> file = small_file(gradient(16));
    fail_allocations_of_a_process([&] { static_cast<void>(parse_gltf(file, ".", "small")); }, 100, [] {});
}

TEST_F(Allocations, writing_a_picture_survives_each_that_fails_and_leaves_the_old_file_or_the_new)
{
    const TemporaryDirectory folder;
    const Image before = gradient(8);
    const Image after = gradient(24);
    const auto path = folder / "picture.png";
    fail_allocations_of_a_process(
        [&] {
            write_png(before, {}, path);
            write_png(after, {{"name", "a text that is too long to be kept within a string"}}, path);
        },
        40,
        [&] {
            EXPECT_THAT(folder.names(), testing::ElementsAre("picture.png"));
            EXPECT_THAT(read_image(path).width, AnyOf(8, 24));
        });
}

TEST_F(Allocations, writing_a_film_survives_each_that_fails_and_leaves_it_whole_or_absent)
{
    const Film film = Picture("triangle", Renderer::reference, 8).render(nullptr);
    const TemporaryDirectory folder;
    const auto path = folder / "film.exr";
    const auto write = [&] {
        std::filesystem::remove(path);
        write_film(film, path);
    };
    fail_allocations(write, 40, [&](bool written) {
        EXPECT_TRUE(folder.names().empty() ? !written : same_bits(read_film(path), film));
    });
}

}  // namespace
}  // namespace etalon::test
