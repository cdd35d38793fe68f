#include "engine/gpu/gl_commands.h"

#include <algorithm>

#include "engine/gpu/gl_replay.h"

namespace etalon::gpu {
namespace {

constexpr std::uint64_t kPushStep = 256;  // the coarsest alignment of ranges that OpenGL allows

struct Texels {
    GLuint texture;
    GlFormat format;
    GLint mip, layer;
    GLsizei width, height;
    bool array;
};

Texels texels_of(const Image& image, std::uint32_t mip, std::uint32_t layer)
{
    return {.texture = image.gl()->name(),
            .format = image.gl()->format(),
            .mip = static_cast<GLint>(mip),
            .layer = static_cast<GLint>(layer),
            .width = static_cast<GLsizei>(image.width(mip)),
            .height = static_cast<GLsizei>(image.height(mip)),
            .array = image.gl()->is_array()};
}

/// A place in a bound buffer, as OpenGL wants it.
void* at(std::uint64_t offset)
{
    return reinterpret_cast<void*>(static_cast<std::uintptr_t>(offset));  // NOLINT(performance-no-int-to-ptr)
}

}  // namespace

void GlCommands::bind(const GlPipeline& pipeline)
{
    pipeline_ = &pipeline;
    record([&pipeline](Replay& replay) {
        pipeline.use(replay.gl);
        replay.pipeline = &pipeline;
        replay.changed = true;
    });
}

void GlCommands::bind(const GlBindings& bindings, std::uint32_t set)
{
    record([&bindings, set](Replay& replay) {
        assume(set < replay.sets.size());
        replay.sets[set] = &bindings;
        replay.changed = true;
    });
}

void GlCommands::push(std::span<const std::byte> bytes)
{
    assume(pipeline_ != nullptr);
    const GlResource* wanted = pipeline_->push_constants();
    if (wanted == nullptr) return;  // what read them was specialised away
    const std::vector<std::byte> laid = wanted->layout.apply(bytes);
    const std::uint64_t offset = pushed_.size();
    pushed_.insert(pushed_.end(), laid.begin(), laid.end());
    pushed_.resize((pushed_.size() + kPushStep - 1) / kPushStep * kPushStep);
    record([offset, size = laid.size()](Replay& replay) {
        replay.push_offset = offset;
        replay.push_size = size;
    });
}

void GlCommands::dispatch(std::uint32_t x, std::uint32_t y, std::uint32_t z)
{
    record([=](Replay& replay) {
        replay.prepare();
        replay.gl.DispatchCompute(x, y, z);
    });
}

void GlCommands::dispatch_indirect(GlBuffer& counts, std::uint64_t offset)
{
    record([&counts, offset](Replay& replay) {
        replay.prepare();
        counts.send();
        replay.gl.BindBuffer(GL_DISPATCH_INDIRECT_BUFFER, counts.name());
        replay.gl.DispatchComputeIndirect(static_cast<GLintptr>(offset));
    });
}

void GlCommands::barrier()
{
    record([](Replay& replay) { replay.gl.MemoryBarrier(GL_ALL_BARRIER_BITS); });
}

void GlCommands::fill(GlBuffer& buffer, std::uint32_t word, std::uint64_t offset, std::uint64_t size)
{
    record([&buffer, word, offset, size](Replay& replay) {
        replay.gl.ClearNamedBufferSubData(buffer.name(), GL_R32UI, static_cast<GLintptr>(offset),
                                          static_cast<GLsizeiptr>(size / 4 * 4), GL_RED_INTEGER, GL_UNSIGNED_INT,
                                          &word);
        replay.wrote(buffer);
    });
}

void GlCommands::copy(GlBuffer& from, GlBuffer& to, std::uint64_t size, std::uint64_t from_offset,
                      std::uint64_t to_offset)
{
    record([&from, &to, size, from_offset, to_offset](Replay& replay) {
        from.send();
        replay.gl.CopyNamedBufferSubData(from.name(), to.name(), static_cast<GLintptr>(from_offset),
                                         static_cast<GLintptr>(to_offset), static_cast<GLsizeiptr>(size));
        replay.wrote(to);
    });
}

void GlCommands::copy(GlBuffer& from, const Image& to, std::uint32_t mip, std::uint32_t layer, std::uint64_t offset)
{
    record([&from, image = texels_of(to, mip, layer), offset](Replay& replay) {
        from.send();
        const gl::Functions& gl = replay.gl;
        gl.BindBuffer(GL_PIXEL_UNPACK_BUFFER, from.name());
        if (image.array)
            gl.TextureSubImage3D(image.texture, image.mip, 0, 0, image.layer, image.width, image.height, 1,
                                 image.format.format, image.format.type, at(offset));
        else
            gl.TextureSubImage2D(image.texture, image.mip, 0, 0, image.width, image.height, image.format.format,
                                 image.format.type, at(offset));
        gl.BindBuffer(GL_PIXEL_UNPACK_BUFFER, 0);
    });
}

void GlCommands::copy(const Image& from, GlBuffer& to, std::uint32_t mip, std::uint32_t layer, std::uint64_t offset)
{
    record([&to, image = texels_of(from, mip, layer), offset](Replay& replay) {
        const gl::Functions& gl = replay.gl;
        gl.BindBuffer(GL_PIXEL_PACK_BUFFER, to.name());
        gl.GetTextureSubImage(image.texture, image.mip, 0, 0, image.layer, image.width, image.height, 1,
                              image.format.format, image.format.type, static_cast<GLsizei>(to.size() - offset),
                              at(offset));
        gl.BindBuffer(GL_PIXEL_PACK_BUFFER, 0);
        replay.wrote(to);
    });
}

// Vertices and indices stay bound when the pipeline changes, as in Vulkan; OpenGL keeps them with the pipeline's vertex
// array, so they go there before each draw that needs them.
void GlCommands::bind_vertices(std::uint32_t stream, GlBuffer& buffer, std::uint64_t offset)
{
    record([stream, &buffer, offset](Replay& replay) {
        buffer.send();
        if (replay.streams.size() <= stream) replay.streams.resize(stream + 1);
        replay.streams[stream] = {buffer.name(), offset};
        replay.changed = true;
    });
}

void GlCommands::bind_indices(GlBuffer& buffer, VkIndexType type, std::uint64_t offset)
{
    record([&buffer, type, offset](Replay& replay) {
        buffer.send();
        replay.index_type = type == VK_INDEX_TYPE_UINT16 ? GL_UNSIGNED_SHORT : GL_UNSIGNED_INT;
        replay.indices = {buffer.name(), offset};
        replay.changed = true;
    });
}

void GlCommands::draw(std::uint32_t vertices, std::uint32_t instances, std::uint32_t first_vertex)
{
    record([=](Replay& replay) {
        replay.prepare();
        replay.gl.DrawArraysInstancedBaseInstance(replay.pipeline->topology(), static_cast<GLint>(first_vertex),
                                                  static_cast<GLsizei>(vertices), static_cast<GLsizei>(instances), 0);
    });
}

void GlCommands::draw_indexed(std::uint32_t indices, std::uint32_t instances, std::uint32_t first_index,
                              std::int32_t vertex_offset)
{
    record([=](Replay& replay) {
        replay.prepare();
        const std::uint64_t size = replay.index_type == GL_UNSIGNED_SHORT ? 2 : 4;
        replay.gl.DrawElementsInstancedBaseVertexBaseInstance(
            replay.pipeline->topology(), static_cast<GLsizei>(indices), replay.index_type,
            at(replay.indices.offset + first_index * size), static_cast<GLsizei>(instances), vertex_offset, 0);
    });
}

void GlCommands::stamp(std::uint32_t index)
{
    const gl::Functions& gl = device_.gl();
    GLuint name = 0;
    gl.CreateQueries(GL_TIMESTAMP, 1, &name);
    if (queries_.size() <= index) queries_.resize(index + 1);
    queries_[index] = {gl, name};
    record([name](Replay& replay) { replay.gl.QueryCounter(name, GL_TIMESTAMP); });
}

std::vector<std::uint64_t> GlCommands::stamps() const
{
    std::vector<std::uint64_t> out;
    for (const gl::Query& query : queries_) {
        GLuint64 nanoseconds = 0;
        device_.gl().GetQueryObjectui64v(query.get(), GL_QUERY_RESULT, &nanoseconds);
        out.push_back(nanoseconds);
    }
    return out;
}

Ticket GlCommands::submit()
{
    if (!pushed_.empty() && !push_buffer_) push_buffer_ = make_gl_buffer(device_, pushed_);
    Replay replay{.gl = device_.gl(), .device = device_, .push_buffer = push_buffer_.get(), .framebuffer = {}};
    for (const auto& call : calls_) call(replay);
    // Names are taken again by later objects: nothing stays bound under an old one.
    replay.gl.BindFramebuffer(GL_FRAMEBUFFER, 0);
    replay.gl.BindVertexArray(0);
    replay.gl.UseProgram(0);
    if (!replay.written.empty()) replay.gl.MemoryBarrier(GL_ALL_BARRIER_BITS);
    for (GlBuffer* buffer : replay.written) buffer->fetch();
    gl::check(replay.gl, "OpenGL's work");
    return device_.submitted();
}

}  // namespace etalon::gpu
