// The part of Commands that draws.
#include "engine/gpu/commands.h"
#include "engine/gpu/device_state.h"
#include "engine/gpu/gl_commands.h"

namespace etalon::gpu {
namespace {

bool is_integer(VkFormat format)
{
    return format == VK_FORMAT_R8_UINT || format == VK_FORMAT_R16_UINT || format == VK_FORMAT_R32_UINT ||
           format == VK_FORMAT_R32_SINT || format == VK_FORMAT_R32G32_UINT || format == VK_FORMAT_R32G32B32A32_UINT;
}

}  // namespace

void Commands::begin_rendering(std::span<const ColorTarget> colors, const std::optional<DepthTarget>& depth)
{
    if (gl_) return begin_gl(colors, depth);
    std::vector<VkRenderingAttachmentInfo> attachments;
    for (const ColorTarget& color : colors) {
        prepare(*color.image, ImageUse::color_target, color.clear.has_value());
        VkRenderingAttachmentInfo info{
            .sType = VK_STRUCTURE_TYPE_RENDERING_ATTACHMENT_INFO,
            .imageView = color.image->view(),
            .imageLayout = VK_IMAGE_LAYOUT_COLOR_ATTACHMENT_OPTIMAL,
            .loadOp = color.clear ? VK_ATTACHMENT_LOAD_OP_CLEAR : VK_ATTACHMENT_LOAD_OP_LOAD,
            .storeOp = color.store ? VK_ATTACHMENT_STORE_OP_STORE : VK_ATTACHMENT_STORE_OP_DONT_CARE};
        if (color.clear) info.clearValue.color = *color.clear;
        if (color.resolve != nullptr) {
            prepare(*color.resolve, ImageUse::color_target, true);
            info.resolveMode =
                is_integer(color.image->format()) ? VK_RESOLVE_MODE_SAMPLE_ZERO_BIT : VK_RESOLVE_MODE_AVERAGE_BIT;
            info.resolveImageView = color.resolve->view();
            info.resolveImageLayout = VK_IMAGE_LAYOUT_COLOR_ATTACHMENT_OPTIMAL;
        }
        attachments.push_back(info);
    }
    const Image& any = colors.empty() ? *depth.value().image : *colors.front().image;
    VkRenderingAttachmentInfo depth_info{.sType = VK_STRUCTURE_TYPE_RENDERING_ATTACHMENT_INFO};
    if (depth) {
        prepare(*depth->image, ImageUse::depth_target, depth->clear.has_value());
        depth_info.imageView = depth->image->view();
        depth_info.imageLayout = VK_IMAGE_LAYOUT_DEPTH_ATTACHMENT_OPTIMAL;
        depth_info.loadOp = depth->clear ? VK_ATTACHMENT_LOAD_OP_CLEAR : VK_ATTACHMENT_LOAD_OP_LOAD;
        depth_info.storeOp = depth->store ? VK_ATTACHMENT_STORE_OP_STORE : VK_ATTACHMENT_STORE_OP_DONT_CARE;
        depth_info.clearValue.depthStencil.depth = depth->clear.value_or(0.f);
        if (depth->resolve != nullptr) {
            prepare(*depth->resolve, ImageUse::depth_target, true);
            depth_info.resolveMode = VK_RESOLVE_MODE_SAMPLE_ZERO_BIT;
            depth_info.resolveImageView = depth->resolve->view();
            depth_info.resolveImageLayout = VK_IMAGE_LAYOUT_DEPTH_ATTACHMENT_OPTIMAL;
        }
    }
    const VkRenderingInfo info{.sType = VK_STRUCTURE_TYPE_RENDERING_INFO,
                               .renderArea = {{0, 0}, {any.width(), any.height()}},
                               .layerCount = 1,
                               .colorAttachmentCount = static_cast<std::uint32_t>(attachments.size()),
                               .pColorAttachments = attachments.data(),
                               .pDepthAttachment = depth ? &depth_info : nullptr};
    state_->vk.vkCmdBeginRendering(buffer_, &info);
    set_viewport(0, 0, static_cast<float>(any.width()), static_cast<float>(any.height()));
    set_scissor(0, 0, any.width(), any.height());
}

void Commands::begin_gl(std::span<const ColorTarget> colors, const std::optional<DepthTarget>& depth)
{
    for (const ColorTarget& color : colors) {
        prepare(*color.image, ImageUse::color_target, color.clear.has_value());
        if (color.resolve != nullptr) prepare(*color.resolve, ImageUse::color_target, true);
    }
    if (depth) prepare(*depth->image, ImageUse::depth_target, depth->clear.has_value());
    if (depth && depth->resolve != nullptr) prepare(*depth->resolve, ImageUse::depth_target, true);
    gl_->begin_rendering(colors, depth);
}

void Commands::end_rendering()
{
    if (gl_) return gl_->end_rendering();
    state_->vk.vkCmdEndRendering(buffer_);
}

void Commands::set_viewport(float x, float y, float width, float height)
{
    if (gl_) return gl_->set_viewport(x, y, width, height);
    const VkViewport viewport{x, y, width, height, 0, 1};
    state_->vk.vkCmdSetViewport(buffer_, 0, 1, &viewport);
}

void Commands::set_scissor(int x, int y, std::uint32_t width, std::uint32_t height)
{
    if (gl_) return gl_->set_scissor(x, y, width, height);
    const VkRect2D scissor{{x, y}, {width, height}};
    state_->vk.vkCmdSetScissor(buffer_, 0, 1, &scissor);
}

void Commands::set_cull(VkCullModeFlags cull, VkFrontFace front)
{
    if (gl_) return gl_->set_cull(cull, front);
    state_->vk.vkCmdSetCullMode(buffer_, cull);
    state_->vk.vkCmdSetFrontFace(buffer_, front);
}

void Commands::bind_vertices(std::uint32_t stream, const Buffer& buffer, std::uint64_t offset)
{
    if (gl_) return gl_->bind_vertices(stream, *buffer.gl(), offset);
    const VkBuffer handle = buffer.handle();
    state_->vk.vkCmdBindVertexBuffers(buffer_, stream, 1, &handle, &offset);
}

void Commands::bind_indices(const Buffer& buffer, VkIndexType type, std::uint64_t offset)
{
    if (gl_) return gl_->bind_indices(*buffer.gl(), type, offset);
    state_->vk.vkCmdBindIndexBuffer(buffer_, buffer.handle(), offset, type);
}

void Commands::draw(std::uint32_t vertices, std::uint32_t instances, std::uint32_t first_vertex,
                    std::uint32_t first_instance)
{
    assume(!gl_ || first_instance == 0);  // its shaders count from 0
    if (gl_) return gl_->draw(vertices, instances, first_vertex);
    state_->vk.vkCmdDraw(buffer_, vertices, instances, first_vertex, first_instance);
}

void Commands::draw_indexed(std::uint32_t indices, std::uint32_t instances, std::uint32_t first_index,
                            std::int32_t vertex_offset, std::uint32_t first_instance)
{
    assume(!gl_ || first_instance == 0);
    if (gl_) return gl_->draw_indexed(indices, instances, first_index, vertex_offset);
    state_->vk.vkCmdDrawIndexed(buffer_, indices, instances, first_index, vertex_offset, first_instance);
}

}  // namespace etalon::gpu
