#include "engine/gpu/swapchain.h"

#include <algorithm>
#include <limits>

#include "engine/base/error.h"
#include "engine/gpu/device_state.h"

namespace etalon::gpu {
namespace {

constexpr std::size_t kFramesInFlight = 2;
constexpr std::uint64_t kAcquireTimeout = 1'000'000'000;  // ns; a compositor may hold all pictures of a hidden window

VkSurfaceFormatKHR pick_format(const DeviceState& state)
{
    const auto& vk = state.instance.vk;
    std::uint32_t count = 0;
    check(vk.vkGetPhysicalDeviceSurfaceFormatsKHR(state.physical, state.instance.surface, &count, nullptr),
          "vkGetPhysicalDeviceSurfaceFormatsKHR");
    std::vector<VkSurfaceFormatKHR> formats(count);
    check(vk.vkGetPhysicalDeviceSurfaceFormatsKHR(state.physical, state.instance.surface, &count, formats.data()),
          "vkGetPhysicalDeviceSurfaceFormatsKHR");
    for (const VkFormat wanted : {VK_FORMAT_B8G8R8A8_UNORM, VK_FORMAT_R8G8B8A8_UNORM})
        for (const VkSurfaceFormatKHR& format : formats)
            if (format.format == wanted && format.colorSpace == VK_COLOR_SPACE_SRGB_NONLINEAR_KHR) return format;
    throw Error(Blame::machine, "the window shows no 8-bit sRGB format that this program knows");
}

Owned<VkSemaphore, destroy_semaphore> make_semaphore(const DeviceState& state)
{
    const VkSemaphoreCreateInfo info{.sType = VK_STRUCTURE_TYPE_SEMAPHORE_CREATE_INFO};
    VkSemaphore semaphore = VK_NULL_HANDLE;
    check(state.vk.vkCreateSemaphore(state.device, &info, state.instance.allocator, &semaphore), "vkCreateSemaphore");
    return {state, semaphore};
}

std::vector<VkImage> swapchain_images(const DeviceState& state, VkSwapchainKHR swapchain)
{
    std::uint32_t count = 0;
    check(state.vk.vkGetSwapchainImagesKHR(state.device, swapchain, &count, nullptr), "vkGetSwapchainImagesKHR");
    std::vector<VkImage> images(count);
    check(state.vk.vkGetSwapchainImagesKHR(state.device, swapchain, &count, images.data()), "vkGetSwapchainImagesKHR");
    return images;
}

}  // namespace

/// One picture under way: what must not be touched before it is done.
struct Swapchain::Frame {
    Owned<VkSemaphore, destroy_semaphore> acquired;
    std::optional<Commands> commands;
};

void destroy_swapchain(const DeviceState& state, VkSwapchainKHR swapchain)
{
    state.vk.vkDestroySwapchainKHR(state.device, swapchain, state.instance.allocator);
}

void destroy_semaphore(const DeviceState& state, VkSemaphore semaphore)
{
    state.vk.vkDestroySemaphore(state.device, semaphore, state.instance.allocator);
}

Swapchain::Swapchain(Device& device, std::uint32_t width, std::uint32_t height) : device_(device)
{
    assume(device.surface() != VK_NULL_HANDLE);
    format_ = pick_format(device.state()).format;
    resize(width, height);
}

Swapchain::~Swapchain()
{
    release();
}

void Swapchain::release()
{
    frames_.clear();  // waits for what is under way
    const DeviceState& state = device_.state();
    // Not only our work: presentation of the last pictures too.
    const std::lock_guard lock(device_.state().queue_mutex);
    static_cast<void>(state.vk.vkQueueWaitIdle(state.queue));
    images_.clear();
    drawn_.clear();
}

void Swapchain::resize(std::uint32_t width, std::uint32_t height)
{
    const DeviceState& state = device_.state();
    release();
    VkSurfaceCapabilitiesKHR surface{};
    check(state.instance.vk.vkGetPhysicalDeviceSurfaceCapabilitiesKHR(state.physical, device_.surface(), &surface),
          "vkGetPhysicalDeviceSurfaceCapabilitiesKHR");
    constexpr std::uint32_t kUpToUs = std::numeric_limits<std::uint32_t>::max();
    const bool fixed = surface.currentExtent.width != kUpToUs;
    width_ = fixed ? surface.currentExtent.width
                   : std::clamp(width, surface.minImageExtent.width, surface.maxImageExtent.width);
    height_ = fixed ? surface.currentExtent.height
                    : std::clamp(height, surface.minImageExtent.height, surface.maxImageExtent.height);
    if (width_ == 0 || height_ == 0) {
        swapchain_ = {};
        return;
    }
    const VkSurfaceFormatKHR format = pick_format(state);
    const std::uint32_t most = surface.maxImageCount == 0 ? kUpToUs : surface.maxImageCount;
    const VkImageUsageFlags usage = VK_IMAGE_USAGE_COLOR_ATTACHMENT_BIT | VK_IMAGE_USAGE_TRANSFER_DST_BIT;
    if ((surface.supportedUsageFlags & usage) != usage)
        throw Error(Blame::machine, "the window's pictures cannot be copied to");
    const VkSwapchainCreateInfoKHR info{.sType = VK_STRUCTURE_TYPE_SWAPCHAIN_CREATE_INFO_KHR,
                                        .surface = device_.surface(),
                                        .minImageCount = std::min(surface.minImageCount + 1, most),
                                        .imageFormat = format.format,
                                        .imageColorSpace = format.colorSpace,
                                        .imageExtent = {width_, height_},
                                        .imageArrayLayers = 1,
                                        .imageUsage = usage,
                                        .imageSharingMode = VK_SHARING_MODE_EXCLUSIVE,
                                        .preTransform = surface.currentTransform,
                                        .compositeAlpha = VK_COMPOSITE_ALPHA_OPAQUE_BIT_KHR,
                                        .presentMode = VK_PRESENT_MODE_FIFO_KHR,
                                        .clipped = VK_TRUE,
                                        .oldSwapchain = swapchain_.get()};
    VkSwapchainKHR swapchain = VK_NULL_HANDLE;
    check(state.vk.vkCreateSwapchainKHR(state.device, &info, state.instance.allocator, &swapchain),
          "vkCreateSwapchainKHR");
    swapchain_ = Owned<VkSwapchainKHR, destroy_swapchain>(state, swapchain);

    const ImageSpec spec{.format = format.format, .width = width_, .height = height_, .name = "window"};
    for (VkImage image : swapchain_images(state, swapchain)) {
        images_.emplace_back(device_, image, spec);
        drawn_.push_back(make_semaphore(state));
    }
    for (std::size_t i = 0; i < kFramesInFlight; ++i) frames_.push_back({.acquired = make_semaphore(state)});
    next_frame_ = 0;
}

bool Swapchain::draw(const std::function<void(Commands&, Image&)>& record)
{
    if (!swapchain_) return false;
    DeviceState& state = device_.state();
    Frame& frame = frames_[next_frame_];
    frame.commands.reset();  // waits until its last picture is done, so that its semaphore is free
    std::uint32_t index = 0;
    const VkResult acquired = state.vk.vkAcquireNextImageKHR(state.device, swapchain_.get(), kAcquireTimeout,
                                                             frame.acquired.get(), VK_NULL_HANDLE, &index);
    if (acquired == VK_ERROR_OUT_OF_DATE_KHR || acquired == VK_TIMEOUT || acquired == VK_NOT_READY) return false;
    check(acquired, "vkAcquireNextImageKHR");
    next_frame_ = (next_frame_ + 1) % frames_.size();

    frame.commands.emplace(device_, "window");
    images_[index].set_use(ImageUse::undefined);
    record(*frame.commands, images_[index]);
    assume(images_[index].use() == ImageUse::present);
    frame.commands->submit(frame.acquired.get(), drawn_[index].get());

    const VkSemaphore done = drawn_[index].get();
    const VkSwapchainKHR swapchain = swapchain_.get();
    const VkPresentInfoKHR info{.sType = VK_STRUCTURE_TYPE_PRESENT_INFO_KHR,
                                .waitSemaphoreCount = 1,
                                .pWaitSemaphores = &done,
                                .swapchainCount = 1,
                                .pSwapchains = &swapchain,
                                .pImageIndices = &index};
    const std::lock_guard lock(state.queue_mutex);
    const VkResult presented = state.vk.vkQueuePresentKHR(state.queue, &info);
    if (presented == VK_ERROR_OUT_OF_DATE_KHR || presented == VK_SUBOPTIMAL_KHR) return false;
    check(presented, "vkQueuePresentKHR");
    return true;
}

}  // namespace etalon::gpu
