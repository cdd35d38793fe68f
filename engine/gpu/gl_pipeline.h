#pragma once
// Inside engine/gpu only: programs of OpenGL with the state that belongs to them.
#include <string>
#include <vector>

#include "engine/gl/handle.h"
#include "engine/gpu/gl_device.h"
#include "engine/gpu/gl_translate.h"
#include "engine/gpu/pipeline.h"

namespace etalon::gpu {

/// A linked program, what it wants bound, and, of graphics, how its fragments are treated.
class GlPipeline {
 public:
    GlPipeline(GlDevice& device, const ComputePipelineSpec& spec);
    GlPipeline(GlDevice& device, const GraphicsPipelineSpec& spec);

    /// Makes it current, with all its state but cull mode and front face.
    void use(const gl::Functions& gl) const;

    GLuint vertices() const { return vertices_.get(); }
    GLenum topology() const { return topology_; }
    std::uint32_t streams() const { return static_cast<std::uint32_t>(strides_.size()); }
    std::uint32_t stride(std::uint32_t stream) const { return strides_[stream]; }
    const std::vector<GlResource>& resources() const { return resources_; }
    /// Of resources()[i]; null where the shader reads the bytes as they are.
    const BlockLayout* layout(std::size_t resource) const { return layouts_[resource]; }
    /// Null without push constants.
    const GlResource* push_constants() const;

 private:
    void link(GlDevice& device, std::span<const gl::Shader> shaders, const std::string& name);
    void add_resources(GlDevice& device, const GlStage& stage);
    void set_vertices(GlDevice& device, const GraphicsPipelineSpec& spec);

    gl::Program program_;
    gl::VertexArray vertices_;
    std::vector<GlResource> resources_;
    std::vector<const BlockLayout*> layouts_;
    std::vector<std::uint32_t> strides_;
    std::vector<Blend> blends_;
    DepthUse depth_;
    GLenum topology_ = GL_TRIANGLES;
    bool wireframe_ = false;
    bool graphics_ = false;
};

}  // namespace etalon::gpu
