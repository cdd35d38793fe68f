#pragma once
#include <functional>
#include <vector>

#include "engine/gpu/commands.h"
#include "engine/gpu/image.h"

namespace etalon::gpu {

void destroy_swapchain(const DeviceState& state, VkSwapchainKHR swapchain);
void destroy_semaphore(const DeviceState& state, VkSemaphore semaphore);

/// The pictures of the window whose surface the Device was made with. 8 bits a channel, UNORM: what is drawn is already
/// display-coded.
class Swapchain {
 public:
    /// `width`, `height`: pixels of the window, used where the surface does not say itself.
    Swapchain(Device& device, std::uint32_t width, std::uint32_t height);
    ~Swapchain();
    Swapchain(const Swapchain&) = delete;
    Swapchain& operator=(const Swapchain&) = delete;

    /// Takes the next picture, lets `record` fill it (it must leave it prepared as ImageUse::present) and shows it.
    /// False when there was nothing to draw on: the window is minimised, or has changed and resize() is due.
    bool draw(const std::function<void(Commands&, Image&)>& record);
    /// After the window changed size, or draw() said false. Does nothing while the window has no area.
    void resize(std::uint32_t width, std::uint32_t height);

    VkFormat format() const { return format_; }
    std::uint32_t width() const { return width_; }
    std::uint32_t height() const { return height_; }

 private:
    struct Frame;
    void release();

    Device& device_;
    Owned<VkSwapchainKHR, destroy_swapchain> swapchain_;
    std::vector<Image> images_;
    std::vector<Owned<VkSemaphore, destroy_semaphore>> drawn_;  // one per image: presentation waits for it
    std::vector<Frame> frames_;
    std::size_t next_frame_ = 0;
    VkFormat format_ = VK_FORMAT_UNDEFINED;
    std::uint32_t width_ = 0;
    std::uint32_t height_ = 0;
};

}  // namespace etalon::gpu
