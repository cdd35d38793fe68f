#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <cstring>

#include "engine/base/error.h"
#include "engine/gpu/device_state.h"
#include "engine/gpu/gl_device.h"

namespace etalon::gpu {
namespace {

std::string lower(std::string_view text)
{
    std::string out(text);
    for (char& c : out) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
    return out;
}

struct TypeName {
    const char* name;
    int rank;  ///< greater is preferred
};

TypeName type_name(VkPhysicalDeviceType type)
{
    switch (type) {
        case VK_PHYSICAL_DEVICE_TYPE_DISCRETE_GPU:
            return {"discrete", 4};
        case VK_PHYSICAL_DEVICE_TYPE_INTEGRATED_GPU:
            return {"integrated", 3};
        case VK_PHYSICAL_DEVICE_TYPE_VIRTUAL_GPU:
            return {"virtual", 2};
        case VK_PHYSICAL_DEVICE_TYPE_CPU:
            return {"cpu", 0};
        default:
            return {"other", 1};
    }
}

bool is_index(std::string_view text)
{
    return !text.empty() && std::all_of(text.begin(), text.end(), [](unsigned char c) { return std::isdigit(c) != 0; });
}

bool asked_for(const DeviceReport& report, const std::string& wanted)
{
    if (wanted.empty()) return true;
    if (is_index(wanted)) return fmt::format("{}", report.index) == wanted;
    return lower(report.name).find(lower(wanted)) != std::string::npos;
}

DeviceReport describe(const Instance& instance, VkPhysicalDevice physical, unsigned index)
{
    VkPhysicalDeviceDriverProperties driver{.sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_DRIVER_PROPERTIES};
    VkPhysicalDeviceProperties2 properties{.sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_PROPERTIES_2, .pNext = &driver};
    instance.vk.vkGetPhysicalDeviceProperties2(physical, &properties);
    VkPhysicalDeviceMemoryProperties memory{};
    instance.vk.vkGetPhysicalDeviceMemoryProperties(physical, &memory);

    const VkPhysicalDeviceProperties& p = properties.properties;
    DeviceReport report{.index = index, .name = p.deviceName, .type = type_name(p.deviceType).name};
    report.kind = p.deviceType == VK_PHYSICAL_DEVICE_TYPE_CPU ? DeviceKind::cpu : DeviceKind::gpu;
    report.driver = fmt::format("{}, {}", driver.driverName, driver.driverInfo);
    report.api_version = fmt::format("{}.{}.{}", VK_API_VERSION_MAJOR(p.apiVersion), VK_API_VERSION_MINOR(p.apiVersion),
                                     VK_API_VERSION_PATCH(p.apiVersion));
    for (std::uint32_t i = 0; i < memory.memoryHeapCount; ++i)
        if ((memory.memoryHeaps[i].flags & VK_MEMORY_HEAP_DEVICE_LOCAL_BIT) != 0)
            report.memory = std::max(report.memory, memory.memoryHeaps[i].size);
    if (p.apiVersion < VK_API_VERSION_1_3)
        report.reasons.push_back(fmt::format("offers Vulkan {}; 1.3 is needed", report.api_version));
    return report;
}

void check_features(const Instance& instance, VkPhysicalDevice physical, std::vector<std::string>& reasons)
{
    VkPhysicalDeviceVulkan13Features v13{.sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_VULKAN_1_3_FEATURES};
    VkPhysicalDeviceVulkan12Features v12{.sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_VULKAN_1_2_FEATURES, .pNext = &v13};
    VkPhysicalDeviceFeatures2 features{.sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_FEATURES_2, .pNext = &v12};
    instance.vk.vkGetPhysicalDeviceFeatures2(physical, &features);
    const auto need = [&](VkBool32 has, const char* what) {
        if (has == VK_FALSE) reasons.push_back(fmt::format("lacks the feature {}", what));
    };
    need(v13.dynamicRendering, "dynamicRendering");
    need(v13.synchronization2, "synchronization2");
    need(v12.timelineSemaphore, "timelineSemaphore");
    need(v12.bufferDeviceAddress, "bufferDeviceAddress");
    need(v12.scalarBlockLayout, "scalarBlockLayout");
}

void check_presentation(const Instance& instance, Candidate& candidate)
{
    std::uint32_t count = 0;
    check(instance.vk.vkEnumerateDeviceExtensionProperties(candidate.physical, nullptr, &count, nullptr),
          "vkEnumerateDeviceExtensionProperties");
    std::vector<VkExtensionProperties> extensions(count);
    check(instance.vk.vkEnumerateDeviceExtensionProperties(candidate.physical, nullptr, &count, extensions.data()),
          "vkEnumerateDeviceExtensionProperties");
    if (std::none_of(extensions.begin(), extensions.end(), [](const auto& extension) {
            return std::strcmp(extension.extensionName, VK_KHR_SWAPCHAIN_EXTENSION_NAME) == 0;
        }))
        candidate.report.reasons.emplace_back("cannot present: lacks VK_KHR_swapchain");
}

/// The family that does everything, and presents where there is a surface.
void pick_queue(const Instance& instance, Candidate& candidate)
{
    std::uint32_t count = 0;
    instance.vk.vkGetPhysicalDeviceQueueFamilyProperties(candidate.physical, &count, nullptr);
    std::vector<VkQueueFamilyProperties> families(count);
    instance.vk.vkGetPhysicalDeviceQueueFamilyProperties(candidate.physical, &count, families.data());
    bool works = false;
    for (std::uint32_t i = 0; i < count; ++i) {
        constexpr VkQueueFlags kBoth = VK_QUEUE_GRAPHICS_BIT | VK_QUEUE_COMPUTE_BIT;
        if ((families[i].queueFlags & kBoth) != kBoth) continue;
        works = true;
        VkBool32 presents = VK_TRUE;
        if (instance.surface != VK_NULL_HANDLE)
            check(instance.vk.vkGetPhysicalDeviceSurfaceSupportKHR(candidate.physical, i, instance.surface, &presents),
                  "vkGetPhysicalDeviceSurfaceSupportKHR");
        if (presents == VK_FALSE) continue;
        candidate.queue_family = i;
        return;
    }
    candidate.report.reasons.emplace_back(works ? "cannot present to this window"
                                                : "has no queue for both graphics and compute");
}

Candidate judge(const Instance& instance, const DeviceOptions& options, VkPhysicalDevice physical, unsigned index)
{
    Candidate candidate{.physical = physical, .report = describe(instance, physical, index)};
    std::vector<std::string>& reasons = candidate.report.reasons;
    if (reasons.empty()) check_features(instance, physical, reasons);
    if (instance.surface != VK_NULL_HANDLE) check_presentation(instance, candidate);
    pick_queue(instance, candidate);
    if (!asked_for(candidate.report, options.device))
        reasons.push_back(fmt::format("is not the device \"{}\" that was asked for", options.device));
    if (options.kind && *options.kind != candidate.report.kind)
        reasons.push_back(
            fmt::format("is a {} device; a {} was asked for", candidate.report.type, name(*options.kind)));
    return candidate;
}

}  // namespace

std::string_view name(DeviceKind kind)
{
    return kind == DeviceKind::cpu ? "cpu" : "gpu";
}

std::vector<Candidate> choose(const Instance& instance, const DeviceOptions& options)
{
    std::vector<Candidate> candidates;
    for (VkPhysicalDevice physical : instance.physical_devices())
        candidates.push_back(judge(instance, options, physical, static_cast<unsigned>(candidates.size())));

    const auto rank = [](const Candidate& candidate) {
        for (const VkPhysicalDeviceType type :
             {VK_PHYSICAL_DEVICE_TYPE_DISCRETE_GPU, VK_PHYSICAL_DEVICE_TYPE_INTEGRATED_GPU,
              VK_PHYSICAL_DEVICE_TYPE_VIRTUAL_GPU, VK_PHYSICAL_DEVICE_TYPE_CPU})
            if (candidate.report.type == type_name(type).name) return type_name(type).rank;
        return type_name(VK_PHYSICAL_DEVICE_TYPE_OTHER).rank;
    };
    Candidate* best = nullptr;
    for (Candidate& candidate : candidates)
        if (candidate.report.reasons.empty() && (best == nullptr || rank(candidate) > rank(*best))) best = &candidate;
    for (Candidate& candidate : candidates) {
        if (&candidate == best)
            candidate.report.chosen = true;
        else if (candidate.report.reasons.empty())
            candidate.report.reasons.push_back(fmt::format("would do, but device {} ({}, {}) comes first",
                                                           best->report.index, best->report.name, best->report.type));
    }
    return candidates;
}

std::vector<DeviceReport> list_devices(const DeviceOptions& options)
{
    if (options.backend == Backend::opengl) return list_gl_devices(options);
    const Instance instance(options);
    std::vector<DeviceReport> reports;
    for (Candidate& candidate : choose(instance, options)) reports.push_back(std::move(candidate.report));
    return reports;
}

DeviceLimits query_limits(const Instance& instance, const Candidate& candidate)
{
    VkPhysicalDeviceVulkan13Properties v13{.sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_VULKAN_1_3_PROPERTIES};
    VkPhysicalDeviceVulkan11Properties v11{.sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_VULKAN_1_1_PROPERTIES,
                                           .pNext = &v13};
    VkPhysicalDeviceProperties2 properties{.sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_PROPERTIES_2, .pNext = &v11};
    instance.vk.vkGetPhysicalDeviceProperties2(candidate.physical, &properties);
    VkPhysicalDeviceFeatures2 features{.sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_FEATURES_2};
    instance.vk.vkGetPhysicalDeviceFeatures2(candidate.physical, &features);
    std::uint32_t count = 0;
    instance.vk.vkGetPhysicalDeviceQueueFamilyProperties(candidate.physical, &count, nullptr);
    std::vector<VkQueueFamilyProperties> families(count);
    instance.vk.vkGetPhysicalDeviceQueueFamilyProperties(candidate.physical, &count, families.data());

    const VkPhysicalDeviceLimits& p = properties.properties.limits;
    DeviceLimits limits;
    limits.storage_buffer_range = p.maxStorageBufferRange;
    limits.uniform_buffer_range = p.maxUniformBufferRange;
    limits.texel_buffer_elements = p.maxTexelBufferElements;
    limits.buffer_size = v13.maxBufferSize;
    limits.allocation = v11.maxMemoryAllocationSize;
    limits.image_side = std::min({p.maxImageDimension2D, p.maxFramebufferWidth, p.maxFramebufferHeight});
    limits.image_layers = p.maxImageArrayLayers;
    limits.push_constants = p.maxPushConstantsSize;
    limits.sampled_images_per_stage = p.maxPerStageDescriptorSampledImages;
    limits.storage_buffers_per_stage = p.maxPerStageDescriptorStorageBuffers;
    limits.storage_images_per_stage = p.maxPerStageDescriptorStorageImages;
    std::copy_n(p.maxComputeWorkGroupCount, 3, limits.workgroup_count);
    std::copy_n(p.maxComputeWorkGroupSize, 3, limits.workgroup_size);
    limits.workgroup_invocations = p.maxComputeWorkGroupInvocations;
    limits.workgroup_memory = p.maxComputeSharedMemorySize;
    limits.subgroup_size = v11.subgroupSize;
    limits.samples = p.framebufferColorSampleCounts & p.framebufferDepthSampleCounts;
    limits.subpixel_bits = p.subPixelPrecisionBits;
    limits.subtexel_bits = p.subTexelPrecisionBits;
    limits.mip_bits = p.mipmapPrecisionBits;
    limits.anisotropy = features.features.samplerAnisotropy == VK_TRUE ? p.maxSamplerAnisotropy : 1.f;
    limits.timestamp_ns =
        families[candidate.queue_family].timestampValidBits > 0 ? static_cast<double>(p.timestampPeriod) : 0.0;
    limits.float64 = features.features.shaderFloat64 == VK_TRUE;
    limits.int64 = features.features.shaderInt64 == VK_TRUE;
    limits.primitive_id = features.features.geometryShader == VK_TRUE;
    limits.wide_lines = features.features.wideLines == VK_TRUE;
    limits.wireframe = features.features.fillModeNonSolid == VK_TRUE;
    return limits;
}

}  // namespace etalon::gpu
