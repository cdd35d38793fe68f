#pragma once
// Inside engine/gpu only: a Device whose work is done by OpenGL.
#include <deque>
#include <mutex>
#include <string>
#include <vector>

#include "engine/gl/context.h"
#include "engine/gpu/device.h"
#include "engine/gpu/gl_block.h"

namespace etalon::gpu {

/// The OpenGL devices of this machine as `options` judge them: each way to a context, tried.
std::vector<DeviceReport> list_gl_devices(const DeviceOptions& options);

/// An OpenGL context, current on the thread that made it: everything made on it is used there. Pictures have their
/// first row at y = 0 of window and texture coordinates, as Vulkan's, so that nothing is turned over: the lower left
/// origin of OpenGL's names is the first row here.
class GlDevice {
 public:
    /// Throws Error(machine) with every way's reason when none will do.
    explicit GlDevice(const DeviceOptions& options);
    GlDevice(const GlDevice&) = delete;
    GlDevice& operator=(const GlDevice&) = delete;
    ~GlDevice();

    /// The functions. Called by the thread that made the device.
    const gl::Functions& gl() const
    {
        assume(context_->is_current());
        return context_->functions();
    }
    const DeviceReport& report() const { return report_; }
    const std::vector<DeviceReport>& candidates() const { return candidates_; }
    const DeviceLimits& limits() const { return limits_; }

    bool supports(VkFormat format, std::uint32_t samples) const;

    /// Counts bytes against the budget. Throws Error(machine) when they are too many.
    void reserve(std::uint64_t bytes, const std::string& what);
    void release(std::uint64_t bytes) noexcept { memory_.in_use = memory_.held -= bytes; }
    const MemoryUse& memory() const { return memory_; }

    /// Follows the work given so far.
    Ticket submitted();
    void wait(Ticket ticket, std::chrono::milliseconds timeout) const;
    bool finished(Ticket ticket) const;

    bool validating() const { return validating_; }
    std::vector<std::string> messages() const;

    /// One object per layout, so that equal layouts have one address.
    const BlockLayout& intern(const BlockLayout& layout);

 private:
    void set_up();

    bool validating_;
    mutable std::mutex messages_mutex_;
    std::vector<std::string> messages_;
    std::unique_ptr<gl::Context> context_;
    std::vector<DeviceReport> candidates_;
    DeviceReport report_;
    DeviceLimits limits_;
    MemoryUse memory_;
    Ticket tickets_ = 0;
    GLsync last_ = nullptr;
    std::deque<BlockLayout> layouts_;
};

}  // namespace etalon::gpu
