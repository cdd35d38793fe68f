#include "engine/gpu/gl_replay.h"

#include <fmt/format.h>

#include <algorithm>

namespace etalon::gpu {

void GlCommands::Replay::prepare()
{
    assume(pipeline != nullptr);
    if (const GlResource* push = pipeline->push_constants(); push != nullptr && push_size != 0)
        gl.BindBufferRange(GL_UNIFORM_BUFFER, push->unit, push_buffer, static_cast<GLintptr>(push_offset),
                           static_cast<GLsizeiptr>(push_size));
    for (std::size_t i = 0; i < pipeline->resources().size(); ++i) {
        const GlResource& resource = pipeline->resources()[i];
        if (resource.kind == GlResourceKind::push_constants) continue;
        if (changed) bind(resource, pipeline->layout(i));
        if (!resource.writes || resource.kind != GlResourceKind::storage_buffer) continue;
        wrote(*find(resource.set, resource.binding).buffer);
    }
    if (changed) bind_vertices();
    changed = false;
}

void GlCommands::Replay::bind_vertices()
{
    for (std::uint32_t i = 0; i < pipeline->streams(); ++i) {
        assume(i < streams.size() && streams[i].buffer != 0);
        gl.VertexArrayVertexBuffer(pipeline->vertices(), i, streams[i].buffer, static_cast<GLintptr>(streams[i].offset),
                                   static_cast<GLsizei>(pipeline->stride(i)));
    }
    if (pipeline->streams() > 0 && indices.buffer != 0)
        gl.VertexArrayElementBuffer(pipeline->vertices(), indices.buffer);
}

void GlCommands::Replay::wrote(GlBuffer& buffer)
{
    buffer.touch();
    if (buffer.is_readback() && std::find(written.begin(), written.end(), &buffer) == written.end())
        written.push_back(&buffer);
}

const GlBound& GlCommands::Replay::find(std::uint32_t set, std::uint32_t binding) const
{
    assume(set < sets.size() && sets[set] != nullptr);
    const std::vector<GlBound>& all = sets[set]->bound;
    const auto bound =
        std::find_if(all.begin(), all.end(), [&](const GlBound& candidate) { return candidate.binding == binding; });
    assume(bound != all.end());
    return *bound;
}

void GlCommands::Replay::bind(const GlResource& resource, const BlockLayout* layout)
{
    const GlBound& bound = find(resource.set, resource.binding);
    switch (resource.kind) {
        case GlResourceKind::storage_buffer:
        case GlResourceKind::uniform_buffer:
            return bind_buffer(resource, bound, layout);
        case GlResourceKind::texture:
        case GlResourceKind::storage_image:
            return bind_images(resource, bound);
        case GlResourceKind::push_constants:
            return;
    }
}

void GlCommands::Replay::bind_buffer(const GlResource& resource, const GlBound& bound, const BlockLayout* layout)
{
    const GLenum target =
        resource.kind == GlResourceKind::uniform_buffer ? GL_UNIFORM_BUFFER : GL_SHADER_STORAGE_BUFFER;
    bound.buffer->send();
    if (layout == nullptr) {
        gl.BindBufferRange(target, resource.unit, bound.buffer->name(), static_cast<GLintptr>(bound.offset),
                           static_cast<GLsizeiptr>(bound.size));
        return;
    }
    if (bound.offset != 0 || bound.size != bound.buffer->size())
        throw Error(Blame::machine, "the OpenGL backend cannot bind a part of a buffer whose layout is not std430",
                    "render with --backend vulkan");
    const GlBuffer::Laid laid = bound.buffer->laid_out(*layout);
    gl.BindBufferRange(target, resource.unit, laid.name, 0, static_cast<GLsizeiptr>(laid.size));
}

void GlCommands::Replay::bind_images(const GlResource& resource, const GlBound& bound)
{
    const GLuint own =
        resource.sampler == GlResource::kNoSampler ? 0 : find(resource.set, resource.sampler).textures.front().sampler;
    for (GLuint i = 0; i < resource.count; ++i) {
        const GlBound::Texture& texture = bound.textures[std::min<std::size_t>(i, bound.textures.size() - 1)];
        if (resource.kind == GlResourceKind::storage_image) {
            gl.BindImageTexture(resource.unit + i, texture.image, 0, texture.array ? GL_TRUE : GL_FALSE, 0,
                                GL_READ_WRITE, texture.format);
            continue;
        }
        gl.BindTextureUnit(resource.unit + i, texture.image);
        gl.BindSampler(resource.unit + i, own != 0 ? own : texture.sampler);
    }
}

}  // namespace etalon::gpu
