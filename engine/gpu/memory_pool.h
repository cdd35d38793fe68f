#pragma once
// Inside engine/gpu only: arenas of device memory under one budget.
#include <memory>
#include <mutex>
#include <vector>

#include "engine/gpu/device.h"
#include "engine/gpu/memory.h"

namespace etalon::gpu {

/// One allocation of the driver's, handed out in pieces.
class Arena {
 public:
    VkDeviceMemory memory = VK_NULL_HANDLE;
    std::uint64_t size = 0;
    std::uint32_t type = 0;
    bool linear = true;  ///< buffers and optimally tiled images never share one: bufferImageGranularity
    std::byte* mapped = nullptr;
    struct Gap {
        std::uint64_t offset = 0;
        std::uint64_t size = 0;
    };
    std::vector<Gap> free;   ///< by offset, never two adjacent
    std::size_t pieces = 0;  ///< handed out
    class MemoryPool* pool = nullptr;

    /// First fit. False when there is no room.
    bool take(std::uint64_t bytes, std::uint64_t alignment, std::uint64_t& offset);
    /// Needs no memory: destructors do this.
    void give_back(std::uint64_t offset, std::uint64_t bytes) noexcept;
    bool empty() const { return pieces == 0; }
};

class MemoryPool {
 public:
    /// `staged`: see DeviceOptions.
    MemoryPool(const DeviceState& state, std::uint64_t budget, bool staged);
    ~MemoryPool();
    MemoryPool(const MemoryPool&) = delete;
    MemoryPool& operator=(const MemoryPool&) = delete;

    /// `linear`: for a buffer. `what` names the resource in the Error.
    Allocation allocate(const VkMemoryRequirements& needs, MemoryKind kind, bool linear, std::string_view what);
    void release(Arena& arena, std::uint64_t offset, std::uint64_t size);
    MemoryUse use() const;
    /// True where MemoryKind::device is mapped.
    bool unified() const { return unified_; }

 private:
    std::uint32_t pick_type(std::uint32_t allowed, MemoryKind kind) const;
    Arena& add_arena(std::uint64_t size, std::uint32_t type, bool linear, std::string_view what);

    const DeviceState& state_;
    VkPhysicalDeviceMemoryProperties properties_{};
    bool unified_ = false;
    mutable std::mutex mutex_;
    std::vector<std::unique_ptr<Arena>> arenas_;
    MemoryUse use_;
};

}  // namespace etalon::gpu
