#pragma once
#include <cstddef>
#include <cstring>
#include <span>
#include <string>
#include <type_traits>
#include <vector>

#include "engine/gpu/device.h"
#include "engine/gpu/gl_owned.h"
#include "engine/gpu/memory.h"
#include "engine/gpu/owned.h"

namespace etalon::gpu {

void destroy_buffer(const DeviceState& state, VkBuffer buffer);
void destroy_buffer_view(const DeviceState& state, VkBufferView view);

/// What offsets of views and bound ranges are multiples of, bytes: the coarsest that any device may ask for.
inline constexpr std::uint64_t kOffsetAlignment = 256;

struct BufferSpec {
    std::uint64_t size = 0;  ///< bytes; 0 makes a buffer of 16 bytes, so that an empty list can still be bound
    MemoryKind memory = MemoryKind::device;
    std::string name;  ///< for validation messages and errors
};

/// Bytes on the device. Every buffer may be used in every way: storage, uniform, texel, vertex, index, indirect,
/// copies, address. Contents are undefined until written.
class Buffer {
 public:
    Buffer() = default;
    /// Throws Error(machine) when over the memory budget or the device's limit.
    Buffer(Device& device, const BufferSpec& spec);

    VkBuffer handle() const { return buffer_.get(); }
    std::uint64_t size() const { return size_; }
    VkDeviceAddress address() const { return address_; }
    /// Its memory as the host sees it; empty unless host-visible (upload, readback, or Device::unified_memory).
    std::span<std::byte> mapped() const { return mapped_; }
    explicit operator bool() const { return buffer_ || gl_; }
    /// By OpenGL; null by Vulkan.
    GlBuffer* gl() const { return gl_.get(); }

 private:
    Allocation memory_;
    Owned<VkBuffer, destroy_buffer> buffer_;  // destroyed before its memory
    std::uint64_t size_ = 0;
    VkDeviceAddress address_ = 0;
    std::span<std::byte> mapped_;
    GlOwned<GlBuffer> gl_;
};

/// A buffer read as texels of `format`: in GLSL `imageBuffer` and `imageLoad`, or `samplerBuffer` and `texelFetch`. The
/// fast way to read on lavapipe is a storage texel buffer of VK_FORMAT_R32G32B32A32_{UINT,SFLOAT}.
class TexelView {
 public:
    TexelView() = default;
    /// Views `size` bytes from `offset`, a multiple of kOffsetAlignment (all by default). Throws Error(machine) beyond
    /// texel_buffer_elements.
    TexelView(Device& device, const Buffer& buffer, VkFormat format, std::uint64_t offset = 0,
              std::uint64_t size = VK_WHOLE_SIZE);
    VkBufferView handle() const { return view_.get(); }

 private:
    Owned<VkBufferView, destroy_buffer_view> view_;
};

/// Writes `bytes` at `offset`, through staging where the memory is not mapped; returns when written. The device must
/// not be using that range.
void upload(Device& device, const Buffer& buffer, std::span<const std::byte> bytes, std::uint64_t offset = 0);
/// Reads bytes.size() bytes from `offset`; what wrote them must have finished (Device::wait).
void download(Device& device, const Buffer& buffer, std::span<std::byte> bytes, std::uint64_t offset = 0);

template <class T>
requires std::is_trivially_copyable_v<T>
void upload(Device& device, const Buffer& buffer, std::span<const T> values, std::uint64_t offset = 0)
{
    upload(device, buffer, std::as_bytes(values), offset);
}

/// A new device buffer that holds `values`.
template <class T>
requires std::is_trivially_copyable_v<T> Buffer make_buffer(Device& device, const std::vector<T>& values,
                                                            std::string name)
{
    Buffer buffer(device, {.size = values.size() * sizeof(T), .name = std::move(name)});
    upload(device, buffer, std::as_bytes(std::span(values)));
    return buffer;
}

/// The first `count` values of the buffer.
template <class T>
requires std::is_trivially_copyable_v<T> std::vector<T> read_back(Device& device, const Buffer& buffer,
                                                                  std::size_t count, std::uint64_t offset = 0)
{
    std::vector<T> values(count);
    download(device, buffer, std::as_writable_bytes(std::span(values)), offset);
    return values;
}

}  // namespace etalon::gpu
