#pragma once
// Inside engine/gpu only: what is bound while the calls of GlCommands are made.
#include <array>

#include "engine/gpu/gl_commands.h"

namespace etalon::gpu {

struct GlCommands::Replay {
    const gl::Functions& gl;
    GlDevice& device;
    GLuint push_buffer = 0;
    const GlPipeline* pipeline = nullptr;
    std::array<const GlBindings*, 4> sets{};
    bool changed = true;  ///< pipeline, sets or vertices since the last draw
    std::uint64_t push_offset = 0;
    std::uint64_t push_size = 0;
    struct Stream {
        GLuint buffer = 0;
        std::uint64_t offset = 0;
    };
    std::vector<Stream> streams;
    Stream indices;
    GLenum index_type = GL_UNSIGNED_INT;
    gl::Framebuffer framebuffer;       ///< of the rendering that is under way
    std::function<void(Replay&)> end;  ///< resolves its targets
    std::vector<GlBuffer*> written;    ///< to be fetched for the host

    /// Before a draw or dispatch: binds what the program wants.
    void prepare();
    void wrote(GlBuffer& buffer);

 private:
    void bind_vertices();
    void bind(const GlResource& resource, const BlockLayout* layout);
    void bind_buffer(const GlResource& resource, const GlBound& bound, const BlockLayout* layout);
    void bind_images(const GlResource& resource, const GlBound& bound);
    const GlBound& find(std::uint32_t set, std::uint32_t binding) const;
};

}  // namespace etalon::gpu
