#pragma once
// Inside engine/gpu only: Commands of OpenGL.
#include <array>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "engine/gpu/commands.h"
#include "engine/gpu/gl_pipeline.h"
#include "engine/gpu/gl_resources.h"

namespace etalon::gpu {

/// What Bindings hold: everything by its binding number.
struct GlBound {
    std::uint32_t binding = 0;
    GlBuffer* buffer = nullptr;
    std::uint64_t offset = 0;
    std::uint64_t size = 0;
    struct Texture {
        GLuint image = 0;
        GLenum format = 0;
        bool array = false;
        GLuint sampler = 0;  ///< 0: none
    };
    std::vector<Texture> textures;
};
struct GlBindings {
    std::vector<GlBound> bound;
};

/// Commands as a list of calls that are made when it is submitted. Each says what it needs at once by value, so that
/// only the objects themselves must outlive it.
class GlCommands {
 public:
    explicit GlCommands(GlDevice& device) : device_(device) {}

    void bind(const GlPipeline& pipeline);
    void bind(const GlBindings& bindings, std::uint32_t set);
    void push(std::span<const std::byte> bytes);
    void dispatch(std::uint32_t x, std::uint32_t y, std::uint32_t z);
    void dispatch_indirect(GlBuffer& counts, std::uint64_t offset);
    void barrier();
    void fill(GlBuffer& buffer, std::uint32_t word, std::uint64_t offset, std::uint64_t size);
    void copy(GlBuffer& from, GlBuffer& to, std::uint64_t size, std::uint64_t from_offset, std::uint64_t to_offset);
    void copy(GlBuffer& from, const Image& to, std::uint32_t mip, std::uint32_t layer, std::uint64_t offset);
    void copy(const Image& from, GlBuffer& to, std::uint32_t mip, std::uint32_t layer, std::uint64_t offset);
    void blit(const Image& from, const Image& to, VkFilter filter);
    void clear(const Image& image, const VkClearColorValue& value);
    void begin_rendering(std::span<const ColorTarget> colors, const std::optional<DepthTarget>& depth);
    void end_rendering();
    void set_viewport(float x, float y, float width, float height);
    void set_scissor(int x, int y, std::uint32_t width, std::uint32_t height);
    void set_cull(VkCullModeFlags cull, VkFrontFace front);
    void bind_vertices(std::uint32_t stream, GlBuffer& buffer, std::uint64_t offset);
    void bind_indices(GlBuffer& buffer, VkIndexType type, std::uint64_t offset);
    void draw(std::uint32_t vertices, std::uint32_t instances, std::uint32_t first_vertex);
    void draw_indexed(std::uint32_t indices, std::uint32_t instances, std::uint32_t first_index,
                      std::int32_t vertex_offset);
    /// The time when what was recorded before is done, as stamps()[index].
    void stamp(std::uint32_t index);
    std::vector<std::uint64_t> stamps() const;  ///< nanoseconds

    Ticket submit();
    GlDevice& device() const { return device_; }

 private:
    struct Replay;
    void record(std::function<void(Replay&)> call) { calls_.push_back(std::move(call)); }

    GlDevice& device_;
    std::vector<std::function<void(Replay&)>> calls_;
    const GlPipeline* pipeline_ = nullptr;  // bound last, while recording
    std::vector<std::byte> pushed_;         // push constants of all draws, one after another
    gl::Buffer push_buffer_;
    std::vector<gl::Query> queries_;
};

}  // namespace etalon::gpu
