// The part of GlCommands that knows targets.
#include <algorithm>

#include "engine/gpu/gl_replay.h"

namespace etalon::gpu {
namespace {

GLenum attachment_of(const GlFormat& format, std::size_t index)
{
    return format.is_depth() ? GL_DEPTH_ATTACHMENT : static_cast<GLenum>(GL_COLOR_ATTACHMENT0 + index);
}

gl::Framebuffer make_framebuffer(const gl::Functions& gl)
{
    GLuint name = 0;
    gl.CreateFramebuffers(1, &name);
    return {gl, name};
}

/// One image alone, to be read or written whole.
gl::Framebuffer framebuffer_of(const gl::Functions& gl, GLuint texture, const GlFormat& format)
{
    gl::Framebuffer framebuffer = make_framebuffer(gl);
    gl.NamedFramebufferTexture(framebuffer.get(), attachment_of(format, 0), texture, 0);
    if (format.is_depth()) {
        gl.NamedFramebufferReadBuffer(framebuffer.get(), GL_NONE);
        const GLenum none = GL_NONE;
        gl.NamedFramebufferDrawBuffers(framebuffer.get(), 1, &none);
    }
    return framebuffer;
}

void clear_color(const gl::Functions& gl, GLuint framebuffer, GLint index, const GlFormat& format,
                 const VkClearColorValue& value)
{
    if (format.is_unsigned())
        gl.ClearNamedFramebufferuiv(framebuffer, GL_COLOR, index, value.uint32);
    else
        gl.ClearNamedFramebufferfv(framebuffer, GL_COLOR, index, value.float32);
}

struct Target {
    GLuint texture;
    GlFormat format;
    GLuint resolve;  ///< 0: none
    std::optional<VkClearColorValue> clear;
    std::optional<float> clear_depth;
};

/// Sample 0 of integers and depth, the mean of all others: what each blit does.
void resolve(const gl::Functions& gl, GLuint framebuffer, const Target& target, std::size_t index, GLint width,
             GLint height)
{
    const gl::Framebuffer into = framebuffer_of(gl, target.resolve, target.format);
    if (!target.format.is_depth())
        gl.NamedFramebufferReadBuffer(framebuffer, static_cast<GLenum>(GL_COLOR_ATTACHMENT0 + index));
    gl.BlitNamedFramebuffer(framebuffer, into.get(), 0, 0, width, height, 0, 0, width, height,
                            target.format.is_depth() ? GL_DEPTH_BUFFER_BIT : GL_COLOR_BUFFER_BIT, GL_NEAREST);
}

}  // namespace

void GlCommands::begin_rendering(std::span<const ColorTarget> colors, const std::optional<DepthTarget>& depth)
{
    std::vector<Target> targets;
    for (const ColorTarget& color : colors)
        targets.push_back({.texture = color.image->gl()->name(),
                           .format = color.image->gl()->format(),
                           .resolve = color.resolve != nullptr ? color.resolve->gl()->name() : 0,
                           .clear = color.clear,
                           .clear_depth = {}});
    if (depth)
        targets.push_back({.texture = depth->image->gl()->name(),
                           .format = depth->image->gl()->format(),
                           .resolve = depth->resolve != nullptr ? depth->resolve->gl()->name() : 0,
                           .clear = {},
                           .clear_depth = depth->clear});
    const Image& any = colors.empty() ? *depth.value().image : *colors.front().image;
    const auto width = static_cast<GLsizei>(any.width()), height = static_cast<GLsizei>(any.height());
    record([targets, width, height](Replay& replay) {
        const gl::Functions& gl = replay.gl;
        replay.framebuffer = make_framebuffer(gl);
        const GLuint name = replay.framebuffer.get();
        std::vector<GLenum> drawn;
        for (std::size_t i = 0; i < targets.size(); ++i) {
            const GLenum attachment = attachment_of(targets[i].format, i);
            gl.NamedFramebufferTexture(name, attachment, targets[i].texture, 0);
            if (attachment != GL_DEPTH_ATTACHMENT) drawn.push_back(attachment);
        }
        gl.NamedFramebufferDrawBuffers(name, static_cast<GLsizei>(drawn.size()), drawn.data());
        if (gl.CheckNamedFramebufferStatus(name, GL_FRAMEBUFFER) != GL_FRAMEBUFFER_COMPLETE)
            throw Error(Blame::machine, "this OpenGL driver cannot draw to targets of these formats",
                        "render with --backend vulkan");
        gl.BindFramebuffer(GL_FRAMEBUFFER, name);
        gl.Viewport(0, 0, width, height);
        gl.Scissor(0, 0, width, height);
        gl.DepthMask(GL_TRUE);  // clearing obeys it
        for (std::size_t i = 0; i < targets.size(); ++i) {
            if (targets[i].clear) clear_color(gl, name, static_cast<GLint>(i), targets[i].format, *targets[i].clear);
            if (targets[i].clear_depth) gl.ClearNamedFramebufferfv(name, GL_DEPTH, 0, &*targets[i].clear_depth);
        }
        if (replay.pipeline != nullptr) replay.pipeline->use(gl);
        replay.end = [targets, width, height](Replay& now) {
            for (std::size_t i = 0; i < targets.size(); ++i)
                if (targets[i].resolve != 0) resolve(now.gl, now.framebuffer.get(), targets[i], i, width, height);
        };
    });
}

void GlCommands::end_rendering()
{
    record([](Replay& replay) {
        // Blitting obeys the scissor.
        replay.gl.Disable(GL_SCISSOR_TEST);
        replay.end(replay);
        replay.gl.Enable(GL_SCISSOR_TEST);
        replay.gl.BindFramebuffer(GL_FRAMEBUFFER, 0);
        replay.framebuffer = {};
    });
}

void GlCommands::set_viewport(float x, float y, float width, float height)
{
    record([=](Replay& replay) {
        replay.gl.Viewport(static_cast<GLint>(x), static_cast<GLint>(y), static_cast<GLsizei>(width),
                           static_cast<GLsizei>(height));
    });
}

void GlCommands::set_scissor(int x, int y, std::uint32_t width, std::uint32_t height)
{
    record([=](Replay& replay) { replay.gl.Scissor(x, y, static_cast<GLsizei>(width), static_cast<GLsizei>(height)); });
}

void GlCommands::set_cull(VkCullModeFlags cull, VkFrontFace front)
{
    record([=](Replay& replay) {
        (cull == VK_CULL_MODE_NONE ? replay.gl.Disable : replay.gl.Enable)(GL_CULL_FACE);
        replay.gl.CullFace(cull == VK_CULL_MODE_FRONT_BIT ? GL_FRONT : GL_BACK);
        // Vulkan looks at the picture with y down, OpenGL with y up: the same triangle turns the other way.
        replay.gl.FrontFace(front == VK_FRONT_FACE_COUNTER_CLOCKWISE ? GL_CW : GL_CCW);
    });
}

void GlCommands::blit(const Image& from, const Image& to, VkFilter filter)
{
    record([source = from.gl()->name(), source_format = from.gl()->format(), target = to.gl()->name(),
            target_format = to.gl()->format(), w0 = static_cast<GLint>(from.width()),
            h0 = static_cast<GLint>(from.height()), w1 = static_cast<GLint>(to.width()),
            h1 = static_cast<GLint>(to.height()), filter](Replay& replay) {
        const gl::Framebuffer read = framebuffer_of(replay.gl, source, source_format);
        const gl::Framebuffer write = framebuffer_of(replay.gl, target, target_format);
        replay.gl.Disable(GL_SCISSOR_TEST);
        replay.gl.BlitNamedFramebuffer(read.get(), write.get(), 0, 0, w0, h0, 0, 0, w1, h1,
                                       source_format.is_depth() ? GL_DEPTH_BUFFER_BIT : GL_COLOR_BUFFER_BIT,
                                       filter == VK_FILTER_LINEAR ? GL_LINEAR : GL_NEAREST);
        replay.gl.Enable(GL_SCISSOR_TEST);
    });
}

void GlCommands::clear(const Image& image, const VkClearColorValue& value)
{
    if (image.mips() > 1 || image.layers() > 1)
        throw Error(Blame::machine, "the OpenGL backend clears single images only", "render with --backend vulkan");
    record([texture = image.gl()->name(), format = image.gl()->format(), value](Replay& replay) {
        const gl::Framebuffer framebuffer = framebuffer_of(replay.gl, texture, format);
        replay.gl.Disable(GL_SCISSOR_TEST);
        clear_color(replay.gl, framebuffer.get(), 0, format, value);
        replay.gl.Enable(GL_SCISSOR_TEST);
    });
}

}  // namespace etalon::gpu
