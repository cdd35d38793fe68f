#include "engine/gpu/device.h"

#include <fmt/format.h>

#include <algorithm>
#include <thread>

#include "engine/base/error.h"
#include "engine/base/memory.h"
#include "engine/gpu/device_state.h"
#include "engine/gpu/gl_device.h"

namespace etalon::gpu {
namespace {

[[noreturn]] void throw_no_device(const std::vector<Candidate>& candidates)
{
    std::string what = "no Vulkan device of this machine will do:";
    if (candidates.empty()) what += " there is none";
    for (const Candidate& candidate : candidates)
        what += fmt::format("{} device {} ({}) {}", &candidate == candidates.data() ? "" : ";", candidate.report.index,
                            candidate.report.name, fmt::join(candidate.report.reasons, ", "));
    throw Error(Blame::machine, std::move(what),
                "see the devices and their reasons with `etalon info`; without a GPU, Mesa's lavapipe serves: "
                "apt install mesa-vulkan-drivers");
}

std::uint64_t default_budget(const DeviceReport& report)
{
    return (report.kind == DeviceKind::cpu ? memory_of_machine() : report.memory) / 4 * 3;
}

/// Required features, and those optional ones that something in this project can use.
struct Features {
    VkPhysicalDeviceVulkan13Features v13{.sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_VULKAN_1_3_FEATURES};
    VkPhysicalDeviceVulkan12Features v12{.sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_VULKAN_1_2_FEATURES, .pNext = &v13};
    VkPhysicalDeviceFeatures2 core{.sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_FEATURES_2, .pNext = &v12};

    Features(const Instance& instance, VkPhysicalDevice physical)
    {
        VkPhysicalDeviceFeatures2 has{.sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_FEATURES_2};
        instance.vk.vkGetPhysicalDeviceFeatures2(physical, &has);
        v13.dynamicRendering = VK_TRUE;
        v13.synchronization2 = VK_TRUE;
        v13.maintenance4 = VK_TRUE;  // part of 1.3; SPIR-V 1.6 states workgroup sizes by constants, which it allows
        v12.timelineSemaphore = VK_TRUE;
        v12.bufferDeviceAddress = VK_TRUE;
        v12.scalarBlockLayout = VK_TRUE;
        v12.hostQueryReset = VK_TRUE;  // part of 1.2
        for (const auto feature : {&VkPhysicalDeviceFeatures::samplerAnisotropy,
                                   &VkPhysicalDeviceFeatures::shaderFloat64,
                                   &VkPhysicalDeviceFeatures::shaderInt64,
                                   &VkPhysicalDeviceFeatures::shaderInt16,
                                   &VkPhysicalDeviceFeatures::fillModeNonSolid,
                                   &VkPhysicalDeviceFeatures::wideLines,
                                   &VkPhysicalDeviceFeatures::largePoints,
                                   &VkPhysicalDeviceFeatures::independentBlend,
                                   &VkPhysicalDeviceFeatures::sampleRateShading,
                                   &VkPhysicalDeviceFeatures::geometryShader,
                                   &VkPhysicalDeviceFeatures::multiDrawIndirect,
                                   &VkPhysicalDeviceFeatures::drawIndirectFirstInstance,
                                   &VkPhysicalDeviceFeatures::fullDrawIndexUint32,
                                   &VkPhysicalDeviceFeatures::fragmentStoresAndAtomics,
                                   &VkPhysicalDeviceFeatures::vertexPipelineStoresAndAtomics,
                                   &VkPhysicalDeviceFeatures::shaderStorageImageReadWithoutFormat,
                                   &VkPhysicalDeviceFeatures::shaderStorageImageWriteWithoutFormat,
                                   &VkPhysicalDeviceFeatures::shaderStorageImageExtendedFormats,
                                   &VkPhysicalDeviceFeatures::shaderSampledImageArrayDynamicIndexing,
                                   &VkPhysicalDeviceFeatures::shaderStorageBufferArrayDynamicIndexing})
            core.features.*feature = has.features.*feature;
    }
};

}  // namespace

/// A software device's threads and compiler take address space, and lavapipe 22.3.6 crashes where they get none:
/// measured with 2 processors, whose threads reserve 128 MiB each, 620 MiB beyond what it has when loaded were too few,
/// 825 were enough.
void check_address_space(std::string_view device)
{
    constexpr std::uint64_t kMiB = 1 << 20;
    const std::uint64_t need = (564 + 128 * std::uint64_t{std::max(1u, std::thread::hardware_concurrency())}) * kMiB;
    const std::uint64_t have = address_space_left();
    if (have >= need) return;
    throw Error(Blame::machine,
                fmt::format("the device {} needs about {} MiB of address space; this process may have {} more", device,
                            need / kMiB, have / kMiB),
                "raise the limit (ulimit -v), or use --renderer reference");
}

DeviceState::DeviceState(const DeviceOptions& options) : instance(options)
{
    const std::vector<Candidate> judged = choose(instance, options);
    for (const Candidate& candidate : judged) candidates.push_back(candidate.report);
    const auto chosen =
        std::find_if(judged.begin(), judged.end(), [](const Candidate& candidate) { return candidate.report.chosen; });
    if (chosen == judged.end()) throw_no_device(judged);
    try {
        create(*chosen);
        memory =
            std::make_unique<MemoryPool>(*this, options.memory_budget.value_or(default_budget(report)), options.staged);
    } catch (...) {
        release();
        throw;
    }
}

void DeviceState::create(const Candidate& candidate)
{
    if (candidate.report.kind == DeviceKind::cpu) check_address_space(candidate.report.name);
    report = candidate.report;
    physical = candidate.physical;
    queue_family = candidate.queue_family;
    limits = query_limits(instance, candidate);

    const Features features(instance, physical);
    const float priority = 1;
    const VkDeviceQueueCreateInfo queue_info{.sType = VK_STRUCTURE_TYPE_DEVICE_QUEUE_CREATE_INFO,
                                             .queueFamilyIndex = queue_family,
                                             .queueCount = 1,
                                             .pQueuePriorities = &priority};
    const char* const swapchain = VK_KHR_SWAPCHAIN_EXTENSION_NAME;
    const VkDeviceCreateInfo info{.sType = VK_STRUCTURE_TYPE_DEVICE_CREATE_INFO,
                                  .pNext = &features.core,
                                  .queueCreateInfoCount = 1,
                                  .pQueueCreateInfos = &queue_info,
                                  .enabledExtensionCount = instance.surface != VK_NULL_HANDLE ? 1u : 0u,
                                  .ppEnabledExtensionNames = &swapchain};
    check(instance.vk.vkCreateDevice(physical, &info, instance.allocator, &device), "vkCreateDevice");
    // volk reads one global to fill a device's table; the loader's answer is the same for every instance.
    static const bool loaded = (volkLoadInstanceOnly(instance.handle), true);
    assume(loaded);
    volkLoadDeviceTable(&vk, device);
    vk.vkGetDeviceQueue(device, queue_family, 0, &queue);

    const VkSemaphoreTypeCreateInfo type{.sType = VK_STRUCTURE_TYPE_SEMAPHORE_TYPE_CREATE_INFO,
                                         .semaphoreType = VK_SEMAPHORE_TYPE_TIMELINE};
    const VkSemaphoreCreateInfo semaphore{.sType = VK_STRUCTURE_TYPE_SEMAPHORE_CREATE_INFO, .pNext = &type};
    check(vk.vkCreateSemaphore(device, &semaphore, instance.allocator, &timeline), "vkCreateSemaphore");
}

DeviceState::~DeviceState()
{
    release();
}

void DeviceState::release()
{
    if (device == VK_NULL_HANDLE) return;
    vk.vkDeviceWaitIdle(device);
    memory.reset();
    if (timeline != VK_NULL_HANDLE) vk.vkDestroySemaphore(device, timeline, instance.allocator);
    vk.vkDestroyDevice(device, instance.allocator);
    device = VK_NULL_HANDLE;
}

void set_name(const DeviceState& state, VkObjectType type, std::uint64_t handle, const std::string& text)
{
    if (!state.instance.validating || text.empty()) return;
    const VkDebugUtilsObjectNameInfoEXT info{.sType = VK_STRUCTURE_TYPE_DEBUG_UTILS_OBJECT_NAME_INFO_EXT,
                                             .objectType = type,
                                             .objectHandle = handle,
                                             .pObjectName = text.c_str()};
    check(state.instance.vk.vkSetDebugUtilsObjectNameEXT(state.device, &info), "vkSetDebugUtilsObjectNameEXT");
}

void wait(const DeviceState& state, Ticket ticket, std::chrono::milliseconds timeout)
{
    const VkSemaphoreWaitInfo info{.sType = VK_STRUCTURE_TYPE_SEMAPHORE_WAIT_INFO,
                                   .semaphoreCount = 1,
                                   .pSemaphores = &state.timeline,
                                   .pValues = &ticket};
    const auto nanoseconds = std::chrono::duration_cast<std::chrono::nanoseconds>(timeout).count();
    const VkResult result =
        state.vk.vkWaitSemaphores(state.device, &info, static_cast<std::uint64_t>(std::max<long>(0, nanoseconds)));
    if (result == VK_TIMEOUT)
        throw Error(Blame::machine,
                    fmt::format("the device {} did not finish its work within {:.1f} s", state.report.name,
                                static_cast<double>(timeout.count()) / 1000),
                    "try a smaller picture, or another device (see etalon info)");
    check(result, "vkWaitSemaphores");
}

std::string_view name(Backend backend)
{
    return backend == Backend::vulkan ? "vulkan" : "opengl";
}

Device::Device(const DeviceOptions& options) : options_(options)
{
    make();
}
Device::Device(Device&&) noexcept = default;
Device& Device::operator=(Device&&) noexcept = default;
Device::~Device() = default;

void Device::make()
{
    if (options_.backend == Backend::opengl)
        gl_ = std::make_unique<GlDevice>(options_);
    else
        state_ = std::make_unique<DeviceState>(options_);
}

void Device::renew()
{
    if (state_ || gl_) earlier_messages_ = validation_messages();
    state_.reset();  // before the new one: some drivers have room for one alone
    gl_.reset();
    make();
}

const DeviceReport& Device::report() const
{
    return gl_ ? gl_->report() : state_->report;
}
const std::vector<DeviceReport>& Device::candidates() const
{
    return gl_ ? gl_->candidates() : state_->candidates;
}
const DeviceLimits& Device::limits() const
{
    return gl_ ? gl_->limits() : state_->limits;
}
MemoryUse Device::memory() const
{
    return gl_ ? gl_->memory() : state_->memory->use();
}
bool Device::unified_memory() const
{
    return !gl_ && state_->memory->unified();
}
VkInstance Device::instance() const
{
    return state().instance.handle;
}
VkSurfaceKHR Device::surface() const
{
    return state().instance.surface;
}
bool Device::validating() const
{
    return gl_ ? gl_->validating() : state_->instance.validating;
}

std::string Device::description() const
{
    return fmt::format("{}, {}, {} {}", report().name, report().driver, gl_ ? "OpenGL" : "Vulkan",
                       report().api_version);
}

void Device::wait(Ticket ticket, std::chrono::milliseconds timeout) const
{
    if (gl_) return gl_->wait(ticket, timeout);
    gpu::wait(*state_, ticket, timeout);
}

bool Device::supports(VkFormat format, VkFormatFeatureFlags features, std::uint32_t samples) const
{
    if (gl_) return gl_->supports(format, samples);
    const InstanceTable& vk = state_->instance.vk;
    VkFormatProperties has{};
    vk.vkGetPhysicalDeviceFormatProperties(state_->physical, format, &has);
    if ((has.optimalTilingFeatures & features) != features) return false;
    const bool depth = (has.optimalTilingFeatures & VK_FORMAT_FEATURE_DEPTH_STENCIL_ATTACHMENT_BIT) != 0;
    const VkImageUsageFlags usage = samples == 1 ? VK_IMAGE_USAGE_SAMPLED_BIT
                                    : depth      ? VK_IMAGE_USAGE_DEPTH_STENCIL_ATTACHMENT_BIT
                                                 : VK_IMAGE_USAGE_COLOR_ATTACHMENT_BIT;
    VkImageFormatProperties can{};
    const VkResult result = vk.vkGetPhysicalDeviceImageFormatProperties(state_->physical, format, VK_IMAGE_TYPE_2D,
                                                                        VK_IMAGE_TILING_OPTIMAL, usage, 0, &can);
    if (result == VK_ERROR_FORMAT_NOT_SUPPORTED) return false;
    check(result, "vkGetPhysicalDeviceImageFormatProperties");
    return (can.sampleCounts & samples) != 0;
}

bool Device::finished(Ticket ticket) const
{
    if (gl_) return gl_->finished(ticket);
    std::uint64_t value = 0;
    check(state_->vk.vkGetSemaphoreCounterValue(state_->device, state_->timeline, &value),
          "vkGetSemaphoreCounterValue");
    return value >= ticket;
}

void Device::wait_idle() const
{
    if (gl_) return gl_->gl().Finish();
    const std::lock_guard lock(state_->queue_mutex);
    check(state_->vk.vkDeviceWaitIdle(state_->device), "vkDeviceWaitIdle");
}

std::vector<std::string> Device::validation_messages() const
{
    std::vector<std::string> messages = earlier_messages_;
    if (gl_) {
        const std::vector<std::string> said = gl_->messages();
        messages.insert(messages.end(), said.begin(), said.end());
        return messages;
    }
    const std::lock_guard lock(state_->instance.log.mutex);
    messages.insert(messages.end(), state_->instance.log.messages.begin(), state_->instance.log.messages.end());
    return messages;
}

}  // namespace etalon::gpu
