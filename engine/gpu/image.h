#pragma once
#include <algorithm>
#include <cstddef>
#include <cstring>
#include <span>
#include <string>
#include <vector>

#include "engine/gpu/device.h"
#include "engine/gpu/gl_owned.h"
#include "engine/gpu/memory.h"
#include "engine/gpu/owned.h"

namespace etalon::gpu {

void destroy_image(const DeviceState& state, VkImage image);
void destroy_image_view(const DeviceState& state, VkImageView view);
void destroy_sampler(const DeviceState& state, VkSampler sampler);

/// What an image is about to be used for: its layout, and what barriers wait for.
enum class ImageUse { undefined, copy_source, copy_target, sampled, storage, color_target, depth_target, present };

struct ImageSpec {
    VkFormat format = VK_FORMAT_UNDEFINED;
    std::uint32_t width = 0;
    std::uint32_t height = 0;
    std::uint32_t layers = 1;
    std::uint32_t mips = 1;  ///< 0: all levels down to 1x1
    std::uint32_t samples = 1;
    bool array = false;           ///< view it as a 2D array even with one layer
    VkImageUsageFlags usage = 0;  ///< single-sample images may always be copied and sampled too
    std::string name;
};

/// A 2D image or array of them, with one view of it all. It remembers its use as of the last recorded command, so that
/// barriers need only name the next one (Commands::prepare): record in the order of submission.
class Image {
 public:
    Image() = default;
    /// Throws Error(machine) when over the memory budget, the device's limits or what the format can do.
    Image(Device& device, const ImageSpec& spec);
    /// An image that someone else owns (a swapchain's) under a view of ours.
    Image(Device& device, VkImage image, const ImageSpec& spec);

    VkImage handle() const { return image_.get(); }
    VkImageView view() const { return view_.get(); }
    VkFormat format() const { return spec_.format; }
    std::uint32_t width(std::uint32_t mip = 0) const { return std::max(1u, spec_.width >> mip); }
    std::uint32_t height(std::uint32_t mip = 0) const { return std::max(1u, spec_.height >> mip); }
    std::uint32_t layers() const { return spec_.layers; }
    std::uint32_t mips() const { return spec_.mips; }
    std::uint32_t samples() const { return spec_.samples; }
    VkImageAspectFlags aspect() const;
    explicit operator bool() const { return image_ || gl_; }
    /// By OpenGL; null by Vulkan.
    GlImage* gl() const { return gl_.get(); }

    ImageUse use() const { return use_; }
    void set_use(ImageUse use) { use_ = use; }

 private:
    void make_view(Device& device);

    Allocation memory_;
    Owned<VkImage, destroy_image> image_;
    Owned<VkImageView, destroy_image_view> view_;
    ImageSpec spec_;
    ImageUse use_ = ImageUse::undefined;
    GlOwned<GlImage> gl_;
};

/// Bytes of one texel of an uncompressed format this project uses; Error(input) for others.
std::uint32_t texel_size(VkFormat format);
/// Levels of a full mip chain.
std::uint32_t mip_count(std::uint32_t width, std::uint32_t height);

/// The texels of one level of one layer, rows from the top, tightly packed.
struct ImagePart {
    std::span<const std::byte> texels;
    std::uint32_t mip = 0;
    std::uint32_t layer = 0;
};

/// Writes whole levels in one submission and leaves the image `after`; returns when done.
void upload(Device& device, Image& image, std::span<const ImagePart> parts, ImageUse after = ImageUse::sampled);
/// One level of one layer, tightly packed; the image returns to the use it had.
std::vector<std::byte> download(Device& device, Image& image, std::uint32_t mip = 0, std::uint32_t layer = 0);
template <class T>
std::vector<T> download_as(Device& device, Image& image, std::uint32_t mip = 0, std::uint32_t layer = 0)
{
    const std::vector<std::byte> bytes = download(device, image, mip, layer);
    std::vector<T> values(bytes.size() / sizeof(T));
    std::memcpy(values.data(), bytes.data(), values.size() * sizeof(T));
    return values;
}

struct SamplerSpec {
    VkFilter magnify = VK_FILTER_LINEAR;
    VkFilter minify = VK_FILTER_LINEAR;
    VkSamplerMipmapMode mipmap = VK_SAMPLER_MIPMAP_MODE_LINEAR;
    VkSamplerAddressMode wrap_u = VK_SAMPLER_ADDRESS_MODE_REPEAT;
    VkSamplerAddressMode wrap_v = VK_SAMPLER_ADDRESS_MODE_REPEAT;
    float max_lod = VK_LOD_CLAMP_NONE;  ///< 0: level 0 alone
    float anisotropy = 1;               ///< clamped to the device's
    bool operator==(const SamplerSpec&) const = default;
};

class Sampler {
 public:
    Sampler() = default;
    Sampler(Device& device, const SamplerSpec& spec);
    VkSampler handle() const { return sampler_.get(); }
    /// By OpenGL; null by Vulkan.
    GlSampler* gl() const { return gl_.get(); }

 private:
    GlOwned<GlSampler> gl_;
    Owned<VkSampler, destroy_sampler> sampler_;
};

}  // namespace etalon::gpu
