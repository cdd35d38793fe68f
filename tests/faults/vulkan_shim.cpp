#include "tests/faults/vulkan_shim.h"

#include <algorithm>
#include <cstring>
#include <mutex>
#include <optional>

#include "engine/base/error.h"
#include "engine/gpu/device.h"

namespace etalon::test {
namespace {

enum Results : unsigned { memory = 1, lost = 2, timeout = 4 };

/// Functions that can fail, and in which of the ways that are injected (Vulkan 1.3, "Return Codes" of each).
#define ETALON_CALLS(X)                                 \
    X(vkCreateInstance, memory)                         \
    X(vkEnumerateInstanceLayerProperties, memory)       \
    X(vkEnumeratePhysicalDevices, memory)               \
    X(vkCreateDevice, memory | lost)                    \
    X(vkCreateDebugUtilsMessengerEXT, memory)           \
    X(vkSetDebugUtilsObjectNameEXT, memory)             \
    X(vkGetPhysicalDeviceImageFormatProperties, memory) \
    X(vkCreateSemaphore, memory)                        \
    X(vkCreateBuffer, memory)                           \
    X(vkCreateBufferView, memory)                       \
    X(vkCreateImage, memory)                            \
    X(vkCreateImageView, memory)                        \
    X(vkCreateSampler, memory)                          \
    X(vkCreateShaderModule, memory)                     \
    X(vkCreatePipelineCache, memory)                    \
    X(vkGetPipelineCacheData, memory)                   \
    X(vkCreatePipelineLayout, memory)                   \
    X(vkCreateDescriptorSetLayout, memory)              \
    X(vkCreateDescriptorPool, memory)                   \
    X(vkAllocateDescriptorSets, memory)                 \
    X(vkCreateGraphicsPipelines, memory)                \
    X(vkCreateComputePipelines, memory)                 \
    X(vkCreateCommandPool, memory)                      \
    X(vkAllocateCommandBuffers, memory)                 \
    X(vkBeginCommandBuffer, memory)                     \
    X(vkEndCommandBuffer, memory)                       \
    X(vkCreateQueryPool, memory)                        \
    X(vkGetQueryPoolResults, memory | lost)             \
    X(vkAllocateMemory, memory)                         \
    X(vkMapMemory, memory)                              \
    X(vkBindBufferMemory, memory)                       \
    X(vkBindImageMemory, memory)                        \
    X(vkQueueSubmit2, memory | lost)                    \
    X(vkQueueWaitIdle, memory | lost)                   \
    X(vkDeviceWaitIdle, memory | lost)                  \
    X(vkGetSemaphoreCounterValue, memory | lost)        \
    X(vkWaitSemaphores, memory | lost | timeout)

enum Call : std::size_t {
#define ETALON_INDEX(function, results) call_##function,
    ETALON_CALLS(ETALON_INDEX)
#undef ETALON_INDEX
        kCalls
};

struct Row {
    const char* function;
    unsigned results;
};
constexpr Row kRows[] = {
#define ETALON_ROW(function, results) {#function, results},
    ETALON_CALLS(ETALON_ROW)
#undef ETALON_ROW
};

bool may_return(Call call, VkResult result)
{
    switch (result) {
        case VK_ERROR_OUT_OF_HOST_MEMORY:
        case VK_ERROR_OUT_OF_DEVICE_MEMORY:
            return (kRows[call].results & memory) != 0;
        case VK_ERROR_DEVICE_LOST:
            return (kRows[call].results & lost) != 0;
        case VK_TIMEOUT:
            return (kRows[call].results & timeout) != 0;
        default:
            return false;
    }
}

thread_local bool inside_call = false;

/// What is to fail, and what was called: function pointers have no other place to keep it.
struct Plan {
    std::mutex mutex;
    std::optional<VkResult> result;
    std::size_t nth = 0;
    std::size_t times = 0;
    std::string only;
    std::size_t counted = 0;
    bool device_is_lost = false;
    VkDevice device = VK_NULL_HANDLE;
    std::vector<std::string> calls;
    std::string failed;
    PFN_vkDeviceWaitIdle wait_idle = nullptr;
    PFN_vkDestroyDevice destroy_device = nullptr;
} plan;

/// The result of a call that is to fail, instead of making it.
std::optional<VkResult> meet(Call call)
{
    const std::lock_guard lock(plan.mutex);
    if (plan.device_is_lost && call != call_vkCreateDevice && may_return(call, VK_ERROR_DEVICE_LOST))
        return VK_ERROR_DEVICE_LOST;
    if (!plan.only.empty() && plan.only != kRows[call].function) return std::nullopt;
    if (plan.result && !may_return(call, *plan.result)) return std::nullopt;
    plan.calls.emplace_back(kRows[call].function);
    const std::size_t index = plan.counted++;
    if (!plan.result || index < plan.nth || plan.times == 0) return std::nullopt;
    --plan.times;
    if (plan.failed.empty()) plan.failed = kRows[call].function;
    if (*plan.result == VK_ERROR_DEVICE_LOST && plan.device != VK_NULL_HANDLE) {
        // A lost device has nothing under way any more; the one below us does not know that it is lost.
        plan.wait_idle(plan.device);
        plan.device_is_lost = true;
    }
    return plan.result;
}

template <class Function, Call kCall>
struct Wrapped;
template <class... Arguments, Call kCall>
struct Wrapped<VkResult(VKAPI_PTR*)(Arguments...), kCall> {
    static inline VkResult(VKAPI_PTR* real)(Arguments...) = nullptr;
    static VkResult VKAPI_PTR call(Arguments... arguments)
    {
        if (const auto result = meet(kCall)) return *result;
        // The layers take a submission for made before they know: a driver's failure there would be their error. And
        // lavapipe 22.3.6 writes into the pipeline layout that it did not get.
        inside_call = kCall != call_vkQueueSubmit2 && kCall != call_vkCreatePipelineLayout;
        const VkResult done = real(arguments...);
        inside_call = false;
        if constexpr (kCall == call_vkCreateDevice) {
            const std::lock_guard lock(plan.mutex);
            const auto created = std::get<VkDevice*>(std::tuple<Arguments...>(arguments...));
            if (done == VK_SUCCESS) plan.device = *created;
            plan.device_is_lost = false;
        }
        return done;
    }
};

template <class Function, Call kCall>
PFN_vkVoidFunction wrap(PFN_vkVoidFunction real)
{
    using Wrap = Wrapped<Function, kCall>;
    if (real == nullptr || real == reinterpret_cast<PFN_vkVoidFunction>(Wrap::call)) return real;
    Wrap::real = reinterpret_cast<Function>(real);
    return reinterpret_cast<PFN_vkVoidFunction>(Wrap::call);
}

void VKAPI_PTR destroy_device(VkDevice device, const VkAllocationCallbacks* allocator)
{
    {
        const std::lock_guard lock(plan.mutex);
        plan.device = VK_NULL_HANDLE;
        plan.device_is_lost = false;
    }
    plan.destroy_device(device, allocator);
}

PFN_vkVoidFunction wrap(const char* name, PFN_vkVoidFunction real)
{
    if (std::strcmp(name, "vkDestroyDevice") == 0) {
        plan.destroy_device = reinterpret_cast<PFN_vkDestroyDevice>(real);
        return reinterpret_cast<PFN_vkVoidFunction>(destroy_device);
    }
    if (std::strcmp(name, "vkDeviceWaitIdle") == 0) plan.wait_idle = reinterpret_cast<PFN_vkDeviceWaitIdle>(real);
#define ETALON_WRAP(function, results) \
    if (std::strcmp(name, #function) == 0) return wrap<PFN_##function, call_##function>(real);
    ETALON_CALLS(ETALON_WRAP)
#undef ETALON_WRAP
    return real;
}

PFN_vkGetInstanceProcAddr real_instance_symbol = nullptr;
PFN_vkGetDeviceProcAddr real_device_symbol = nullptr;
PFN_vkCreateInstance real_create_instance = nullptr;
PFN_vkEnumerateInstanceLayerProperties real_layers = nullptr;

PFN_vkVoidFunction VKAPI_PTR instance_symbol(VkInstance instance, const char* name)
{
    return wrap(name, real_instance_symbol(instance, name));
}
PFN_vkVoidFunction VKAPI_PTR device_symbol(VkDevice device, const char* name)
{
    return wrap(name, real_device_symbol(device, name));
}

}  // namespace

VulkanShim::VulkanShim()
{
    {
        const gpu::Device first;
    }  // fills volk's globals, which are filled once
    real_instance_symbol = vkGetInstanceProcAddr;
    real_device_symbol = vkGetDeviceProcAddr;
    real_create_instance = vkCreateInstance;
    real_layers = vkEnumerateInstanceLayerProperties;
    vkGetInstanceProcAddr = instance_symbol;
    vkGetDeviceProcAddr = device_symbol;
    vkCreateInstance = reinterpret_cast<PFN_vkCreateInstance>(
        wrap("vkCreateInstance", reinterpret_cast<PFN_vkVoidFunction>(real_create_instance)));
    vkEnumerateInstanceLayerProperties = reinterpret_cast<PFN_vkEnumerateInstanceLayerProperties>(
        wrap("vkEnumerateInstanceLayerProperties", reinterpret_cast<PFN_vkVoidFunction>(real_layers)));
    watch();
}

VulkanShim::~VulkanShim()
{
    watch();
    vkGetInstanceProcAddr = real_instance_symbol;
    vkGetDeviceProcAddr = real_device_symbol;
    vkCreateInstance = real_create_instance;
    vkEnumerateInstanceLayerProperties = real_layers;
}

void VulkanShim::watch()
{
    const std::lock_guard lock(plan.mutex);
    plan.result.reset();
    plan.only.clear();
    plan.counted = plan.nth = plan.times = 0;
    plan.calls.clear();
    plan.failed.clear();
}

void VulkanShim::fail(VkResult result, std::size_t nth, std::size_t times)
{
    watch();
    const std::lock_guard lock(plan.mutex);
    plan.result = result;
    plan.nth = nth;
    plan.times = times;
}

void VulkanShim::only(std::string function)
{
    const std::lock_guard lock(plan.mutex);
    plan.only = std::move(function);
}

std::vector<std::string> VulkanShim::calls() const
{
    const std::lock_guard lock(plan.mutex);
    return plan.calls;
}

std::string VulkanShim::failed() const
{
    const std::lock_guard lock(plan.mutex);
    return plan.failed;
}

bool VulkanShim::inside()
{
    return inside_call;
}

bool may_return(const std::string& function, VkResult result)
{
    const auto row =
        std::find_if(std::begin(kRows), std::end(kRows), [&](const Row& r) { return r.function == function; });
    assume(row != std::end(kRows));
    return may_return(static_cast<Call>(row - std::begin(kRows)), result);
}

}  // namespace etalon::test
