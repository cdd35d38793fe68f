// What engine/gpu promises, kept by OpenGL.
#include <cmath>
#include <cstring>
#include <numeric>
#include <set>

#include "engine/gpu/image.h"
#include "engine/math/types.h"
#include "etalon_shaders.h"
#include "gl_test_shaders.h"
#include "tests/gl/gl_test.h"

namespace etalon::test {
namespace {

using testing::HasSubstr;

std::vector<std::byte> some_bytes(std::size_t count)
{
    std::vector<std::byte> bytes(count);
    for (std::size_t i = 0; i < count; ++i) bytes[i] = std::byte((i * 37 + i / 251) % 256);
    return bytes;
}

class GlDeviceTest : public GlTest {};

TEST_P(GlDeviceTest, buffers_keep_what_is_written_copied_and_filled)
{
    std::vector<std::uint32_t> values(1000);
    std::iota(values.begin(), values.end(), 5u);
    const gpu::Buffer a = gpu::make_buffer(device(), values, "a");
    const gpu::Buffer b(device(), {.size = 4000, .name = "b"});
    const gpu::Buffer sent(device(), {.size = 400, .memory = gpu::MemoryKind::upload, .name = "sent"});
    const gpu::Buffer seen(device(), {.size = 400, .memory = gpu::MemoryKind::readback, .name = "seen"});
    std::memcpy(sent.mapped().data(), values.data(), 400);
    gpu::run(device(), [&](gpu::Commands& commands) {
        commands.copy(a, b, 4000);
        commands.fill(b, 77, 4, 8);
        commands.copy(sent, b, 400, 0, 2000);
        commands.copy(b, seen, 400, 2000, 0);
    });
    values[1] = values[2] = 77;
    std::vector<std::uint32_t> expected = values;
    std::iota(expected.begin() + 500, expected.begin() + 600, 5u);
    EXPECT_EQ(gpu::read_back<std::uint32_t>(device(), b, 1000), expected);
    EXPECT_EQ(std::memcmp(seen.mapped().data(), expected.data() + 500, 400), 0);
}

TEST_P(GlDeviceTest, images_of_every_format_come_back_level_by_level)
{
    for (const VkFormat format : {VK_FORMAT_R8_UNORM, VK_FORMAT_R8G8B8A8_UNORM, VK_FORMAT_R8G8B8A8_SRGB,
                                  VK_FORMAT_R16G16B16A16_UNORM, VK_FORMAT_R32_UINT, VK_FORMAT_R32G32_UINT}) {
        gpu::Image image(device(),
                         {.format = format, .width = 13, .height = 7, .layers = 2, .mips = 0, .name = "image"});
        std::vector<std::vector<std::byte>> levels;
        std::vector<gpu::ImagePart> parts;
        for (std::uint32_t layer = 0; layer < 2; ++layer)
            for (std::uint32_t mip = 0; mip < image.mips(); ++mip)
                levels.push_back(some_bytes(image.width(mip) * image.height(mip) * gpu::texel_size(format) + layer));
        std::size_t next = 0;
        for (std::uint32_t layer = 0; layer < 2; ++layer)
            for (std::uint32_t mip = 0; mip < image.mips(); ++mip, ++next)
                parts.push_back({std::span(levels[next]).subspan(layer), mip, layer});
        gpu::upload(device(), image, parts);
        for (const gpu::ImagePart& part : parts) {
            const std::vector<std::byte> back = gpu::download(device(), image, part.mip, part.layer);
            EXPECT_TRUE(std::equal(back.begin(), back.end(), part.texels.begin(), part.texels.end()))
                << "format " << format << ", level " << part.mip << " of layer " << part.layer;
        }
    }
}

TEST_P(GlDeviceTest, a_resolve_is_the_mean_of_samples_and_the_first_row_is_the_top_one)
{
    gpu::Image samples(device(), {.format = VK_FORMAT_R32G32B32A32_SFLOAT,
                                  .width = 64,
                                  .height = 64,
                                  .samples = 4,
                                  .usage = VK_IMAGE_USAGE_COLOR_ATTACHMENT_BIT,
                                  .name = "samples"});
    gpu::Image resolved(device(),
                        {.format = VK_FORMAT_R32G32B32A32_SFLOAT, .width = 64, .height = 64, .name = "resolved"});
    const gpu::GraphicsPipeline triangle(device(), {.vertex = {etalon_shaders::find("gpu/probe.vert"), {}},
                                                    .fragment = {gl_test_shaders::find("white.frag"), {}},
                                                    .colors = {{VK_FORMAT_R32G32B32A32_SFLOAT}},
                                                    .samples = 4,
                                                    .cull = VK_CULL_MODE_NONE,
                                                    .name = "triangle"});
    gpu::run(device(), [&](gpu::Commands& commands) {
        const gpu::ColorTarget target{.image = &samples, .clear = VkClearColorValue{}, .resolve = &resolved};
        commands.begin_rendering(std::span(&target, 1));
        commands.bind(triangle);
        commands.draw(3);
        commands.end_rendering();
    });
    const auto pixels = gpu::download_as<vec4>(device(), resolved);
    EXPECT_EQ(pixels[0], vec4(1));  // at the corner that Vulkan calls (0, 0)
    EXPECT_EQ(pixels[63 * 64 + 63], vec4(0));
    std::set<float> partial;
    for (const vec4& pixel : pixels) partial.insert(pixel.x);
    // The edge x + y = 63.5 leaves the standard samples at (0.375, 0.125), (0.125, 0.625) and so on to one side each.
    for (const float value : partial) EXPECT_EQ(value * 4, std::round(value * 4));
    EXPECT_GT(partial.size(), 2u);
}

TEST_P(GlDeviceTest, regions_are_timed_and_lists_can_run_again)
{
    const gpu::ComputePipeline kernel(device(),
                                      {.shader = {etalon_shaders::find("gpu/probe.comp"), {}}, .name = "probe"});
    const gpu::Buffer numbers = gpu::make_buffer(device(), std::vector<std::uint32_t>(64, 1), "numbers");
    const gpu::Bindings bindings(device(), kernel.layout(), {{0, numbers}});
    gpu::Commands commands(device(), "twice");
    commands.begin_region("all");
    commands.bind(kernel, bindings);
    commands.dispatch_over(64);
    commands.end_region();
    commands.submit();
    commands.submit();
    commands.wait();
    ASSERT_EQ(commands.times().size(), 1u);
    EXPECT_GE(commands.times()[0].milliseconds, 0);
    const auto found = gpu::read_back<std::uint32_t>(device(), numbers, 64);
    for (std::uint32_t i = 0; i < 64; ++i) EXPECT_EQ(found[i], (1664525u + i) * 1664525u + i);
}

TEST_P(GlDeviceTest, what_it_lacks_is_refused_by_name)
{
    const gpu::Buffer buffer(device(), {.size = 64, .name = "texels"});
    EXPECT_THROW(gpu::TexelView(device(), buffer, VK_FORMAT_R32G32B32A32_SFLOAT), Error);
    EXPECT_FALSE(device().supports(VK_FORMAT_BC7_UNORM_BLOCK, 0));
    EXPECT_FALSE(device().supports(VK_FORMAT_R32G32B32A32_SFLOAT, 0, 64));
    EXPECT_THROW(gpu::Image(device(), {.format = VK_FORMAT_BC7_UNORM_BLOCK, .width = 4, .height = 4}), Error);
    EXPECT_THROW(gpu::Image(device(), {.format = VK_FORMAT_R8_UNORM, .width = 1 << 20, .height = 1}), Error);
}

TEST_P(GlDeviceTest, memory_is_counted_and_refused_beyond_the_budget)
{
    gpu::DeviceOptions small = options();
    small.memory_budget = 1 << 20;
    gpu::Device device(small);
    const std::uint64_t before = device.memory().held;
    {
        const gpu::Buffer half(device, {.size = 600'000, .name = "half"});
        EXPECT_EQ(device.memory().held, before + 600'000);
        try {
            const gpu::Buffer more(device, {.size = 600'000, .name = "more"});
            FAIL() << "took more than the budget";
        } catch (const Error& error) {
            EXPECT_EQ(error.blame(), Blame::machine);
            EXPECT_THAT(error.what(), HasSubstr("\"more\""));
        }
    }
    EXPECT_EQ(device.memory().held, before);
}

TEST_P(GlDeviceTest, is_renewed)
{
    device().renew();
    const gpu::Buffer buffer = gpu::make_buffer(device(), std::vector<std::uint32_t>{1, 2, 3}, "numbers");
    EXPECT_EQ(gpu::read_back<std::uint32_t>(device(), buffer, 3), (std::vector<std::uint32_t>{1, 2, 3}));
}
ETALON_EVERY_WAY(GlDeviceTest);

}  // namespace
}  // namespace etalon::test
