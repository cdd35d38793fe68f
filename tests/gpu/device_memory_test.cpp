// Bytes go to the device and come back; memory is refused, not exhausted.
#include <limits>
#include <numeric>

#include "device_shaders.h"
#include "engine/base/error.h"
#include "tests/gpu/device_test.h"

namespace etalon::test {
namespace {

using gpu::MemoryKind;
using testing::HasSubstr;

std::vector<std::uint32_t> numbered(std::size_t count)
{
    std::vector<std::uint32_t> values(count);
    std::iota(values.begin(), values.end(), 0x01020304u);
    return values;
}

/// Both ways to the device: mapped, and staged as on a discrete GPU.
class DeviceMemory : public DeviceTest, public testing::WithParamInterface<bool> {
 protected:
    gpu::Device make_device(std::optional<std::uint64_t> budget = std::nullopt)
    {
        gpu::DeviceOptions chosen = options();
        chosen.staged = GetParam();
        chosen.memory_budget = budget;
        return gpu::Device(chosen);
    }
};

INSTANTIATE_TEST_SUITE_P(, DeviceMemory, testing::Bool(),
                         [](const auto& way) { return std::string(way.param ? "staged" : "mapped"); });

TEST_P(DeviceMemory, buffers_give_back_what_was_uploaded)
{
    gpu::Device device = make_device();
    const std::vector<std::uint32_t> values = numbered(10'000);
    for (const MemoryKind kind : {MemoryKind::device, MemoryKind::upload, MemoryKind::readback}) {
        const gpu::Buffer buffer(device, {.size = 4 * values.size(), .memory = kind, .name = "round trip"});
        EXPECT_EQ(buffer.mapped().empty(), kind == MemoryKind::device && (GetParam() || !device.unified_memory()));
        gpu::upload(device, buffer, std::span<const std::uint32_t>(values));
        EXPECT_EQ(gpu::read_back<std::uint32_t>(device, buffer, values.size()), values);
        gpu::upload(device, buffer, std::span<const std::uint32_t>(values).first(3), 40);
        EXPECT_EQ(gpu::read_back<std::uint32_t>(device, buffer, 4, 36),
                  (std::vector<std::uint32_t>{values[9], values[0], values[1], values[2]}));
    }
}

TEST_P(DeviceMemory, a_buffer_larger_than_the_staging_goes_in_pieces)
{
    gpu::Device device = make_device();
    const std::vector<std::uint32_t> values = numbered((std::size_t{20} << 20) / 4);
    const gpu::Buffer buffer = gpu::make_buffer(device, values, "large");
    EXPECT_EQ(gpu::read_back<std::uint32_t>(device, buffer, values.size()), values);
}

TEST_P(DeviceMemory, an_empty_buffer_can_still_be_bound)
{
    gpu::Device device = make_device();
    const gpu::Buffer buffer = gpu::make_buffer(device, std::vector<float>{}, "nothing");
    EXPECT_EQ(buffer.size(), 16u);
    EXPECT_NE(buffer.address(), 0u);
    EXPECT_TRUE(gpu::read_back<float>(device, buffer, 0).empty());
}

TEST_P(DeviceMemory, images_give_back_every_level_and_layer)
{
    gpu::Device device = make_device();
    for (const VkFormat format : {VK_FORMAT_R8G8B8A8_UNORM, VK_FORMAT_R8G8B8A8_SRGB, VK_FORMAT_R16G16B16A16_SFLOAT,
                                  VK_FORMAT_R32G32B32A32_SFLOAT, VK_FORMAT_R32_UINT}) {
        gpu::Image image(device, {.format = format,
                                  .width = 37,
                                  .height = 5,
                                  .layers = 3,
                                  .mips = 0,
                                  .usage = VK_IMAGE_USAGE_SAMPLED_BIT,
                                  .name = "round trip"});
        ASSERT_EQ(image.mips(), 6u);
        std::vector<std::vector<std::byte>> levels;
        std::vector<gpu::ImagePart> parts;
        for (std::uint32_t layer = 0; layer < image.layers(); ++layer)
            for (std::uint32_t mip = 0; mip < image.mips(); ++mip) {
                auto& texels = levels.emplace_back(image.width(mip) * image.height(mip) * gpu::texel_size(format));
                for (std::size_t i = 0; i < texels.size(); ++i)
                    texels[i] = static_cast<std::byte>((i * 7 + mip * 31 + layer * 101) % 60);  // no NaN in any format
            }
        for (std::uint32_t i = 0; i < levels.size(); ++i)
            parts.push_back({.texels = levels[i], .mip = i % image.mips(), .layer = i / image.mips()});
        gpu::upload(device, image, parts);
        EXPECT_EQ(image.use(), gpu::ImageUse::sampled);
        for (const gpu::ImagePart& part : parts)
            EXPECT_EQ(gpu::download(device, image, part.mip, part.layer),
                      std::vector<std::byte>(part.texels.begin(), part.texels.end()))
                << "format " << format << ", level " << part.mip << ", layer " << part.layer;
    }
}

TEST_P(DeviceMemory, refuses_what_is_over_its_budget_and_says_what_is_left)
{
    constexpr std::uint64_t kBudget = std::uint64_t{3} << 20;
    gpu::Device device = make_device(kBudget);
    EXPECT_EQ(device.memory_budget(), kBudget);
    const gpu::Buffer first(device, {.size = 1 << 20, .name = "first"});
    try {
        const gpu::Buffer second(device, {.size = kBudget, .name = "the large one"});
        ADD_FAILURE() << "more memory than the budget was handed out";
    } catch (const Error& error) {
        EXPECT_EQ(error.blame(), Blame::machine);
        EXPECT_THAT(error.what(), HasSubstr("\"the large one\" needs 3.0 MiB"));
        EXPECT_THAT(error.what(), HasSubstr("a budget of 3.0 MiB"));
        EXPECT_FALSE(error.mend().empty());
    }
    EXPECT_THROW(gpu::Image(device, {.format = VK_FORMAT_R32G32B32A32_SFLOAT,
                                     .width = 1024,
                                     .height = 1024,
                                     .usage = VK_IMAGE_USAGE_SAMPLED_BIT,
                                     .name = "16 MiB"}),
                 Error);
    EXPECT_LE(device.memory().held, kBudget);
    EXPECT_NO_THROW(gpu::Buffer(device, {.size = 1 << 20, .name = "one that fits"}));
}

TEST_P(DeviceMemory, gives_everything_back_to_the_driver)
{
    gpu::Device device = make_device();
    {
        std::vector<gpu::Buffer> buffers;
        for (std::uint64_t i = 0; i < 500; ++i)
            buffers.emplace_back(device, gpu::BufferSpec{.size = 1 + 977 * i, .name = "one of many"});
        for (std::size_t i = 0; i < buffers.size(); i += 2) buffers[i] = {};
        for (std::size_t i = 0; i < buffers.size(); i += 2)
            buffers[i] = gpu::Buffer(device, {.size = 5000, .name = "a later one"});
        EXPECT_GT(device.memory().in_use, 0u);
        EXPECT_GE(device.memory().held, device.memory().in_use);
        EXPECT_LE(device.memory().held, std::uint64_t{256} << 20) << "500 small buffers share arenas";
    }
    EXPECT_EQ(device.memory().in_use, 0u);
    EXPECT_EQ(device.memory().held, 0u);
}

TEST_P(DeviceMemory, refuses_sizes_that_no_device_has)
{
    gpu::Device device = make_device();
    EXPECT_THROW(gpu::Buffer(device, {.size = std::uint64_t{1} << 60, .name = "2^60 bytes"}), Error);
    EXPECT_THROW(gpu::Buffer(device, {.size = std::numeric_limits<std::uint64_t>::max(), .name = "2^64-1"}), Error);
    const gpu::DeviceLimits& limits = device.limits();
    if (limits.allocation < std::min(limits.buffer_size, device.memory_budget()) - 4096) {
        EXPECT_THROW(gpu::Buffer(device, {.size = limits.allocation + 4096, .name = "over one allocation"}), Error);
    }
    try {
        const gpu::Image image(
            device, {.format = VK_FORMAT_R8G8B8A8_UNORM, .width = 1'000'000, .height = 1, .name = "a long line"});
        ADD_FAILURE();
    } catch (const Error& error) {
        EXPECT_THAT(error.what(), HasSubstr("\"a long line\" of 1000000x1"));
    }
    EXPECT_THROW(gpu::Image(device, {.format = VK_FORMAT_R8G8B8A8_UNORM,
                                     .width = 8,
                                     .height = 8,
                                     .samples = 64,
                                     .usage = VK_IMAGE_USAGE_COLOR_ATTACHMENT_BIT,
                                     .name = "64 samples"}),
                 Error);
}

using DeviceTexels = DeviceTest;

TEST_F(DeviceTexels, texel_buffers_read_as_whole_vectors)
{
    constexpr std::uint32_t kCount = 1000;
    std::vector<std::uint32_t> values(4 * kCount);
    for (std::uint32_t i = 0; i < values.size(); ++i) values[i] = std::bit_cast<std::uint32_t>(float(i) + 0.25f);
    const gpu::Buffer in = gpu::make_buffer(device(), values, "in");
    const gpu::TexelView words(device(), in, VK_FORMAT_R32G32B32A32_UINT);
    const gpu::TexelView numbers(device(), in, VK_FORMAT_R32G32B32A32_SFLOAT);
    const gpu::Buffer out(device(), {.size = 48 * kCount, .name = "out"});
    const gpu::ComputePipeline kernel(device(),
                                      {.shader = {device_shaders::find("device_texels.comp")}, .name = "texels"});
    const gpu::Bindings bindings(device(), kernel.layout(), {{0, words}, {1, numbers}, {2, numbers}, {3, out}});
    gpu::run(device(), [&](gpu::Commands& commands) {
        commands.bind(kernel, bindings);
        commands.push(kCount);
        commands.dispatch_over(kCount);
    });
    const auto read = gpu::read_back<std::uint32_t>(device(), out, 12 * kCount);
    for (std::uint32_t i = 0; i < kCount; ++i)
        for (std::uint32_t k = 0; k < 12; ++k) ASSERT_EQ(read[12 * i + k], values[4 * i + k % 4]) << i << ' ' << k;
}

TEST_F(DeviceTexels, a_view_of_a_range_starts_there)
{
    const gpu::Buffer in = gpu::make_buffer(device(), numbered(4096), "in");
    const gpu::TexelView part(device(), in, VK_FORMAT_R32G32B32A32_UINT, 256, 64);
    const gpu::Buffer out(device(), {.size = 48 * 4, .name = "out"});
    const gpu::ComputePipeline kernel(device(),
                                      {.shader = {device_shaders::find("device_texels.comp")}, .name = "texels"});
    const gpu::TexelView numbers(device(), in, VK_FORMAT_R32G32B32A32_SFLOAT);
    const gpu::Bindings bindings(device(), kernel.layout(), {{0, part}, {1, numbers}, {2, numbers}, {3, out}});
    gpu::run(device(), [&](gpu::Commands& commands) {
        commands.bind(kernel, bindings);
        commands.push(std::uint32_t{4});
        commands.dispatch_over(4);
    });
    EXPECT_EQ(gpu::read_back<std::uint32_t>(device(), out, 1)[0], numbered(65)[64]);
}

}  // namespace
}  // namespace etalon::test
