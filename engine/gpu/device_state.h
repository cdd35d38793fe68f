#pragma once
// Inside engine/gpu only: what a Device is made of, and how its files talk to the driver.
#include <volk.h>

#include <atomic>
#include <memory>
#include <mutex>
#include <string>
#include <vector>

#include "engine/gpu/device.h"
#include "engine/gpu/memory_pool.h"

namespace etalon::gpu {

/// The Vulkan name of a result: "VK_ERROR_DEVICE_LOST".
std::string name(VkResult result);
/// Throws Error(machine) naming the call unless the result is a success; DeviceLost where that is why.
void check(VkResult result, std::string_view call);

/// Functions of an instance. volk keeps these in globals, which two instances would share.
struct InstanceTable {
    PFN_vkDestroyInstance vkDestroyInstance = nullptr;
    PFN_vkEnumeratePhysicalDevices vkEnumeratePhysicalDevices = nullptr;
    PFN_vkGetPhysicalDeviceProperties2 vkGetPhysicalDeviceProperties2 = nullptr;
    PFN_vkGetPhysicalDeviceFeatures2 vkGetPhysicalDeviceFeatures2 = nullptr;
    PFN_vkGetPhysicalDeviceMemoryProperties vkGetPhysicalDeviceMemoryProperties = nullptr;
    PFN_vkGetPhysicalDeviceQueueFamilyProperties vkGetPhysicalDeviceQueueFamilyProperties = nullptr;
    PFN_vkGetPhysicalDeviceFormatProperties vkGetPhysicalDeviceFormatProperties = nullptr;
    PFN_vkGetPhysicalDeviceImageFormatProperties vkGetPhysicalDeviceImageFormatProperties = nullptr;
    PFN_vkEnumerateDeviceExtensionProperties vkEnumerateDeviceExtensionProperties = nullptr;
    PFN_vkCreateDevice vkCreateDevice = nullptr;
    PFN_vkCreateDebugUtilsMessengerEXT vkCreateDebugUtilsMessengerEXT = nullptr;
    PFN_vkDestroyDebugUtilsMessengerEXT vkDestroyDebugUtilsMessengerEXT = nullptr;
    PFN_vkSetDebugUtilsObjectNameEXT vkSetDebugUtilsObjectNameEXT = nullptr;
    PFN_vkDestroySurfaceKHR vkDestroySurfaceKHR = nullptr;
    PFN_vkGetPhysicalDeviceSurfaceSupportKHR vkGetPhysicalDeviceSurfaceSupportKHR = nullptr;
    PFN_vkGetPhysicalDeviceSurfaceCapabilitiesKHR vkGetPhysicalDeviceSurfaceCapabilitiesKHR = nullptr;
    PFN_vkGetPhysicalDeviceSurfaceFormatsKHR vkGetPhysicalDeviceSurfaceFormatsKHR = nullptr;
};

/// What the validation layers said; written by whichever thread makes the call.
struct MessageLog {
    mutable std::mutex mutex;
    std::vector<std::string> messages;
    std::function<void(const std::string&)> heard;
};

/// An instance with its validation and the surface that it is to present to. On a machine without any driver `handle`
/// is null and there are no devices.
struct Instance {
    explicit Instance(const DeviceOptions& options);
    ~Instance();
    Instance(const Instance&) = delete;
    Instance& operator=(const Instance&) = delete;

    std::vector<VkPhysicalDevice> physical_devices() const;

    MessageLog log;
    const VkAllocationCallbacks* allocator = nullptr;
    VkInstance handle = VK_NULL_HANDLE;
    InstanceTable vk;
    VkDebugUtilsMessengerEXT messenger = VK_NULL_HANDLE;
    VkSurfaceKHR surface = VK_NULL_HANDLE;
    bool validating = false;

 private:
    void create(const DeviceOptions& options);
    void release();
};

/// One physical device as choose.cpp judged it.
struct Candidate {
    VkPhysicalDevice physical = VK_NULL_HANDLE;
    DeviceReport report;
    std::uint32_t queue_family = 0;
};

/// Judges every device; at most one report is `chosen`.
std::vector<Candidate> choose(const Instance& instance, const DeviceOptions& options);
DeviceLimits query_limits(const Instance& instance, const Candidate& candidate);

struct DeviceState {
    explicit DeviceState(const DeviceOptions& options);
    ~DeviceState();
    DeviceState(const DeviceState&) = delete;
    DeviceState& operator=(const DeviceState&) = delete;

    Instance instance;
    std::vector<DeviceReport> candidates;
    DeviceReport report;
    DeviceLimits limits;
    VkPhysicalDevice physical = VK_NULL_HANDLE;
    VkDevice device = VK_NULL_HANDLE;
    VolkDeviceTable vk{};
    std::uint32_t queue_family = 0;
    VkQueue queue = VK_NULL_HANDLE;
    std::unique_ptr<MemoryPool> memory;

    std::mutex queue_mutex;  ///< guards the queue and `submitted`
    Ticket submitted = 0;
    VkSemaphore timeline = VK_NULL_HANDLE;  ///< reaches a submission's ticket when it has finished

 private:
    void create(const Candidate& candidate);
    void release();
};

/// Throws Error(machine) where too little address space is left for a software device's threads and compiler.
void check_address_space(std::string_view device);

/// Device::wait.
void wait(const DeviceState& state, Ticket ticket, std::chrono::milliseconds timeout);

/// Shows up in validation messages; nothing when not validating.
void set_name(const DeviceState& state, VkObjectType type, std::uint64_t handle, const std::string& text);

}  // namespace etalon::gpu
