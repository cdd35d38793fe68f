#pragma once
// Inside engine/gpu only: shaders for OpenGL.
#include <map>
#include <string>
#include <tuple>
#include <vector>

#include "engine/gpu/gl_block.h"
#include "engine/gpu/shader.h"

namespace etalon::gpu {

enum class GlResourceKind { storage_buffer, uniform_buffer, push_constants, texture, storage_image };

/// What a translated shader wants bound, and where: `unit` is its binding point among those of its kind (push constants
/// are uniform buffers there).
struct GlResource {
    GlResourceKind kind = GlResourceKind::storage_buffer;
    std::uint32_t set = 0;
    std::uint32_t binding = 0;
    /// Of a texture whose sampler has a binding of its own: that binding, in the same set.
    std::uint32_t sampler = kNoSampler;
    std::uint32_t unit = 0;
    std::uint32_t count = 1;  ///< elements of an array, in units from `unit` on
    bool writes = false;      ///< the shader may write to it
    BlockLayout layout;       ///< of buffers and push constants

    static constexpr std::uint32_t kNoSampler = 0xffffffff;
};

/// Binding points of a program: the same for all its stages, though OpenGL has no sets.
class GlUnits {
 public:
    std::uint32_t take(GlResourceKind kind, std::uint32_t set, std::uint32_t binding, std::uint32_t sampler,
                       std::uint32_t count);

 private:
    std::map<std::tuple<GlResourceKind, std::uint32_t, std::uint32_t, std::uint32_t>, std::uint32_t> taken_;
    std::map<GlResourceKind, std::uint32_t> next_;
};

struct GlStage {
    std::string code;  ///< GLSL 4.50
    std::vector<GlResource> resources;
};

/// GLSL of a shader's SPIR-V with its constants fixed. Blocks are laid out by OpenGL's rules (see BlockLayout),
/// textures without sampler are read through a sampler that does nothing. Throws Error(input) when that cannot be.
GlStage translate(const ShaderSpec& shader, GlUnits& units);

}  // namespace etalon::gpu
