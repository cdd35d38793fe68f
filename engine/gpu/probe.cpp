#include "engine/gpu/probe.h"

#include <fmt/format.h>

#include <algorithm>

#include "engine/base/error.h"
#include "engine/gpu/commands.h"
#include "etalon_shaders.h"

namespace etalon::gpu {
namespace {

constexpr std::uint32_t kSide = 64;
constexpr std::uint32_t kPixels = kSide * kSide;

/// What the three shaders of shaders/gpu must leave in pixel `index`.
std::uint32_t expected(std::uint32_t index)
{
    const bool inside = index % kSide + index / kSide + 1 < kSide;  // pixel centres of the triangle x + y < 63.5
    return (inside ? index + 1 : 0) * 1664525u + index;
}

std::vector<std::uint32_t> draw_and_compute(Device& device, std::chrono::milliseconds limit)
{
    const GraphicsPipeline triangle(device, {.vertex = {etalon_shaders::find("gpu/probe.vert")},
                                             .fragment = {etalon_shaders::find("gpu/probe.frag")},
                                             .colors = {{VK_FORMAT_R32_UINT}},
                                             .cull = VK_CULL_MODE_NONE,
                                             .name = "probe triangle"});
    const ComputePipeline scramble(device, {.shader = {etalon_shaders::find("gpu/probe.comp")}, .name = "probe"});
    Image picture(device, {.format = VK_FORMAT_R32_UINT,
                           .width = kSide,
                           .height = kSide,
                           .usage = VK_IMAGE_USAGE_COLOR_ATTACHMENT_BIT,
                           .name = "probe picture"});
    const Buffer pixels(device, {.size = kPixels * sizeof(std::uint32_t), .name = "probe pixels"});
    const Bindings bindings(device, scramble.layout(), {{0, pixels}});
    const ColorTarget target{.image = &picture, .clear = VkClearColorValue{}};

    const auto record = [&](Commands& commands) {
        commands.begin_rendering(std::span(&target, 1));
        commands.bind(triangle);
        commands.draw(3);
        commands.end_rendering();
        commands.prepare(picture, ImageUse::copy_source);
        commands.copy(picture, pixels, 0, 0);
        commands.barrier(Work::copy, Work::compute);
        commands.bind(scramble, bindings);
        commands.dispatch_over(kPixels);
    };
    run(device, record, limit);
    return read_back<std::uint32_t>(device, pixels, kPixels);
}

}  // namespace

ProbeResult probe(Device& device, std::chrono::milliseconds limit)
{
    ProbeResult result;
    const auto start = std::chrono::steady_clock::now();
    try {
        const std::vector<std::uint32_t> pixels = draw_and_compute(device, limit);
        std::uint32_t right = 0;
        for (std::uint32_t i = 0; i < kPixels; ++i) right += pixels[i] == expected(i) ? 1 : 0;
        result.works = right == kPixels;
        result.detail =
            fmt::format("{} of {} pixels of a triangle drawn, computed on and read back as expected", right, kPixels);
    } catch (const Error& error) {
        result.detail = error.what();
    }
    result.milliseconds = std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count();
    return result;
}

}  // namespace etalon::gpu
