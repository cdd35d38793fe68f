#pragma once
#include <vulkan/vulkan_core.h>

#include <bit>
#include <cstdint>
#include <span>
#include <vector>

namespace etalon::gpu {

/// The value of a specialization constant: `layout(constant_id = id) const T name`, T of bool, int, uint or float.
struct Constant {
    std::uint32_t id = 0;
    std::uint32_t bits = 0;

    Constant(std::uint32_t constant, bool value) : id(constant), bits(value ? 1u : 0u) {}
    Constant(std::uint32_t constant, std::uint32_t value) : id(constant), bits(value) {}
    Constant(std::uint32_t constant, std::int32_t value) : id(constant), bits(std::bit_cast<std::uint32_t>(value)) {}
    Constant(std::uint32_t constant, float value) : id(constant), bits(std::bit_cast<std::uint32_t>(value)) {}
};

/// One stage of a pipeline: SPIR-V whose entry point is `main`, with its specialization constants. `code` is read while
/// the pipeline is made and not after.
struct ShaderSpec {
    std::span<const std::uint32_t> code;
    std::vector<Constant> constants;
};

/// A binding that a shader declares: `layout(set = s, binding = b)`.
struct DeclaredBinding {
    std::uint32_t set = 0;
    std::uint32_t binding = 0;
    VkDescriptorType type = VK_DESCRIPTOR_TYPE_STORAGE_BUFFER;
    std::uint32_t count = 1;  ///< elements of an array of descriptors
    VkShaderStageFlags stages = 0;
};

/// What a shader wants bound, read from its SPIR-V.
struct Interface {
    VkShaderStageFlagBits stage = VK_SHADER_STAGE_COMPUTE_BIT;
    std::vector<DeclaredBinding> bindings;   ///< by set, then binding
    std::uint32_t push_constants = 0;        ///< bytes
    std::uint32_t workgroup[3] = {1, 1, 1};  ///< local size of a compute shader (as compiled, before specialization)
};

/// Throws Error(input) when `code` is not SPIR-V.
Interface reflect(std::span<const std::uint32_t> code);

/// The shader's SPIR-V with its constants fixed and what they turn off taken away; it means the same. Constants of ids
/// that the shader does not declare are ignored, those not given keep their defaults. Drivers translate all of a module
/// before they specialise it: this makes lavapipe's pipelines up to ten times sooner ready (docs/architecture.md,
/// "Shaders"). Throws Error(input) when `code` is not SPIR-V.
std::vector<std::uint32_t> specialize(const ShaderSpec& shader);

}  // namespace etalon::gpu
