#pragma once
#include <volk.h>

#include <cstddef>
#include <string>
#include <vector>

namespace etalon::test {

/// Stands between the engine and the Vulkan loader (below it the validation layers still see what is really done),
/// counts the calls that may fail, and lets one of them fail without being made. Every Device made while it lives goes
/// through it; one at a time.
class VulkanShim {
 public:
    VulkanShim();
    ~VulkanShim();
    VulkanShim(const VulkanShim&) = delete;
    VulkanShim& operator=(const VulkanShim&) = delete;

    /// Forgets what was counted; nothing fails.
    void watch();
    /// The same, and call `nth` from now, counted from 0 among those that may give `result`, gives it, `times` in all.
    /// A device once lost stays lost: what it was doing is finished, and every call that may say so says so.
    void fail(VkResult result, std::size_t nth, std::size_t times = 1);
    /// Only calls of this function are counted and fail; empty: all.
    void only(std::string function);

    /// Names of the calls that were counted, in order.
    std::vector<std::string> calls() const;
    /// Whether this thread is in a call that may fail, made through a shim.
    static bool inside();
    /// Of the call that failed first; empty when none did.
    std::string failed() const;
};

/// Whether the specification lets `function` return `result`.
bool may_return(const std::string& function, VkResult result);

}  // namespace etalon::test
