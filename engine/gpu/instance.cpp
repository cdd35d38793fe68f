#include <fmt/format.h>

#include <algorithm>
#include <cstring>
#include <new>

#include "engine/base/error.h"
#include "engine/gpu/device_state.h"

namespace etalon::gpu {
namespace {

constexpr const char* kValidationLayer = "VK_LAYER_KHRONOS_validation";

bool has_loader()
{
    // volk keeps the loader's functions in globals: filled once, only read after.
    static const VkResult loaded = volkInitialize();
    return loaded == VK_SUCCESS;
}

void load_loader()
{
    if (!has_loader())
        throw Error(Blame::machine, "this machine has no Vulkan loader (libvulkan.so.1)",
                    "install a Vulkan loader and driver; on Debian: apt install libvulkan1 mesa-vulkan-drivers");
}

std::vector<VkLayerProperties> layers()
{
    std::uint32_t count = 0;
    check(vkEnumerateInstanceLayerProperties(&count, nullptr), "vkEnumerateInstanceLayerProperties");
    std::vector<VkLayerProperties> all(count);
    check(vkEnumerateInstanceLayerProperties(&count, all.data()), "vkEnumerateInstanceLayerProperties");
    all.resize(count);
    return all;
}

VkBool32 VKAPI_PTR keep_message(VkDebugUtilsMessageSeverityFlagBitsEXT, VkDebugUtilsMessageTypeFlagsEXT,
                                const VkDebugUtilsMessengerCallbackDataEXT* data, void* log)
{
    auto& kept = *static_cast<MessageLog*>(log);
    try {
        const std::lock_guard lock(kept.mutex);
        kept.messages.emplace_back(data->pMessage);
        if (kept.heard) kept.heard(kept.messages.back());
    } catch (const std::bad_alloc&) {
        // The caller is C and cannot be thrown through; the layer writes to standard output too when it is told to.
    }
    return VK_FALSE;
}

VkDebugUtilsMessengerCreateInfoEXT messenger_info(MessageLog& log)
{
    return {
        .sType = VK_STRUCTURE_TYPE_DEBUG_UTILS_MESSENGER_CREATE_INFO_EXT,
        .messageSeverity =
            VK_DEBUG_UTILS_MESSAGE_SEVERITY_WARNING_BIT_EXT | VK_DEBUG_UTILS_MESSAGE_SEVERITY_ERROR_BIT_EXT,
        // Not GENERAL: there the loader speaks of drivers that it could not open, which is no fault of ours.
        .messageType = VK_DEBUG_UTILS_MESSAGE_TYPE_VALIDATION_BIT_EXT | VK_DEBUG_UTILS_MESSAGE_TYPE_PERFORMANCE_BIT_EXT,
        .pfnUserCallback = keep_message,
        .pUserData = &log};
}

void load(InstanceTable& vk, VkInstance instance)
{
    const auto get = [&]<class F>(F& function, const char* symbol) {
        function = reinterpret_cast<F>(vkGetInstanceProcAddr(instance, symbol));
    };
#define ETALON_LOAD(function) get(vk.function, #function)
    ETALON_LOAD(vkDestroyInstance);
    ETALON_LOAD(vkEnumeratePhysicalDevices);
    ETALON_LOAD(vkGetPhysicalDeviceProperties2);
    ETALON_LOAD(vkGetPhysicalDeviceFeatures2);
    ETALON_LOAD(vkGetPhysicalDeviceMemoryProperties);
    ETALON_LOAD(vkGetPhysicalDeviceQueueFamilyProperties);
    ETALON_LOAD(vkGetPhysicalDeviceFormatProperties);
    ETALON_LOAD(vkGetPhysicalDeviceImageFormatProperties);
    ETALON_LOAD(vkEnumerateDeviceExtensionProperties);
    ETALON_LOAD(vkCreateDevice);
    ETALON_LOAD(vkCreateDebugUtilsMessengerEXT);
    ETALON_LOAD(vkDestroyDebugUtilsMessengerEXT);
    ETALON_LOAD(vkSetDebugUtilsObjectNameEXT);
    ETALON_LOAD(vkDestroySurfaceKHR);
    ETALON_LOAD(vkGetPhysicalDeviceSurfaceSupportKHR);
    ETALON_LOAD(vkGetPhysicalDeviceSurfaceCapabilitiesKHR);
    ETALON_LOAD(vkGetPhysicalDeviceSurfaceFormatsKHR);
#undef ETALON_LOAD
}

std::string version_text(std::uint32_t version)
{
    return fmt::format("{}.{}.{}", VK_API_VERSION_MAJOR(version), VK_API_VERSION_MINOR(version),
                       VK_API_VERSION_PATCH(version));
}

}  // namespace

std::string name(VkResult result)
{
    switch (result) {
#define ETALON_NAME(value) \
    case value:            \
        return #value
        ETALON_NAME(VK_NOT_READY);
        ETALON_NAME(VK_TIMEOUT);
        ETALON_NAME(VK_INCOMPLETE);
        ETALON_NAME(VK_SUBOPTIMAL_KHR);
        ETALON_NAME(VK_ERROR_OUT_OF_HOST_MEMORY);
        ETALON_NAME(VK_ERROR_OUT_OF_DEVICE_MEMORY);
        ETALON_NAME(VK_ERROR_INITIALIZATION_FAILED);
        ETALON_NAME(VK_ERROR_DEVICE_LOST);
        ETALON_NAME(VK_ERROR_MEMORY_MAP_FAILED);
        ETALON_NAME(VK_ERROR_LAYER_NOT_PRESENT);
        ETALON_NAME(VK_ERROR_EXTENSION_NOT_PRESENT);
        ETALON_NAME(VK_ERROR_FEATURE_NOT_PRESENT);
        ETALON_NAME(VK_ERROR_INCOMPATIBLE_DRIVER);
        ETALON_NAME(VK_ERROR_TOO_MANY_OBJECTS);
        ETALON_NAME(VK_ERROR_FORMAT_NOT_SUPPORTED);
        ETALON_NAME(VK_ERROR_FRAGMENTED_POOL);
        ETALON_NAME(VK_ERROR_OUT_OF_POOL_MEMORY);
        ETALON_NAME(VK_ERROR_SURFACE_LOST_KHR);
        ETALON_NAME(VK_ERROR_NATIVE_WINDOW_IN_USE_KHR);
        ETALON_NAME(VK_ERROR_OUT_OF_DATE_KHR);
#undef ETALON_NAME
        default:
            return fmt::format("VkResult {}", static_cast<int>(result));
    }
}

void check(VkResult result, std::string_view call)
{
    if (result >= VK_SUCCESS) return;
    const bool memory = result == VK_ERROR_OUT_OF_HOST_MEMORY || result == VK_ERROR_OUT_OF_DEVICE_MEMORY;
    std::string what = fmt::format("{} failed: {}", call, name(result));
    if (result == VK_ERROR_DEVICE_LOST)
        throw DeviceLost(Blame::machine, std::move(what),
                         "the driver gave up; try again, or another device (see etalon info)");
    throw Error(Blame::machine, std::move(what),
                memory ? "render a smaller picture or scene, or choose another device" : "");
}

Instance::Instance(const DeviceOptions& options) : allocator(options.allocator), validating(options.validate)
{
    load_loader();
    log.heard = options.on_message;
    try {
        create(options);
    } catch (...) {
        release();
        throw;
    }
}

void Instance::create(const DeviceOptions& options)
{
    std::vector<const char*> enabled_layers;
    std::vector<const char*> extensions;
    for (const std::string& extension : options.instance_extensions) extensions.push_back(extension.c_str());
    if (validating) {
        const auto all = layers();
        if (std::none_of(all.begin(), all.end(),
                         [](const auto& layer) { return std::strcmp(layer.layerName, kValidationLayer) == 0; }))
            throw Error(Blame::machine,
                        fmt::format("validation was asked for, but {} is not installed", kValidationLayer),
                        "on Debian: apt install vulkan-validationlayers");
        enabled_layers.push_back(kValidationLayer);
        extensions.push_back(VK_EXT_DEBUG_UTILS_EXTENSION_NAME);
    }
    const VkValidationFeatureEnableEXT synchronization = VK_VALIDATION_FEATURE_ENABLE_SYNCHRONIZATION_VALIDATION_EXT;
    VkDebugUtilsMessengerCreateInfoEXT messages = messenger_info(log);
    const VkValidationFeaturesEXT validation{.sType = VK_STRUCTURE_TYPE_VALIDATION_FEATURES_EXT,
                                             .pNext = &messages,
                                             .enabledValidationFeatureCount = 1,
                                             .pEnabledValidationFeatures = &synchronization};
    const VkApplicationInfo application{.sType = VK_STRUCTURE_TYPE_APPLICATION_INFO,
                                        .pApplicationName = "etalon",
                                        .pEngineName = "etalon",
                                        .apiVersion = VK_API_VERSION_1_3};
    const VkInstanceCreateInfo info{.sType = VK_STRUCTURE_TYPE_INSTANCE_CREATE_INFO,
                                    .pNext = validating ? &validation : nullptr,
                                    .pApplicationInfo = &application,
                                    .enabledLayerCount = static_cast<std::uint32_t>(enabled_layers.size()),
                                    .ppEnabledLayerNames = enabled_layers.data(),
                                    .enabledExtensionCount = static_cast<std::uint32_t>(extensions.size()),
                                    .ppEnabledExtensionNames = extensions.data()};
    const VkResult result = vkCreateInstance(&info, allocator, &handle);
    if (result == VK_ERROR_INCOMPATIBLE_DRIVER) return;  // no driver at all: an instance without devices
    check(result, "vkCreateInstance");
    load(vk, handle);
    if (validating)
        check(vk.vkCreateDebugUtilsMessengerEXT(handle, &messages, allocator, &messenger),
              "vkCreateDebugUtilsMessengerEXT");
    if (options.make_surface) surface = options.make_surface(handle);
}

Instance::~Instance()
{
    release();
}

void Instance::release()
{
    if (handle == VK_NULL_HANDLE) return;
    if (surface != VK_NULL_HANDLE) vk.vkDestroySurfaceKHR(handle, surface, nullptr);
    if (messenger != VK_NULL_HANDLE) vk.vkDestroyDebugUtilsMessengerEXT(handle, messenger, allocator);
    vk.vkDestroyInstance(handle, allocator);
}

std::vector<VkPhysicalDevice> Instance::physical_devices() const
{
    if (handle == VK_NULL_HANDLE) return {};
    std::uint32_t count = 0;
    check(vk.vkEnumeratePhysicalDevices(handle, &count, nullptr), "vkEnumeratePhysicalDevices");
    std::vector<VkPhysicalDevice> all(count);
    check(vk.vkEnumeratePhysicalDevices(handle, &count, all.data()), "vkEnumeratePhysicalDevices");
    all.resize(count);
    return all;
}

std::vector<std::string> vulkan_versions()
{
    std::vector<std::string> versions;
    if (!has_loader()) return versions;
    std::uint32_t loader = VK_API_VERSION_1_0;
    if (vkEnumerateInstanceVersion != nullptr) check(vkEnumerateInstanceVersion(&loader), "vkEnumerateInstanceVersion");
    versions.push_back("Vulkan loader " + version_text(loader));
    for (const VkLayerProperties& layer : layers())
        versions.push_back(fmt::format("layer {} {}", layer.layerName, version_text(layer.specVersion)));
    return versions;
}

}  // namespace etalon::gpu
