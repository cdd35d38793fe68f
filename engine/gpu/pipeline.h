#pragma once
#include <string>
#include <vector>

#include "engine/gpu/device.h"
#include "engine/gpu/gl_owned.h"
#include "engine/gpu/owned.h"
#include "engine/gpu/shader.h"

namespace etalon::gpu {

void destroy_pipeline(const DeviceState& state, VkPipeline pipeline);
void destroy_pipeline_layout(const DeviceState& state, VkPipelineLayout layout);
void destroy_set_layout(const DeviceState& state, VkDescriptorSetLayout layout);

/// Descriptor set layouts, push constants and pipeline layout as the shaders of a pipeline declare them together.
class Layout {
 public:
    Layout() = default;
    /// Throws Error(input) when two stages disagree about a binding.
    Layout(Device& device, std::span<const Interface> stages, std::string name);

    const std::string& name() const { return name_; }  ///< of the pipeline
    VkPipelineLayout handle() const { return layout_.get(); }
    VkDescriptorSetLayout set(std::uint32_t index) const { return sets_[index].get(); }
    std::uint32_t set_count() const { return static_cast<std::uint32_t>(sets_.size()); }
    const std::vector<DeclaredBinding>& bindings() const { return bindings_; }
    std::uint32_t push_constants() const { return push_constants_; }
    VkShaderStageFlags push_stages() const { return push_stages_; }

 private:
    std::string name_;
    std::vector<Owned<VkDescriptorSetLayout, destroy_set_layout>> sets_;
    Owned<VkPipelineLayout, destroy_pipeline_layout> layout_;
    std::vector<DeclaredBinding> bindings_;
    std::uint32_t push_constants_ = 0;
    VkShaderStageFlags push_stages_ = 0;
};

struct ComputePipelineSpec {
    ShaderSpec shader;
    std::string name;  ///< for errors and validation messages
};

class ComputePipeline {
 public:
    ComputePipeline() = default;
    ComputePipeline(Device& device, const ComputePipelineSpec& spec);

    VkPipeline handle() const { return pipeline_.get(); }
    /// By OpenGL; null by Vulkan.
    const GlPipeline* gl() const { return gl_.get(); }
    const Layout& layout() const { return layout_; }
    /// Invocations of one workgroup along x, y, z (as compiled: a local size set by specialization is not seen here).
    std::uint32_t workgroup(int axis) const { return workgroup_[axis]; }

 private:
    Layout layout_;
    Owned<VkPipeline, destroy_pipeline> pipeline_;
    GlOwned<GlPipeline> gl_;
    std::uint32_t workgroup_[3] = {1, 1, 1};
};

/// One vertex buffer: stream i of the pipeline is vertex binding i.
struct VertexStream {
    std::uint32_t stride = 0;  ///< bytes
    bool per_instance = false;
};

struct VertexAttribute {
    std::uint32_t location = 0;
    VkFormat format = VK_FORMAT_R32G32B32_SFLOAT;
    std::uint32_t stream = 0;
    std::uint32_t offset = 0;  ///< bytes
};

enum class Blend {
    none,           ///< replaces
    premultiplied,  ///< source + (1 - source alpha) target, alpha alike
    add,            ///< source + target
};

struct ColorFormat {
    VkFormat format = VK_FORMAT_R32G32B32A32_SFLOAT;
    Blend blend = Blend::none;
};

struct DepthUse {
    VkFormat format = VK_FORMAT_UNDEFINED;  ///< UNDEFINED: no depth target
    bool test = true;
    bool write = true;
    VkCompareOp passes = VK_COMPARE_OP_GREATER;  ///< depth is reversed here: nearer is greater
};

struct GraphicsPipelineSpec {
    ShaderSpec vertex;
    ShaderSpec fragment;
    std::vector<VertexStream> streams;
    std::vector<VertexAttribute> attributes;
    std::vector<ColorFormat> colors;
    DepthUse depth;
    std::uint32_t samples = 1;
    VkPrimitiveTopology topology = VK_PRIMITIVE_TOPOLOGY_TRIANGLE_LIST;
    VkCullModeFlags cull = VK_CULL_MODE_BACK_BIT;         ///< until Commands::set_cull
    VkFrontFace front = VK_FRONT_FACE_COUNTER_CLOCKWISE;  ///< until Commands::set_cull
    bool wireframe = false;                               ///< needs DeviceLimits::wireframe
    std::string name;
};

/// Dynamic rendering; viewport and scissor are the whole target, cull mode and front face may change per draw.
class GraphicsPipeline {
 public:
    GraphicsPipeline() = default;
    GraphicsPipeline(Device& device, const GraphicsPipelineSpec& spec);

    VkPipeline handle() const { return pipeline_.get(); }
    /// By OpenGL; null by Vulkan.
    const GlPipeline* gl() const { return gl_.get(); }
    const Layout& layout() const { return layout_; }
    VkCullModeFlags cull() const { return cull_; }
    VkFrontFace front() const { return front_; }

 private:
    Layout layout_;
    Owned<VkPipeline, destroy_pipeline> pipeline_;
    GlOwned<GlPipeline> gl_;
    VkCullModeFlags cull_ = VK_CULL_MODE_NONE;
    VkFrontFace front_ = VK_FRONT_FACE_COUNTER_CLOCKWISE;
};

}  // namespace etalon::gpu
