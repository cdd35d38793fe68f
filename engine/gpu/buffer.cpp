#include "engine/gpu/buffer.h"

#include <fmt/format.h>

#include <algorithm>

#include "engine/base/error.h"
#include "engine/gpu/commands.h"
#include "engine/gpu/device_state.h"
#include "engine/gpu/gl_resources.h"

namespace etalon::gpu {
namespace {

constexpr VkBufferUsageFlags kEveryUse =
    VK_BUFFER_USAGE_TRANSFER_SRC_BIT | VK_BUFFER_USAGE_TRANSFER_DST_BIT | VK_BUFFER_USAGE_UNIFORM_TEXEL_BUFFER_BIT |
    VK_BUFFER_USAGE_STORAGE_TEXEL_BUFFER_BIT | VK_BUFFER_USAGE_UNIFORM_BUFFER_BIT | VK_BUFFER_USAGE_STORAGE_BUFFER_BIT |
    VK_BUFFER_USAGE_INDEX_BUFFER_BIT | VK_BUFFER_USAGE_VERTEX_BUFFER_BIT | VK_BUFFER_USAGE_INDIRECT_BUFFER_BIT |
    VK_BUFFER_USAGE_SHADER_DEVICE_ADDRESS_BIT;

constexpr std::uint64_t kSmallest = 16;  // one texel of the widest format
constexpr std::uint64_t kStagingSize = std::uint64_t{16}
                                       << 20;  // bytes per staged copy: bounded, yet rarely more than one

}  // namespace

void destroy_buffer(const DeviceState& state, VkBuffer buffer)
{
    state.vk.vkDestroyBuffer(state.device, buffer, state.instance.allocator);
}

void destroy_buffer_view(const DeviceState& state, VkBufferView view)
{
    state.vk.vkDestroyBufferView(state.device, view, state.instance.allocator);
}

Buffer::Buffer(Device& device, const BufferSpec& spec) : size_(std::max(spec.size, kSmallest))
{
    if (size_ > device.limits().buffer_size)
        throw Error(Blame::machine,
                    fmt::format("buffer \"{}\" needs {} bytes; this device allows {}", spec.name, size_,
                                device.limits().buffer_size),
                    "use a smaller picture or scene");
    if (GlDevice* gl = device.gl()) {
        gl_.reset(new GlBuffer(*gl, spec, size_));
        mapped_ = gl_->host();
        return;
    }
    const DeviceState& state = device.state();
    const VkBufferCreateInfo info{.sType = VK_STRUCTURE_TYPE_BUFFER_CREATE_INFO, .size = size_, .usage = kEveryUse};
    VkBuffer buffer = VK_NULL_HANDLE;
    check(state.vk.vkCreateBuffer(state.device, &info, state.instance.allocator, &buffer), "vkCreateBuffer");
    buffer_ = {state, buffer};
    VkMemoryRequirements needs{};
    state.vk.vkGetBufferMemoryRequirements(state.device, buffer, &needs);
    memory_ = state.memory->allocate(needs, spec.memory, true, spec.name);
    check(state.vk.vkBindBufferMemory(state.device, buffer, memory_.memory(), memory_.offset()), "vkBindBufferMemory");
    const VkBufferDeviceAddressInfo address{.sType = VK_STRUCTURE_TYPE_BUFFER_DEVICE_ADDRESS_INFO, .buffer = buffer};
    address_ = state.vk.vkGetBufferDeviceAddress(state.device, &address);
    if (const auto mapped = memory_.mapped(); !mapped.empty()) mapped_ = mapped.first(size_);
    set_name(state, VK_OBJECT_TYPE_BUFFER, reinterpret_cast<std::uint64_t>(buffer), spec.name);
}

TexelView::TexelView(Device& device, const Buffer& buffer, VkFormat format, std::uint64_t offset, std::uint64_t size)
{
    if (device.gl() != nullptr)
        throw Error(Blame::machine, "texel views have no place in the OpenGL backend", "render with --backend vulkan");
    const DeviceState& state = device.state();
    assume(offset <= buffer.size() && offset % kOffsetAlignment == 0);
    const std::uint64_t texel = texel_size(format);
    const std::uint64_t bytes = (size == VK_WHOLE_SIZE ? buffer.size() - offset : size) / texel * texel;
    if (bytes / texel > state.limits.texel_buffer_elements)
        throw Error(Blame::machine,
                    fmt::format("a texel buffer of {} texels is needed; this device allows {}", bytes / texel,
                                state.limits.texel_buffer_elements),
                    "use a smaller scene");
    const VkBufferViewCreateInfo info{.sType = VK_STRUCTURE_TYPE_BUFFER_VIEW_CREATE_INFO,
                                      .buffer = buffer.handle(),
                                      .format = format,
                                      .offset = offset,
                                      .range = bytes};
    VkBufferView view = VK_NULL_HANDLE;
    check(state.vk.vkCreateBufferView(state.device, &info, state.instance.allocator, &view), "vkCreateBufferView");
    view_ = {state, view};
}

void upload(Device& device, const Buffer& buffer, std::span<const std::byte> bytes, std::uint64_t offset)
{
    assume(offset <= buffer.size() && bytes.size() <= buffer.size() - offset);
    if (bytes.empty()) return;
    if (const auto mapped = buffer.mapped(); !mapped.empty()) {
        std::memcpy(mapped.data() + offset, bytes.data(), bytes.size());
        return;
    }
    if (buffer.gl() != nullptr) return buffer.gl()->write(bytes, offset);
    const std::uint64_t step = std::min<std::uint64_t>(kStagingSize, bytes.size());
    const Buffer staging(device, {.size = step, .memory = MemoryKind::upload, .name = "staging"});
    for (std::uint64_t done = 0; done < bytes.size(); done += step) {
        const std::uint64_t now = std::min<std::uint64_t>(step, bytes.size() - done);
        std::memcpy(staging.mapped().data(), bytes.data() + done, now);
        run(device, [&](Commands& commands) { commands.copy(staging, buffer, now, 0, offset + done); });
    }
}

void download(Device& device, const Buffer& buffer, std::span<std::byte> bytes, std::uint64_t offset)
{
    assume(offset <= buffer.size() && bytes.size() <= buffer.size() - offset);
    if (bytes.empty()) return;
    if (const auto mapped = buffer.mapped(); !mapped.empty()) {
        std::memcpy(bytes.data(), mapped.data() + offset, bytes.size());
        return;
    }
    if (buffer.gl() != nullptr) return buffer.gl()->read(bytes, offset);
    const std::uint64_t step = std::min<std::uint64_t>(kStagingSize, bytes.size());
    const Buffer staging(device, {.size = step, .memory = MemoryKind::readback, .name = "staging"});
    for (std::uint64_t done = 0; done < bytes.size(); done += step) {
        const std::uint64_t now = std::min<std::uint64_t>(step, bytes.size() - done);
        run(device, [&](Commands& commands) { commands.copy(buffer, staging, now, offset + done, 0); });
        std::memcpy(bytes.data() + done, staging.mapped().data(), now);
    }
}

}  // namespace etalon::gpu
