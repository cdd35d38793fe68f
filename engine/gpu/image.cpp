#include "engine/gpu/image.h"

#include <fmt/format.h>

#include <algorithm>
#include <bit>

#include "engine/base/error.h"
#include "engine/gpu/buffer.h"
#include "engine/gpu/commands.h"
#include "engine/gpu/device_state.h"
#include "engine/gpu/gl_resources.h"

namespace etalon::gpu {
namespace {

/// Of single-sample images.
constexpr VkImageUsageFlags kAlways =
    VK_IMAGE_USAGE_TRANSFER_SRC_BIT | VK_IMAGE_USAGE_TRANSFER_DST_BIT | VK_IMAGE_USAGE_SAMPLED_BIT;

void check_limits(const DeviceState& state, const ImageSpec& spec, VkImageUsageFlags usage)
{
    const DeviceLimits& limits = state.limits;
    if (std::max(spec.width, spec.height) > limits.image_side || spec.layers > limits.image_layers)
        throw Error(
            Blame::machine,
            fmt::format("image \"{}\" of {}x{} in {} layers; this device allows {}x{} in {}", spec.name, spec.width,
                        spec.height, spec.layers, limits.image_side, limits.image_side, limits.image_layers),
            "use a smaller picture or texture");
    VkImageFormatProperties can{};
    const VkResult result = state.instance.vk.vkGetPhysicalDeviceImageFormatProperties(
        state.physical, spec.format, VK_IMAGE_TYPE_2D, VK_IMAGE_TILING_OPTIMAL, usage, 0, &can);
    if (result != VK_ERROR_FORMAT_NOT_SUPPORTED) check(result, "vkGetPhysicalDeviceImageFormatProperties");
    if (result != VK_SUCCESS || (can.sampleCounts & spec.samples) == 0)
        throw Error(Blame::machine,
                    fmt::format("image \"{}\": this device cannot use format {} with {} samples in this way", spec.name,
                                static_cast<int>(spec.format), spec.samples));
}

}  // namespace

void destroy_image(const DeviceState& state, VkImage image)
{
    state.vk.vkDestroyImage(state.device, image, state.instance.allocator);
}

void destroy_image_view(const DeviceState& state, VkImageView view)
{
    state.vk.vkDestroyImageView(state.device, view, state.instance.allocator);
}

void destroy_sampler(const DeviceState& state, VkSampler sampler)
{
    state.vk.vkDestroySampler(state.device, sampler, state.instance.allocator);
}

std::uint32_t texel_size(VkFormat format)
{
    switch (format) {
        case VK_FORMAT_R8_UNORM:
        case VK_FORMAT_R8_UINT:
            return 1;
        case VK_FORMAT_R8G8_UNORM:
        case VK_FORMAT_R16_UINT:
        case VK_FORMAT_R16_SFLOAT:
        case VK_FORMAT_D16_UNORM:
            return 2;
        case VK_FORMAT_R8G8B8A8_UNORM:
        case VK_FORMAT_R8G8B8A8_SRGB:
        case VK_FORMAT_B8G8R8A8_UNORM:
        case VK_FORMAT_B8G8R8A8_SRGB:
        case VK_FORMAT_R16G16_SFLOAT:
        case VK_FORMAT_R32_UINT:
        case VK_FORMAT_R32_SINT:
        case VK_FORMAT_R32_SFLOAT:
        case VK_FORMAT_D32_SFLOAT:
        case VK_FORMAT_X8_D24_UNORM_PACK32:
            return 4;
        case VK_FORMAT_R16G16B16A16_UNORM:
        case VK_FORMAT_R16G16B16A16_SFLOAT:
        case VK_FORMAT_R32G32_UINT:
        case VK_FORMAT_R32G32_SFLOAT:
            return 8;
        case VK_FORMAT_R32G32B32A32_UINT:
        case VK_FORMAT_R32G32B32A32_SFLOAT:
            return 16;
        default:
            throw Error(Blame::input, fmt::format("format {} has no known texel size", static_cast<int>(format)));
    }
}

std::uint32_t mip_count(std::uint32_t width, std::uint32_t height)
{
    return static_cast<std::uint32_t>(std::bit_width(std::max({width, height, 1u})));
}

Image::Image(Device& device, const ImageSpec& spec) : spec_(spec)
{
    assume(spec.width > 0 && spec.height > 0 && spec.layers > 0);
    if (spec_.mips == 0) spec_.mips = mip_count(spec.width, spec.height);
    if (GlDevice* gl = device.gl()) {
        gl_.reset(new GlImage(*gl, spec_));
        return;
    }
    const DeviceState& state = device.state();
    VkImageUsageFlags usage = spec.usage;
    if (spec.samples == 1) usage |= kAlways;
    check_limits(state, spec_, usage);
    const VkImageCreateInfo info{.sType = VK_STRUCTURE_TYPE_IMAGE_CREATE_INFO,
                                 .imageType = VK_IMAGE_TYPE_2D,
                                 .format = spec_.format,
                                 .extent = {spec_.width, spec_.height, 1},
                                 .mipLevels = spec_.mips,
                                 .arrayLayers = spec_.layers,
                                 .samples = static_cast<VkSampleCountFlagBits>(spec_.samples),
                                 .tiling = VK_IMAGE_TILING_OPTIMAL,
                                 .usage = usage};
    VkImage image = VK_NULL_HANDLE;
    check(state.vk.vkCreateImage(state.device, &info, state.instance.allocator, &image), "vkCreateImage");
    image_ = {state, image};
    VkMemoryRequirements needs{};
    state.vk.vkGetImageMemoryRequirements(state.device, image, &needs);
    memory_ = state.memory->allocate(needs, MemoryKind::device, false, spec_.name);
    check(state.vk.vkBindImageMemory(state.device, image, memory_.memory(), memory_.offset()), "vkBindImageMemory");
    make_view(device);
}

Image::Image(Device& device, VkImage image, const ImageSpec& spec)
    : image_(Owned<VkImage, destroy_image>::borrow(image)), spec_(spec)
{
    make_view(device);
}

void Image::make_view(Device& device)
{
    const DeviceState& state = device.state();
    const bool array = spec_.array || spec_.layers > 1;
    const VkImageViewCreateInfo info{.sType = VK_STRUCTURE_TYPE_IMAGE_VIEW_CREATE_INFO,
                                     .image = handle(),
                                     .viewType = array ? VK_IMAGE_VIEW_TYPE_2D_ARRAY : VK_IMAGE_VIEW_TYPE_2D,
                                     .format = spec_.format,
                                     .subresourceRange = {aspect(), 0, spec_.mips, 0, spec_.layers}};
    VkImageView view = VK_NULL_HANDLE;
    check(state.vk.vkCreateImageView(state.device, &info, state.instance.allocator, &view), "vkCreateImageView");
    view_ = {state, view};
    set_name(state, VK_OBJECT_TYPE_IMAGE, reinterpret_cast<std::uint64_t>(handle()), spec_.name);
}

VkImageAspectFlags Image::aspect() const
{
    const bool depth = spec_.format == VK_FORMAT_D32_SFLOAT || spec_.format == VK_FORMAT_X8_D24_UNORM_PACK32 ||
                       spec_.format == VK_FORMAT_D16_UNORM;
    return depth ? VK_IMAGE_ASPECT_DEPTH_BIT : VK_IMAGE_ASPECT_COLOR_BIT;
}

void upload(Device& device, Image& image, std::span<const ImagePart> parts, ImageUse after)
{
    std::uint64_t bytes = 0;
    for (const ImagePart& part : parts) {
        const std::uint64_t texels = std::uint64_t{image.width(part.mip)} * image.height(part.mip);
        assume(part.mip < image.mips() && part.layer < image.layers());
        assume(part.texels.size() == texels * texel_size(image.format()));
        bytes += part.texels.size();
    }
    const Buffer staging(device, {.size = bytes, .memory = MemoryKind::upload, .name = "texels"});
    run(device, [&](Commands& commands) {
        commands.prepare(image, ImageUse::copy_target);
        std::uint64_t offset = 0;
        for (const ImagePart& part : parts) {
            std::memcpy(staging.mapped().data() + offset, part.texels.data(), part.texels.size());
            commands.copy(staging, image, part.mip, part.layer, offset);
            offset += part.texels.size();
        }
        commands.prepare(image, after);
    });
}

std::vector<std::byte> download(Device& device, Image& image, std::uint32_t mip, std::uint32_t layer)
{
    assume(mip < image.mips() && layer < image.layers() && image.use() != ImageUse::undefined);
    const std::uint64_t bytes = std::uint64_t{image.width(mip)} * image.height(mip) * texel_size(image.format());
    const Buffer staging(device, {.size = bytes, .memory = MemoryKind::readback, .name = "texels"});
    const ImageUse before = image.use();
    run(device, [&](Commands& commands) {
        commands.prepare(image, ImageUse::copy_source);
        commands.copy(image, staging, mip, layer);
        commands.prepare(image, before);
    });
    const std::span<const std::byte> texels = staging.mapped().first(bytes);
    return {texels.begin(), texels.end()};
}

Sampler::Sampler(Device& device, const SamplerSpec& spec)
{
    if (GlDevice* gl = device.gl()) {
        gl_.reset(new GlSampler(*gl, spec));
        return;
    }
    const DeviceState& state = device.state();
    const float anisotropy = std::min(spec.anisotropy, state.limits.anisotropy);
    const VkSamplerCreateInfo info{.sType = VK_STRUCTURE_TYPE_SAMPLER_CREATE_INFO,
                                   .magFilter = spec.magnify,
                                   .minFilter = spec.minify,
                                   .mipmapMode = spec.mipmap,
                                   .addressModeU = spec.wrap_u,
                                   .addressModeV = spec.wrap_v,
                                   .addressModeW = VK_SAMPLER_ADDRESS_MODE_CLAMP_TO_EDGE,
                                   .anisotropyEnable = anisotropy > 1 ? VK_TRUE : VK_FALSE,
                                   .maxAnisotropy = anisotropy,
                                   .maxLod = spec.max_lod};
    VkSampler sampler = VK_NULL_HANDLE;
    check(state.vk.vkCreateSampler(state.device, &info, state.instance.allocator, &sampler), "vkCreateSampler");
    sampler_ = {state, sampler};
}

}  // namespace etalon::gpu
