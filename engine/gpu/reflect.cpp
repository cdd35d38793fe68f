#include <algorithm>

#include "engine/base/error.h"
#include "engine/gpu/shader.h"
#include "engine/gpu/spirv_module.h"

namespace etalon::gpu {
namespace {

VkShaderStageFlagBits stage_of(SpvExecutionModel model)
{
    switch (model) {
        case SpvExecutionModelVertex:
            return VK_SHADER_STAGE_VERTEX_BIT;
        case SpvExecutionModelFragment:
            return VK_SHADER_STAGE_FRAGMENT_BIT;
        case SpvExecutionModelGLCompute:
            return VK_SHADER_STAGE_COMPUTE_BIT;
        default:
            throw Error(Blame::input, "a shader is neither vertex, fragment nor compute");
    }
}

VkDescriptorType descriptor_type(spvc_resource_type resource, bool of_buffer)
{
    switch (resource) {
        case SPVC_RESOURCE_TYPE_UNIFORM_BUFFER:
            return VK_DESCRIPTOR_TYPE_UNIFORM_BUFFER;
        case SPVC_RESOURCE_TYPE_STORAGE_BUFFER:
            return VK_DESCRIPTOR_TYPE_STORAGE_BUFFER;
        case SPVC_RESOURCE_TYPE_STORAGE_IMAGE:
            return of_buffer ? VK_DESCRIPTOR_TYPE_STORAGE_TEXEL_BUFFER : VK_DESCRIPTOR_TYPE_STORAGE_IMAGE;
        case SPVC_RESOURCE_TYPE_SAMPLED_IMAGE:
            return of_buffer ? VK_DESCRIPTOR_TYPE_UNIFORM_TEXEL_BUFFER : VK_DESCRIPTOR_TYPE_COMBINED_IMAGE_SAMPLER;
        case SPVC_RESOURCE_TYPE_SEPARATE_IMAGE:
            return of_buffer ? VK_DESCRIPTOR_TYPE_UNIFORM_TEXEL_BUFFER : VK_DESCRIPTOR_TYPE_SAMPLED_IMAGE;
        default:
            return VK_DESCRIPTOR_TYPE_SAMPLER;
    }
}

bool is_image(spvc_resource_type resource)
{
    return resource == SPVC_RESOURCE_TYPE_STORAGE_IMAGE || resource == SPVC_RESOURCE_TYPE_SAMPLED_IMAGE ||
           resource == SPVC_RESOURCE_TYPE_SEPARATE_IMAGE;
}

void add_bindings(const SpirvModule& module, spvc_resource_type resource, Interface& out)
{
    for (const spvc_reflected_resource& found : module.list(resource)) {
        const spvc_type type = spvc_compiler_get_type_handle(module.compiler(), found.type_id);
        const bool of_buffer = is_image(resource) && spvc_type_get_image_dimension(type) == SpvDimBuffer;
        std::uint32_t count = 1;
        for (unsigned i = 0; i < spvc_type_get_num_array_dimensions(type); ++i)
            count *= spvc_type_get_array_dimension(type, i);
        if (count == 0) throw Error(Blame::input, std::string(found.name) + ": arrays of bindings need a fixed size");
        const auto decoration = [&](SpvDecoration which) {
            return spvc_compiler_get_decoration(module.compiler(), found.id, which);
        };
        out.bindings.push_back({.set = decoration(SpvDecorationDescriptorSet),
                                .binding = decoration(SpvDecorationBinding),
                                .type = descriptor_type(resource, of_buffer),
                                .count = count,
                                .stages = static_cast<VkShaderStageFlags>(out.stage)});
    }
}

}  // namespace

Interface reflect(std::span<const std::uint32_t> code)
{
    const SpirvModule module(code, SPVC_BACKEND_NONE);
    Interface out{.stage = stage_of(spvc_compiler_get_execution_model(module.compiler()))};
    for (const spvc_resource_type resource :
         {SPVC_RESOURCE_TYPE_UNIFORM_BUFFER, SPVC_RESOURCE_TYPE_STORAGE_BUFFER, SPVC_RESOURCE_TYPE_STORAGE_IMAGE,
          SPVC_RESOURCE_TYPE_SAMPLED_IMAGE, SPVC_RESOURCE_TYPE_SEPARATE_IMAGE, SPVC_RESOURCE_TYPE_SEPARATE_SAMPLERS})
        add_bindings(module, resource, out);
    std::sort(out.bindings.begin(), out.bindings.end(), [](const DeclaredBinding& a, const DeclaredBinding& b) {
        return a.set != b.set ? a.set < b.set : a.binding < b.binding;
    });
    for (const spvc_reflected_resource& block : module.list(SPVC_RESOURCE_TYPE_PUSH_CONSTANT)) {
        std::size_t size = 0;
        const spvc_type type = spvc_compiler_get_type_handle(module.compiler(), block.base_type_id);
        module.check(spvc_compiler_get_declared_struct_size(module.compiler(), type, &size));
        out.push_constants = static_cast<std::uint32_t>((size + 3) / 4 * 4);
    }
    if (out.stage == VK_SHADER_STAGE_COMPUTE_BIT)
        for (unsigned i = 0; i < 3; ++i)
            out.workgroup[i] =
                spvc_compiler_get_execution_mode_argument_by_index(module.compiler(), SpvExecutionModeLocalSize, i);
    return out;
}

}  // namespace etalon::gpu
