// The part of Commands that copies, fills and clears.
#include "engine/base/error.h"
#include "engine/gpu/commands.h"
#include "engine/gpu/device_state.h"
#include "engine/gpu/gl_commands.h"

namespace etalon::gpu {
namespace {

VkBufferImageCopy copy_region(const Image& image, std::uint32_t mip, std::uint32_t layer, std::uint64_t offset)
{
    return {.bufferOffset = offset,
            .imageSubresource = {image.aspect(), mip, layer, 1},
            .imageExtent = {image.width(mip), image.height(mip), 1}};
}

}  // namespace

void Commands::fill(const Buffer& buffer, std::uint32_t word, std::uint64_t offset, std::uint64_t size)
{
    if (gl_) return gl_->fill(*buffer.gl(), word, offset, size == VK_WHOLE_SIZE ? buffer.size() - offset : size);
    state_->vk.vkCmdFillBuffer(buffer_, buffer.handle(), offset, size, word);
}

void Commands::copy(const Buffer& from, const Buffer& to, std::uint64_t size, std::uint64_t from_offset,
                    std::uint64_t to_offset)
{
    assume(from_offset + size <= from.size() && to_offset + size <= to.size());
    if (gl_) return gl_->copy(*from.gl(), *to.gl(), size, from_offset, to_offset);
    const VkBufferCopy region{from_offset, to_offset, size};
    state_->vk.vkCmdCopyBuffer(buffer_, from.handle(), to.handle(), 1, &region);
}

void Commands::copy(const Buffer& from, const Image& to, std::uint32_t mip, std::uint32_t layer, std::uint64_t offset)
{
    if (gl_) return gl_->copy(*from.gl(), to, mip, layer, offset);
    const VkBufferImageCopy region = copy_region(to, mip, layer, offset);
    state_->vk.vkCmdCopyBufferToImage(buffer_, from.handle(), to.handle(), VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL, 1,
                                      &region);
}

void Commands::copy(const Image& from, const Buffer& to, std::uint32_t mip, std::uint32_t layer, std::uint64_t offset)
{
    if (gl_) return gl_->copy(from, *to.gl(), mip, layer, offset);
    const VkBufferImageCopy region = copy_region(from, mip, layer, offset);
    state_->vk.vkCmdCopyImageToBuffer(buffer_, from.handle(), VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL, to.handle(), 1,
                                      &region);
}

void Commands::blit(const Image& from, const Image& to, VkFilter filter)
{
    if (gl_) return gl_->blit(from, to, filter);
    const auto corner = [](const Image& image) {
        return VkOffset3D{static_cast<std::int32_t>(image.width()), static_cast<std::int32_t>(image.height()), 1};
    };
    const VkImageBlit region{.srcSubresource = {from.aspect(), 0, 0, 1},
                             .srcOffsets = {{0, 0, 0}, corner(from)},
                             .dstSubresource = {to.aspect(), 0, 0, 1},
                             .dstOffsets = {{0, 0, 0}, corner(to)}};
    state_->vk.vkCmdBlitImage(buffer_, from.handle(), VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL, to.handle(),
                              VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL, 1, &region, filter);
}

void Commands::clear(const Image& image, const VkClearColorValue& value)
{
    if (gl_) return gl_->clear(image, value);
    const VkImageSubresourceRange all{image.aspect(), 0, VK_REMAINING_MIP_LEVELS, 0, VK_REMAINING_ARRAY_LAYERS};
    state_->vk.vkCmdClearColorImage(buffer_, image.handle(), VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL, &value, 1, &all);
}

}  // namespace etalon::gpu
