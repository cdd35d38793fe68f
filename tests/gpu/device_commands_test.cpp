// Pipelines, bindings and recorded work.
#include <algorithm>
#include <array>
#include <bit>
#include <thread>

#include "device_shaders.h"
#include "engine/base/error.h"
#include "tests/gpu/device_test.h"

namespace etalon::test {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

gpu::ComputePipeline make_counting(gpu::Device& device)
{
    return {device, {.shader = {device_shaders::find("device_count.comp")}, .name = "count"}};
}

using DeviceCommands = DeviceTest;

TEST_F(DeviceCommands, a_list_may_be_submitted_again)
{
    const gpu::ComputePipeline kernel = make_counting(device());
    const gpu::Buffer counter = gpu::make_buffer(device(), std::vector<std::uint32_t>{0}, "counter");
    const gpu::Bindings bindings(device(), kernel.layout(), {{0, counter}});
    gpu::Commands commands(device(), "again");
    commands.bind(kernel, bindings);
    commands.dispatch_over(1);  // one group: 64 invocations
    commands.barrier(gpu::Work::compute, gpu::Work::compute);
    commands.dispatch(2);
    for (int i = 0; i < 5; ++i) commands.submit();
    commands.wait();
    EXPECT_EQ(gpu::read_back<std::uint32_t>(device(), counter, 1)[0], 5u * 3u * 64u);
}

TEST_F(DeviceCommands, dispatches_as_many_groups_as_a_buffer_says)
{
    const gpu::ComputePipeline kernel = make_counting(device());
    const gpu::Buffer counter = gpu::make_buffer(device(), std::vector<std::uint32_t>{0}, "counter");
    const gpu::Buffer groups = gpu::make_buffer(device(), std::vector<std::uint32_t>{9, 0, 0, 1, 1}, "groups");
    const gpu::Bindings bindings(device(), kernel.layout(), {{0, counter}});
    gpu::run(device(), [&](gpu::Commands& commands) {
        commands.fill(groups, 5, 8, 4);
        commands.barrier(gpu::Work::copy, gpu::Work::indirect);
        commands.bind(kernel, bindings);
        commands.dispatch_indirect(groups, 8);
    });
    EXPECT_EQ(gpu::read_back<std::uint32_t>(device(), counter, 1)[0], 5u * 64u);
}

TEST_F(DeviceCommands, specialization_push_constants_and_sets_arrive)
{
    const gpu::ComputePipeline kernel(device(), {.shader = {device_shaders::find("device_constants.comp"),
                                                            {{0, true}, {1, -5}, {2, 0xfffffff0u}, {7, 2.5f}}},
                                                 .name = "constants"});
    EXPECT_EQ(kernel.workgroup(0), 8u);
    EXPECT_EQ(kernel.workgroup(1), 4u);
    EXPECT_EQ(kernel.layout().push_constants(), 16u);
    const gpu::Buffer results(device(), {.size = 40, .name = "results"});
    const gpu::Buffer block = gpu::make_buffer(device(), std::vector<float>{1, 2, 3, 4}, "block");
    std::array<gpu::Image, 2> images;
    for (std::size_t i = 0; i < images.size(); ++i) {
        images[i] = gpu::Image(device(), {.format = VK_FORMAT_R32_SFLOAT,
                                          .width = 1,
                                          .height = 1,
                                          .usage = VK_IMAGE_USAGE_SAMPLED_BIT,
                                          .name = "texture"});
        const float texel = 10.f * static_cast<float>(i + 1);
        const gpu::ImagePart part{.texels = std::as_bytes(std::span(&texel, 1))};
        gpu::upload(device(), images[i], std::span(&part, 1));
    }
    const gpu::Sampler sampler(device(), {});
    const gpu::Bindings set0(device(), kernel.layout(),
                             {{3, results}, {99, block}});  // 99: another kernel's, passed over
    const gpu::Bindings set2(
        device(), kernel.layout(),
        {{0, block}, {1, std::vector<gpu::ImageBinding>{{&images[0], &sampler}, {&images[1], &sampler}}}}, 2);
    struct Push {
        float pushed[3];
        std::uint32_t last;
    };
    gpu::run(device(), [&](gpu::Commands& commands) {
        commands.bind(kernel, set0);
        commands.bind(set2);
        commands.push(Push{{1, 2, 3.5f}, 77});
        commands.dispatch(1);
    });
    const auto bits = [](float value) { return std::bit_cast<std::uint32_t>(value); };
    EXPECT_THAT(gpu::read_back<std::uint32_t>(device(), results, 10),
                ElementsAre(1u, 0xfffffffbu, 0xfffffff0u, bits(2.5f), bits(3.5f), 77u, bits(4), bits(10), bits(20),
                            bits(20)));  // the rest of the array repeats its last image
}

TEST_F(DeviceCommands, a_binding_that_is_missing_or_wrong_is_named)
{
    const gpu::ComputePipeline kernel(device(),
                                      {.shader = {device_shaders::find("device_texels.comp")}, .name = "texels"});
    const gpu::Buffer buffer(device(), {.size = 64, .name = "buffer"});
    const gpu::TexelView view(device(), buffer, VK_FORMAT_R32G32B32A32_UINT);
    const auto message = [&](const std::vector<gpu::Bind>& binds) {
        try {
            const gpu::Bindings bindings(device(), kernel.layout(), binds);
        } catch (const Error& error) {
            return error.message();
        }
        return std::string("no error");
    };
    EXPECT_THAT(message({{0, view}, {1, view}, {2, view}}),
                HasSubstr("pipeline \"texels\": nothing was given for set 0, binding 3, which wants a buffer"));
    EXPECT_THAT(message({{0, buffer}, {1, view}, {2, view}, {3, buffer}}), HasSubstr("binding 0 wants a texel view"));
    EXPECT_THAT(message({{0, view}, {1, view}, {2, view}, {3, view}}), HasSubstr("binding 3 wants a buffer"));
}

TEST_F(DeviceCommands, a_pipeline_without_its_shader_is_an_error_that_names_it)
{
    const std::vector<std::uint32_t> garbage = {1, 2, 3, 4, 5, 6, 7, 8};
    for (const std::span<const std::uint32_t> code : {device_shaders::find("no such"), std::span(garbage).first(8)}) {
        try {
            const gpu::ComputePipeline kernel(device(), {.shader = {code}, .name = "the kernel"});
            ADD_FAILURE();
        } catch (const Error& error) {
            EXPECT_THAT(error.message(), HasSubstr("the kernel"));
        }
    }
    EXPECT_THROW(gpu::ComputePipeline(
                     device(), {.shader = {device_shaders::find("device_slope.vert")}, .name = "a vertex shader"}),
                 Error);
}

TEST_F(DeviceCommands, regions_are_timed_also_inside_rendering_and_when_nested)
{
    const gpu::ComputePipeline kernel = make_counting(device());
    const gpu::Buffer counter = gpu::make_buffer(device(), std::vector<std::uint32_t>{0}, "counter");
    const gpu::Bindings bindings(device(), kernel.layout(), {{0, counter}});
    gpu::Image image(device(), {.format = VK_FORMAT_R8G8B8A8_UNORM,
                                .width = 8,
                                .height = 8,
                                .usage = VK_IMAGE_USAGE_COLOR_ATTACHMENT_BIT,
                                .name = "target"});
    gpu::Commands commands(device(), "timed");
    const gpu::ColorTarget target{.image = &image, .clear = VkClearColorValue{}};
    commands.begin_rendering(std::span(&target, 1));
    commands.begin_region("draw");
    commands.end_region();
    commands.end_rendering();
    commands.begin_region("outer");
    commands.begin_region("inner");
    commands.bind(kernel, bindings);
    commands.dispatch(1000);
    commands.end_region();
    commands.end_region();
    for (int i = 0; i < 2; ++i) {
        commands.submit();
        commands.wait();
        const std::vector<gpu::RegionTime> times = commands.times();
        if (device().limits().timestamp_ns == 0) GTEST_SKIP() << "this device has no timestamps";
        ASSERT_EQ(times.size(), 3u);
        EXPECT_EQ(times[0].name, "draw");
        EXPECT_EQ(times[1].name, "outer");
        EXPECT_EQ(times[2].name, "inner");
        EXPECT_GT(times[2].milliseconds, 0);
        EXPECT_GE(times[1].milliseconds, times[2].milliseconds);
    }
}

TEST_F(DeviceCommands, work_from_several_threads_is_all_done)
{
    const gpu::ComputePipeline kernel = make_counting(device());
    const gpu::Buffer counter = gpu::make_buffer(device(), std::vector<std::uint32_t>{0}, "counter");
    const gpu::Bindings bindings(device(), kernel.layout(), {{0, counter}});
    std::vector<std::thread> threads;
    for (int t = 0; t < 4; ++t)
        threads.emplace_back([&] {
            for (int i = 0; i < 10; ++i) {
                const gpu::Buffer scratch(device(), {.size = 1000, .name = "scratch"});
                gpu::run(device(), [&](gpu::Commands& commands) {
                    commands.fill(scratch, 1);
                    commands.bind(kernel, bindings);
                    commands.dispatch(1);
                });
            }
        });
    for (std::thread& thread : threads) thread.join();
    EXPECT_EQ(gpu::read_back<std::uint32_t>(device(), counter, 1)[0], 40u * 64u);
}

TEST_F(DeviceCommands, waiting_has_an_end)
{
    try {
        device().wait(12345, std::chrono::milliseconds(20));  // nobody will ever submit that
        ADD_FAILURE();
    } catch (const Error& error) {
        EXPECT_EQ(error.blame(), Blame::machine);
        EXPECT_THAT(error.what(), HasSubstr("did not finish"));
    }
    EXPECT_FALSE(device().finished(12345));
}

struct Corner {
    float position[2];
    float color[3];
};

/// One clockwise triangle (in pixels, y down) over the lower left half, red at the top, green below.
const std::vector<Corner> kHalf = {{{-1, -1}, {1, 0, 0}}, {{1, 1}, {0, 1, 0}}, {{-1, 1}, {0, 1, 0}}};

TEST_F(DeviceCommands, draws_with_samples_resolve_culling_and_integer_targets)
{
    constexpr std::uint32_t kSide = 16;
    constexpr VkFormat kColor = VK_FORMAT_R32G32B32A32_SFLOAT;
    const auto make = [&](VkFormat format, std::uint32_t samples, VkImageUsageFlags usage) {
        return gpu::Image(
            device(),
            {.format = format, .width = kSide, .height = kSide, .samples = samples, .usage = usage, .name = "target"});
    };
    gpu::Image color = make(kColor, 4, VK_IMAGE_USAGE_COLOR_ATTACHMENT_BIT);
    gpu::Image resolved = make(kColor, 1, VK_IMAGE_USAGE_COLOR_ATTACHMENT_BIT);
    gpu::Image ids = make(VK_FORMAT_R32_UINT, 4, VK_IMAGE_USAGE_COLOR_ATTACHMENT_BIT);
    gpu::Image resolved_ids = make(VK_FORMAT_R32_UINT, 1, VK_IMAGE_USAGE_COLOR_ATTACHMENT_BIT);
    gpu::Image depth = make(VK_FORMAT_D32_SFLOAT, 4, VK_IMAGE_USAGE_DEPTH_STENCIL_ATTACHMENT_BIT);
    gpu::Image resolved_depth = make(VK_FORMAT_D32_SFLOAT, 1, VK_IMAGE_USAGE_DEPTH_STENCIL_ATTACHMENT_BIT);
    const gpu::GraphicsPipeline pipeline(
        device(), {.vertex = {device_shaders::find("device_slope.vert")},
                   .fragment = {device_shaders::find("device_slope.frag")},
                   .streams = {{sizeof(Corner)}},
                   .attributes = {{0, VK_FORMAT_R32G32_SFLOAT, 0, 0}, {1, VK_FORMAT_R32G32B32_SFLOAT, 0, 8}},
                   .colors = {{kColor, gpu::Blend::premultiplied}, {VK_FORMAT_R32_UINT}},
                   .depth = {.format = VK_FORMAT_D32_SFLOAT},
                   .samples = 4,
                   .name = "slope"});
    const gpu::Buffer corners = gpu::make_buffer(device(), kHalf, "corners");
    const gpu::Buffer indices = gpu::make_buffer(device(), std::vector<std::uint32_t>{0, 1, 2}, "indices");
    for (const bool seen : {true, false}) {
        gpu::run(device(), [&](gpu::Commands& commands) {
            const gpu::ColorTarget targets[] = {
                {.image = &color, .clear = VkClearColorValue{{0, 0, 1, 0}}, .resolve = &resolved, .store = false},
                {.image = &ids, .clear = VkClearColorValue{}, .resolve = &resolved_ids, .store = false}};
            commands.begin_rendering(targets, gpu::DepthTarget{.image = &depth, .resolve = &resolved_depth});
            commands.bind(pipeline);
            commands.set_cull(VK_CULL_MODE_BACK_BIT, seen ? VK_FRONT_FACE_CLOCKWISE : VK_FRONT_FACE_COUNTER_CLOCKWISE);
            commands.bind_vertices(0, corners);
            commands.bind_indices(indices);
            commands.draw_indexed(3);
            commands.end_rendering();
        });
        const auto pixels = gpu::download_as<std::array<float, 4>>(device(), resolved);
        const auto numbers = gpu::download_as<std::uint32_t>(device(), resolved_ids);
        const auto depths = gpu::download_as<float>(device(), resolved_depth);
        for (std::uint32_t y = 0; y < kSide; ++y)
            for (std::uint32_t x = 0; x < kSide; ++x) {
                const std::array<float, 4>& pixel = pixels[y * kSide + x];
                const bool covered = seen && x < y;
                if (seen && x == y) {  // the diagonal crosses these: some of the four samples are covered
                    EXPECT_THAT(pixel[3], testing::AnyOf(0.25f, 0.5f, 0.75f)) << x << ',' << y;
                    continue;
                }
                EXPECT_EQ(pixel[3], covered ? 1.f : 0.f) << x << ',' << y;
                EXPECT_EQ(pixel[2], covered ? 0.f : 1.f) << x << ',' << y;
                EXPECT_EQ(numbers[y * kSide + x], covered ? 7u : 0u) << x << ',' << y;
                EXPECT_EQ(depths[y * kSide + x], covered ? 0.5f : 0.f) << x << ',' << y;
                const float green = covered ? (float(y) + 0.5f) / kSide : 0.f;
                EXPECT_NEAR(pixel[1], green, 1e-3f) << x << ',' << y;
            }
    }
}

TEST_F(DeviceCommands, blits_scale_and_clears_fill)
{
    const auto make = [&](std::uint32_t side) {
        return gpu::Image(device(),
                          {.format = VK_FORMAT_R32G32B32A32_SFLOAT, .width = side, .height = side, .name = "picture"});
    };
    gpu::Image small = make(2);
    gpu::Image large = make(8);
    gpu::run(device(), [&](gpu::Commands& commands) {
        commands.prepare(small, gpu::ImageUse::copy_target);
        commands.clear(small, VkClearColorValue{{0.25f, 0.5f, 0.75f, 1}});
        commands.prepare(small, gpu::ImageUse::copy_source);
        commands.prepare(large, gpu::ImageUse::copy_target);
        commands.blit(small, large, VK_FILTER_NEAREST);
    });
    for (const auto& pixel : gpu::download_as<std::array<float, 4>>(device(), large))
        EXPECT_THAT(pixel, ElementsAre(0.25f, 0.5f, 0.75f, 1.f));
}

TEST_F(DeviceCommands, says_which_formats_can_do_what)
{
    EXPECT_TRUE(device().supports(VK_FORMAT_R8G8B8A8_UNORM, VK_FORMAT_FEATURE_SAMPLED_IMAGE_FILTER_LINEAR_BIT));
    EXPECT_TRUE(device().supports(VK_FORMAT_R32G32B32A32_SFLOAT, VK_FORMAT_FEATURE_COLOR_ATTACHMENT_BIT, 4));
    EXPECT_FALSE(device().supports(VK_FORMAT_D32_SFLOAT, VK_FORMAT_FEATURE_COLOR_ATTACHMENT_BIT));
    EXPECT_FALSE(device().supports(VK_FORMAT_R8G8B8A8_UNORM, VK_FORMAT_FEATURE_COLOR_ATTACHMENT_BIT, 64));
}

}  // namespace
}  // namespace etalon::test
