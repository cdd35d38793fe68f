#pragma once
#include <vulkan/vulkan_core.h>

#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>
#include <utility>

namespace etalon::gpu {

struct DeviceState;
class Arena;

enum class MemoryKind {
    device,    ///< where the device is fastest; mapped only where that is host memory
    upload,    ///< written by the host, read by the device
    readback,  ///< written by the device, read by the host
};

/// A piece of an arena; goes back to it when destroyed.
class Allocation {
 public:
    Allocation() = default;
    Allocation(Allocation&& other) noexcept { *this = std::move(other); }
    Allocation& operator=(Allocation&& other) noexcept
    {
        std::swap(arena_, other.arena_);
        std::swap(offset_, other.offset_);
        std::swap(size_, other.size_);
        std::swap(mapped_, other.mapped_);
        return *this;
    }
    ~Allocation();

    VkDeviceMemory memory() const;
    std::uint64_t offset() const { return offset_; }
    /// Empty when the memory is not host-visible.
    std::span<std::byte> mapped() const;

 private:
    friend class MemoryPool;
    Arena* arena_ = nullptr;
    std::uint64_t offset_ = 0;
    std::uint64_t size_ = 0;
    bool mapped_ = false;  ///< may be seen by the host
};

}  // namespace etalon::gpu
