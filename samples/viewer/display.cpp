#include "samples/viewer/display.h"

#include <cmath>

#include "engine/math/types.h"
#include "etalon_shaders.h"

namespace etalon {
namespace {

/// Push constants of shaders/post/display.frag.
struct DisplayPush {
    vec2 size;
    float exposure;
    std::uint32_t tone;
};

}  // namespace

Display::Display(gpu::Device& device, VkFormat format)
    : device_(device),
      pipeline_(device, {.vertex = {etalon_shaders::find("raster/screen.vert")},
                         .fragment = {etalon_shaders::find("post/display.frag")},
                         .colors = {{format}},
                         .cull = VK_CULL_MODE_NONE,
                         .name = "display"}),
      sampler_(device, {.wrap_u = VK_SAMPLER_ADDRESS_MODE_CLAMP_TO_EDGE,
                        .wrap_v = VK_SAMPLER_ADDRESS_MODE_CLAMP_TO_EDGE,
                        .max_lod = 0})
{}

void Display::set_picture(const gpu::Image& picture)
{
    bindings_ = gpu::Bindings(device_, pipeline_.layout(), {{0, picture, sampler_}});
}

void Display::record(gpu::Commands& commands, gpu::Image& target, const DevelopSettings& settings) const
{
    const gpu::ColorTarget color{.image = &target, .clear = VkClearColorValue{}};
    commands.begin_rendering(std::span(&color, 1));
    commands.bind(pipeline_);
    commands.bind(bindings_);
    commands.push(DisplayPush{vec2(target.width(), target.height()), static_cast<float>(std::exp2(settings.exposure)),
                              static_cast<std::uint32_t>(settings.tone)});
    commands.draw(3);
    commands.end_rendering();
}

Image develop_on(gpu::Device& device, const gpu::Image& picture, const DevelopSettings& settings)
{
    gpu::Image target(device, {.format = VK_FORMAT_R8G8B8A8_UNORM,
                               .width = picture.width(),
                               .height = picture.height(),
                               .usage = VK_IMAGE_USAGE_COLOR_ATTACHMENT_BIT,
                               .name = "screenshot"});
    Display display(device, target.format());
    display.set_picture(picture);
    gpu::run(device, [&](gpu::Commands& commands) { display.record(commands, target, settings); });
    Image out(static_cast<int>(target.width()), static_cast<int>(target.height()), 4);
    const auto codes = gpu::download_as<std::uint8_t>(device, target);
    for (std::size_t i = 0; i < codes.size(); ++i) out.values[i] = static_cast<float>(codes[i]) / 255.f;
    return out;
}

}  // namespace etalon
