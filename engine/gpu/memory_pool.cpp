#include "engine/gpu/memory_pool.h"

#include <fmt/format.h>

#include <algorithm>

#include "engine/base/error.h"
#include "engine/gpu/device_state.h"

namespace etalon::gpu {
namespace {

constexpr std::uint64_t kArenaSize = std::uint64_t{64} << 20;  // few enough for drivers that allow 4096 allocations

constexpr VkMemoryPropertyFlags kMapped = VK_MEMORY_PROPERTY_HOST_VISIBLE_BIT | VK_MEMORY_PROPERTY_HOST_COHERENT_BIT;

std::string in_mib(std::uint64_t bytes)
{
    return fmt::format("{:.1f} MiB", double(bytes) / (1 << 20));
}

std::uint64_t align_up(std::uint64_t value, std::uint64_t alignment)
{
    return (value + alignment - 1) / alignment * alignment;
}

}  // namespace

bool Arena::take(std::uint64_t bytes, std::uint64_t alignment, std::uint64_t& offset)
{
    free.reserve(pieces + 2);  // between and around the pieces then handed out
    for (auto it = free.begin(); it != free.end(); ++it) {
        const auto [start, length] = *it;
        const std::uint64_t end = start + length;
        const std::uint64_t aligned = align_up(start, alignment);
        if (aligned + bytes > end) continue;
        it = free.erase(it);
        if (aligned + bytes < end) it = free.insert(it, {aligned + bytes, end - aligned - bytes});
        if (aligned > start) free.insert(it, {start, aligned - start});
        offset = aligned;
        ++pieces;
        return true;
    }
    return false;
}

void Arena::give_back(std::uint64_t offset, std::uint64_t bytes) noexcept
{
    const auto next = std::lower_bound(free.begin(), free.end(), offset,
                                       [](const Gap& gap, std::uint64_t at) { return gap.offset < at; });
    assume(pieces-- > 0 && (next == free.end() || offset + bytes <= next->offset));
    const bool meets_next = next != free.end() && offset + bytes == next->offset;
    const bool meets_previous = next != free.begin() && std::prev(next)->offset + std::prev(next)->size == offset;
    if (meets_previous) {
        std::prev(next)->size += bytes + (meets_next ? next->size : 0);
        if (meets_next) free.erase(next);
    } else if (meets_next) {
        *next = {offset, bytes + next->size};
    } else {
        free.insert(next, {offset, bytes});  // within what take() reserved
    }
}

Allocation::~Allocation()
{
    if (arena_ != nullptr) arena_->pool->release(*arena_, offset_, size_);
}

VkDeviceMemory Allocation::memory() const
{
    return arena_ == nullptr ? VK_NULL_HANDLE : arena_->memory;
}

std::span<std::byte> Allocation::mapped() const
{
    if (!mapped_ || arena_->mapped == nullptr) return {};
    return {arena_->mapped + offset_, size_};
}

MemoryPool::MemoryPool(const DeviceState& state, std::uint64_t budget, bool staged) : state_(state)
{
    state.instance.vk.vkGetPhysicalDeviceMemoryProperties(state.physical, &properties_);
    use_.budget = budget;
    // A discrete GPU may show host-visible device memory too, but there writing through it is not free.
    if (!staged && (state.report.type == "cpu" || state.report.type == "integrated"))
        for (std::uint32_t i = 0; i < properties_.memoryTypeCount; ++i) {
            const VkMemoryPropertyFlags all = kMapped | VK_MEMORY_PROPERTY_DEVICE_LOCAL_BIT;
            if ((properties_.memoryTypes[i].propertyFlags & all) == all) unified_ = true;
        }
}

MemoryPool::~MemoryPool()
{
    for (const auto& arena : arenas_) state_.vk.vkFreeMemory(state_.device, arena->memory, state_.instance.allocator);
}

MemoryUse MemoryPool::use() const
{
    const std::lock_guard lock(mutex_);
    return use_;
}

std::uint32_t MemoryPool::pick_type(std::uint32_t allowed, MemoryKind kind) const
{
    // In order of preference; the specification promises that the last of each always exists.
    std::vector<VkMemoryPropertyFlags> wanted;
    switch (kind) {
        case MemoryKind::device:
            if (unified_) wanted.push_back(kMapped | VK_MEMORY_PROPERTY_DEVICE_LOCAL_BIT);
            wanted.push_back(VK_MEMORY_PROPERTY_DEVICE_LOCAL_BIT);
            wanted.push_back(0);
            break;
        case MemoryKind::readback:
            wanted.push_back(kMapped | VK_MEMORY_PROPERTY_HOST_CACHED_BIT);
            [[fallthrough]];
        case MemoryKind::upload:
            wanted.push_back(kMapped);
            break;
    }
    for (const VkMemoryPropertyFlags flags : wanted)
        for (std::uint32_t i = 0; i < properties_.memoryTypeCount; ++i)
            if ((allowed >> i & 1u) != 0 && (properties_.memoryTypes[i].propertyFlags & flags) == flags) return i;
    throw Error(Blame::machine, "the device has no memory of the kind that is needed");
}

Arena& MemoryPool::add_arena(std::uint64_t size, std::uint32_t type, bool linear, std::string_view what)
{
    auto arena = std::make_unique<Arena>();
    arenas_.reserve(arenas_.size() + 1);  // once there is memory of the driver's, nothing may fail but the driver
    arena->free.reserve(2);
    const VkMemoryAllocateFlagsInfo flags{.sType = VK_STRUCTURE_TYPE_MEMORY_ALLOCATE_FLAGS_INFO,
                                          .flags = VK_MEMORY_ALLOCATE_DEVICE_ADDRESS_BIT};
    const VkMemoryAllocateInfo info{.sType = VK_STRUCTURE_TYPE_MEMORY_ALLOCATE_INFO,
                                    .pNext = linear ? &flags : nullptr,
                                    .allocationSize = size,
                                    .memoryTypeIndex = type};
    const VkResult result = state_.vk.vkAllocateMemory(state_.device, &info, state_.instance.allocator, &arena->memory);
    if (result != VK_SUCCESS)
        throw Error(Blame::machine,
                    fmt::format("the device refuses {} of memory for \"{}\" ({}); {} of a budget of {} are held",
                                in_mib(size), what, name(result), in_mib(use_.held), in_mib(use_.budget)),
                    "render a smaller picture or scene, or choose a device with more memory");
    arena->size = size;
    arena->type = type;
    arena->linear = linear;
    arena->free.push_back({0, size});
    arena->pool = this;
    if ((properties_.memoryTypes[type].propertyFlags & kMapped) == kMapped) {
        void* mapped = nullptr;
        const VkResult map = state_.vk.vkMapMemory(state_.device, arena->memory, 0, VK_WHOLE_SIZE, 0, &mapped);
        if (map != VK_SUCCESS) state_.vk.vkFreeMemory(state_.device, arena->memory, state_.instance.allocator);
        check(map, "vkMapMemory");
        arena->mapped = static_cast<std::byte*>(mapped);
    }
    use_.held += size;
    arenas_.push_back(std::move(arena));
    return *arenas_.back();
}

Allocation MemoryPool::allocate(const VkMemoryRequirements& needs, MemoryKind kind, bool linear, std::string_view what)
{
    const std::lock_guard lock(mutex_);
    const std::uint32_t type = pick_type(needs.memoryTypeBits, kind);
    Allocation piece;
    piece.size_ = needs.size;
    piece.mapped_ = kind != MemoryKind::device || unified_;
    for (const auto& arena : arenas_)
        if (arena->type == type && arena->linear == linear && arena->take(needs.size, needs.alignment, piece.offset_)) {
            piece.arena_ = arena.get();
            break;
        }
    if (piece.arena_ == nullptr) {
        if (needs.size > state_.limits.allocation)
            throw Error(Blame::machine,
                        fmt::format("\"{}\" needs {} in one piece; this device allows {}", what, in_mib(needs.size),
                                    in_mib(state_.limits.allocation)),
                        "render a smaller picture or scene, or choose another device");
        const std::uint64_t room = use_.budget - std::min(use_.budget, use_.held);
        if (needs.size > room)
            throw Error(Blame::machine,
                        fmt::format("\"{}\" needs {} of device memory, but {} of a budget of {} are left", what,
                                    in_mib(needs.size), in_mib(room), in_mib(use_.budget)),
                        "render a smaller picture or scene, or choose a device with more memory");
        Arena& arena = add_arena(std::max(needs.size, std::min(kArenaSize, room)), type, linear, what);
        assume(arena.take(needs.size, needs.alignment, piece.offset_));
        piece.arena_ = &arena;
    }
    use_.in_use += needs.size;
    return piece;
}

void MemoryPool::release(Arena& arena, std::uint64_t offset, std::uint64_t size)
{
    const std::lock_guard lock(mutex_);
    arena.give_back(offset, size);
    use_.in_use -= size;
    if (!arena.empty()) return;
    use_.held -= arena.size;
    state_.vk.vkFreeMemory(state_.device, arena.memory, state_.instance.allocator);
    std::erase_if(arenas_, [&](const auto& other) { return other.get() == &arena; });
}

}  // namespace etalon::gpu
