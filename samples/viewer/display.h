#pragma once
#include "engine/gpu/commands.h"
#include "engine/image/develop.h"
#include "engine/image/image.h"

namespace etalon {

/// Shows a linear picture on an 8-bit target: exposure, tone and sRGB on the device.
class Display {
 public:
    /// `format`: of the targets.
    Display(gpu::Device& device, VkFormat format);

    /// The picture (premultiplied linear RGBA, in use `sampled`) to show from now on; it must live until the next one
    /// is set. The device must be idle.
    void set_picture(const gpu::Image& picture);
    /// Records the pass that fills `target` with the picture, scaled.
    void record(gpu::Commands& commands, gpu::Image& target, const DevelopSettings& settings) const;

 private:
    gpu::Device& device_;
    gpu::GraphicsPipeline pipeline_;
    gpu::Sampler sampler_;
    gpu::Bindings bindings_;
};

/// The picture as a window of its size would show it: 4 channels, display-coded, opaque.
Image develop_on(gpu::Device& device, const gpu::Image& picture, const DevelopSettings& settings);

}  // namespace etalon
