#include "engine/gpu/pipeline.h"

#include <fmt/format.h>

#include <algorithm>

#include "engine/base/error.h"
#include "engine/gpu/device_state.h"
#include "engine/gpu/gl_pipeline.h"

namespace etalon::gpu {
namespace {

void destroy_shader_module(const DeviceState& state, VkShaderModule module)
{
    state.vk.vkDestroyShaderModule(state.device, module, state.instance.allocator);
}

/// A stage as pipeline creation wants it; needed until then.
class Stage {
 public:
    Stage(const DeviceState& state, const ShaderSpec& spec, VkShaderStageFlagBits stage)
    {
        const std::vector<std::uint32_t> code = specialize(spec);
        const VkShaderModuleCreateInfo info{.sType = VK_STRUCTURE_TYPE_SHADER_MODULE_CREATE_INFO,
                                            .codeSize = code.size() * sizeof code[0],
                                            .pCode = code.data()};
        VkShaderModule module = VK_NULL_HANDLE;
        check(state.vk.vkCreateShaderModule(state.device, &info, state.instance.allocator, &module),
              "vkCreateShaderModule");
        module_ = {state, module};
        info_ = {.sType = VK_STRUCTURE_TYPE_PIPELINE_SHADER_STAGE_CREATE_INFO,
                 .stage = stage,
                 .module = module,
                 .pName = "main"};
    }

    const VkPipelineShaderStageCreateInfo& info() const { return info_; }

 private:
    Owned<VkShaderModule, destroy_shader_module> module_;
    VkPipelineShaderStageCreateInfo info_{};
};

Interface reflect_as(const ShaderSpec& shader, VkShaderStageFlagBits stage, const std::string& pipeline)
{
    try {
        if (shader.code.empty()) throw Error(Blame::input, "the shader is absent from this build");
        Interface found = reflect(shader.code);
        if (found.stage != stage) throw Error(Blame::input, "a shader stands at the place of another stage");
        return found;
    } catch (Error& error) {
        error.at(fmt::format("pipeline \"{}\"", pipeline));
        throw;
    }
}

VkPipelineColorBlendAttachmentState blend_state(Blend blend)
{
    constexpr VkColorComponentFlags kAll =
        VK_COLOR_COMPONENT_R_BIT | VK_COLOR_COMPONENT_G_BIT | VK_COLOR_COMPONENT_B_BIT | VK_COLOR_COMPONENT_A_BIT;
    if (blend == Blend::none) return {.colorWriteMask = kAll};
    const VkBlendFactor target = blend == Blend::add ? VK_BLEND_FACTOR_ONE : VK_BLEND_FACTOR_ONE_MINUS_SRC_ALPHA;
    return {.blendEnable = VK_TRUE,
            .srcColorBlendFactor = VK_BLEND_FACTOR_ONE,
            .dstColorBlendFactor = target,
            .colorBlendOp = VK_BLEND_OP_ADD,
            .srcAlphaBlendFactor = VK_BLEND_FACTOR_ONE,
            .dstAlphaBlendFactor = target,
            .alphaBlendOp = VK_BLEND_OP_ADD,
            .colorWriteMask = kAll};
}

/// The fixed-function description of a graphics pipeline; the create info points into it.
struct FixedFunction {
    std::vector<VkVertexInputBindingDescription> streams;
    std::vector<VkVertexInputAttributeDescription> attributes;
    std::vector<VkPipelineColorBlendAttachmentState> blends;
    std::vector<VkFormat> formats;

    explicit FixedFunction(const GraphicsPipelineSpec& spec)
    {
        for (const VertexStream& stream : spec.streams)
            streams.push_back({static_cast<std::uint32_t>(streams.size()), stream.stride,
                               stream.per_instance ? VK_VERTEX_INPUT_RATE_INSTANCE : VK_VERTEX_INPUT_RATE_VERTEX});
        for (const VertexAttribute& attribute : spec.attributes)
            attributes.push_back({attribute.location, attribute.stream, attribute.format, attribute.offset});
        for (const ColorFormat& color : spec.colors) {
            blends.push_back(blend_state(color.blend));
            formats.push_back(color.format);
        }
    }
};

VkPipeline create_graphics(const DeviceState& state, const GraphicsPipelineSpec& spec, VkPipelineLayout layout)
{
    const Stage vertex(state, spec.vertex, VK_SHADER_STAGE_VERTEX_BIT);
    const Stage fragment(state, spec.fragment, VK_SHADER_STAGE_FRAGMENT_BIT);
    const VkPipelineShaderStageCreateInfo stages[] = {vertex.info(), fragment.info()};
    const FixedFunction fixed(spec);
    const VkPipelineVertexInputStateCreateInfo input{
        .sType = VK_STRUCTURE_TYPE_PIPELINE_VERTEX_INPUT_STATE_CREATE_INFO,
        .vertexBindingDescriptionCount = static_cast<std::uint32_t>(fixed.streams.size()),
        .pVertexBindingDescriptions = fixed.streams.data(),
        .vertexAttributeDescriptionCount = static_cast<std::uint32_t>(fixed.attributes.size()),
        .pVertexAttributeDescriptions = fixed.attributes.data()};
    const VkPipelineInputAssemblyStateCreateInfo assembly{
        .sType = VK_STRUCTURE_TYPE_PIPELINE_INPUT_ASSEMBLY_STATE_CREATE_INFO, .topology = spec.topology};
    const VkPipelineViewportStateCreateInfo viewport{
        .sType = VK_STRUCTURE_TYPE_PIPELINE_VIEWPORT_STATE_CREATE_INFO, .viewportCount = 1, .scissorCount = 1};
    const VkPipelineRasterizationStateCreateInfo rasterization{
        .sType = VK_STRUCTURE_TYPE_PIPELINE_RASTERIZATION_STATE_CREATE_INFO,
        .polygonMode = spec.wireframe ? VK_POLYGON_MODE_LINE : VK_POLYGON_MODE_FILL,
        .lineWidth = 1};
    const VkPipelineMultisampleStateCreateInfo multisample{
        .sType = VK_STRUCTURE_TYPE_PIPELINE_MULTISAMPLE_STATE_CREATE_INFO,
        .rasterizationSamples = static_cast<VkSampleCountFlagBits>(spec.samples)};
    const bool has_depth = spec.depth.format != VK_FORMAT_UNDEFINED;
    const VkPipelineDepthStencilStateCreateInfo depth{
        .sType = VK_STRUCTURE_TYPE_PIPELINE_DEPTH_STENCIL_STATE_CREATE_INFO,
        .depthTestEnable = has_depth && spec.depth.test ? VK_TRUE : VK_FALSE,
        .depthWriteEnable = has_depth && spec.depth.write ? VK_TRUE : VK_FALSE,
        .depthCompareOp = spec.depth.passes};
    const VkPipelineColorBlendStateCreateInfo blend{.sType = VK_STRUCTURE_TYPE_PIPELINE_COLOR_BLEND_STATE_CREATE_INFO,
                                                    .attachmentCount = static_cast<std::uint32_t>(fixed.blends.size()),
                                                    .pAttachments = fixed.blends.data()};
    const VkDynamicState dynamics[] = {VK_DYNAMIC_STATE_VIEWPORT, VK_DYNAMIC_STATE_SCISSOR, VK_DYNAMIC_STATE_CULL_MODE,
                                       VK_DYNAMIC_STATE_FRONT_FACE};
    const VkPipelineDynamicStateCreateInfo dynamic{.sType = VK_STRUCTURE_TYPE_PIPELINE_DYNAMIC_STATE_CREATE_INFO,
                                                   .dynamicStateCount = 4,
                                                   .pDynamicStates = dynamics};
    const VkPipelineRenderingCreateInfo rendering{
        .sType = VK_STRUCTURE_TYPE_PIPELINE_RENDERING_CREATE_INFO,
        .colorAttachmentCount = static_cast<std::uint32_t>(fixed.formats.size()),
        .pColorAttachmentFormats = fixed.formats.data(),
        .depthAttachmentFormat = spec.depth.format};
    const VkGraphicsPipelineCreateInfo info{.sType = VK_STRUCTURE_TYPE_GRAPHICS_PIPELINE_CREATE_INFO,
                                            .pNext = &rendering,
                                            .stageCount = 2,
                                            .pStages = stages,
                                            .pVertexInputState = &input,
                                            .pInputAssemblyState = &assembly,
                                            .pViewportState = &viewport,
                                            .pRasterizationState = &rasterization,
                                            .pMultisampleState = &multisample,
                                            .pDepthStencilState = &depth,
                                            .pColorBlendState = &blend,
                                            .pDynamicState = &dynamic,
                                            .layout = layout};
    VkPipeline pipeline = VK_NULL_HANDLE;
    check(
        state.vk.vkCreateGraphicsPipelines(state.device, VK_NULL_HANDLE, 1, &info, state.instance.allocator, &pipeline),
        "vkCreateGraphicsPipelines");
    return pipeline;
}

}  // namespace

void destroy_pipeline(const DeviceState& state, VkPipeline pipeline)
{
    state.vk.vkDestroyPipeline(state.device, pipeline, state.instance.allocator);
}

void destroy_pipeline_layout(const DeviceState& state, VkPipelineLayout layout)
{
    state.vk.vkDestroyPipelineLayout(state.device, layout, state.instance.allocator);
}

void destroy_set_layout(const DeviceState& state, VkDescriptorSetLayout layout)
{
    state.vk.vkDestroyDescriptorSetLayout(state.device, layout, state.instance.allocator);
}

Layout::Layout(Device& device, std::span<const Interface> stages, std::string name) : name_(std::move(name))
{
    for (const Interface& stage : stages) {
        for (const DeclaredBinding& declared : stage.bindings) {
            const auto same = std::find_if(bindings_.begin(), bindings_.end(), [&](const DeclaredBinding& other) {
                return other.set == declared.set && other.binding == declared.binding;
            });
            if (same == bindings_.end())
                bindings_.push_back(declared);
            else if (same->type != declared.type || same->count != declared.count)
                throw Error(Blame::input, fmt::format("pipeline \"{}\": two declarations of set {}, binding {} differ",
                                                      name_, declared.set, declared.binding));
            else
                same->stages |= declared.stages;
        }
        push_constants_ = std::max(push_constants_, stage.push_constants);
        if (stage.push_constants > 0) push_stages_ |= static_cast<VkShaderStageFlags>(stage.stage);
    }
    if (push_constants_ > device.limits().push_constants)
        throw Error(Blame::machine, fmt::format("{} bytes of push constants are needed; this device allows {}",
                                                push_constants_, device.limits().push_constants));
    if (device.gl() != nullptr) return;

    const DeviceState& state = device.state();
    std::uint32_t set_count = 0;
    for (const DeclaredBinding& declared : bindings_) set_count = std::max(set_count, declared.set + 1);
    std::vector<VkDescriptorSetLayout> handles;
    for (std::uint32_t index = 0; index < set_count; ++index) {
        std::vector<VkDescriptorSetLayoutBinding> entries;
        for (const DeclaredBinding& declared : bindings_)
            if (declared.set == index)
                entries.push_back({declared.binding, declared.type, declared.count, declared.stages, nullptr});
        const VkDescriptorSetLayoutCreateInfo info{.sType = VK_STRUCTURE_TYPE_DESCRIPTOR_SET_LAYOUT_CREATE_INFO,
                                                   .bindingCount = static_cast<std::uint32_t>(entries.size()),
                                                   .pBindings = entries.data()};
        VkDescriptorSetLayout handle = VK_NULL_HANDLE;
        check(state.vk.vkCreateDescriptorSetLayout(state.device, &info, state.instance.allocator, &handle),
              "vkCreateDescriptorSetLayout");
        sets_.push_back(Owned<VkDescriptorSetLayout, destroy_set_layout>(state, handle));
        handles.push_back(handle);
    }
    const VkPushConstantRange range{push_stages_, 0, push_constants_};
    const VkPipelineLayoutCreateInfo info{.sType = VK_STRUCTURE_TYPE_PIPELINE_LAYOUT_CREATE_INFO,
                                          .setLayoutCount = set_count,
                                          .pSetLayouts = handles.data(),
                                          .pushConstantRangeCount = push_constants_ > 0 ? 1u : 0u,
                                          .pPushConstantRanges = &range};
    VkPipelineLayout layout = VK_NULL_HANDLE;
    check(state.vk.vkCreatePipelineLayout(state.device, &info, state.instance.allocator, &layout),
          "vkCreatePipelineLayout");
    layout_ = {state, layout};
}

ComputePipeline::ComputePipeline(Device& device, const ComputePipelineSpec& spec)
{
    const Interface found = reflect_as(spec.shader, VK_SHADER_STAGE_COMPUTE_BIT, spec.name);
    std::copy_n(found.workgroup, 3, workgroup_);
    layout_ = Layout(device, std::span(&found, 1), spec.name);
    if (GlDevice* gl = device.gl()) {
        gl_.reset(new GlPipeline(*gl, spec));
        return;
    }
    const DeviceState& state = device.state();
    const Stage stage(state, spec.shader, VK_SHADER_STAGE_COMPUTE_BIT);
    const VkComputePipelineCreateInfo info{
        .sType = VK_STRUCTURE_TYPE_COMPUTE_PIPELINE_CREATE_INFO, .stage = stage.info(), .layout = layout_.handle()};
    VkPipeline pipeline = VK_NULL_HANDLE;
    check(
        state.vk.vkCreateComputePipelines(state.device, VK_NULL_HANDLE, 1, &info, state.instance.allocator, &pipeline),
        "vkCreateComputePipelines");
    pipeline_ = {state, pipeline};
    set_name(state, VK_OBJECT_TYPE_PIPELINE, reinterpret_cast<std::uint64_t>(pipeline), spec.name);
}

GraphicsPipeline::GraphicsPipeline(Device& device, const GraphicsPipelineSpec& spec)
    : cull_(spec.cull), front_(spec.front)
{
    const Interface stages[] = {reflect_as(spec.vertex, VK_SHADER_STAGE_VERTEX_BIT, spec.name),
                                reflect_as(spec.fragment, VK_SHADER_STAGE_FRAGMENT_BIT, spec.name)};
    layout_ = Layout(device, stages, spec.name);
    if (GlDevice* gl = device.gl()) {
        gl_.reset(new GlPipeline(*gl, spec));
        return;
    }
    const DeviceState& state = device.state();
    const VkPipeline pipeline = create_graphics(state, spec, layout_.handle());
    pipeline_ = {state, pipeline};
    set_name(state, VK_OBJECT_TYPE_PIPELINE, reinterpret_cast<std::uint64_t>(pipeline), spec.name);
}

}  // namespace etalon::gpu
