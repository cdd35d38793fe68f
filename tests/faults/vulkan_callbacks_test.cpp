// Every allocation that a driver makes on the host through VkAllocationCallbacks, failed: an Error of the machine, all
// memory given back. Not those of vkCmd functions, which cannot fail: lavapipe 22.3.6 uses what it did not get (a null
// pointer, in vkCmdCopyBufferToImage for one).
#include <algorithm>
#include <atomic>
#include <cstdlib>
#include <cstring>
#include <map>
#include <mutex>

#include "tests/faults/picture.h"
#include "tests/faults/vulkan_shim.h"

namespace etalon::test {
namespace {

/// Host memory for a driver, which ends with the `nth` request.
class HostMemory {
 public:
    HostMemory()
        : callbacks_{.pUserData = this, .pfnAllocation = allocate, .pfnReallocation = reallocate, .pfnFree = free}
    {}
    const VkAllocationCallbacks* callbacks() const { return &callbacks_; }
    void fail(std::size_t nth, std::size_t times)
    {
        counted_ = 0;
        first_ = nth;
        end_ = times > ~nth ? ~std::size_t{0} : nth + times;
    }
    std::size_t counted() const { return counted_; }
    std::size_t held() const
    {
        const std::lock_guard lock(mutex_);
        return sizes_.size();
    }

 private:
    static void* VKAPI_PTR allocate(void* self, std::size_t size, std::size_t alignment, VkSystemAllocationScope)
    {
        return static_cast<HostMemory*>(self)->take(size, alignment);
    }
    static void* VKAPI_PTR reallocate(void* self, void* old, std::size_t size, std::size_t alignment,
                                      VkSystemAllocationScope)
    {
        auto& host = *static_cast<HostMemory*>(self);
        if (size == 0) return host.give_back(old), nullptr;
        void* const memory = host.take(size, alignment);
        if (memory == nullptr || old == nullptr) return memory;
        std::memcpy(memory, old, std::min(size, host.size_of(old)));
        host.give_back(old);
        return memory;
    }
    static void VKAPI_PTR free(void* self, void* memory) { static_cast<HostMemory*>(self)->give_back(memory); }

    void* take(std::size_t size, std::size_t alignment)
    {
        if (!VulkanShim::inside()) return obtain(size, alignment);
        const std::size_t index = counted_++;
        if (index >= first_ && index < end_) return nullptr;
        return obtain(size, alignment);
    }
    void* obtain(std::size_t size, std::size_t alignment)
    {
        if (size == 0) return nullptr;
        alignment = std::max(alignment, sizeof(void*));
        void* const memory = std::aligned_alloc(alignment, (size + alignment - 1) / alignment * alignment);
        const std::lock_guard lock(mutex_);
        sizes_[memory] = size;
        return memory;
    }
    std::size_t size_of(void* memory) const
    {
        const std::lock_guard lock(mutex_);
        return sizes_.at(memory);
    }
    void give_back(void* memory)
    {
        if (memory == nullptr) return;
        {
            const std::lock_guard lock(mutex_);
            sizes_.erase(memory);
        }
        std::free(memory);
    }

    VkAllocationCallbacks callbacks_;
    std::atomic<std::size_t> counted_{0};
    std::atomic<std::size_t> first_{~std::size_t{0}};
    std::atomic<std::size_t> end_{~std::size_t{0}};
    mutable std::mutex mutex_;
    std::map<void*, std::size_t> sizes_;
};

class HostAllocations : public testing::TestWithParam<Renderer> {};
INSTANTIATE_TEST_SUITE_P(Of, HostAllocations, testing::Values(Renderer::raster, Renderer::path), [](const auto& which) {
    return std::string(which.param == Renderer::raster ? "raster" : "path");
});

TEST_P(HostAllocations, a_picture_survives_each_that_fails)
{
    const VulkanShim shim;
    const Picture picture("maps", GetParam());
    HostMemory host;
    std::vector<std::string> messages;
    {
        gpu::Device device({.validate = true,
                            .on_message = [&](const std::string& text) { messages.push_back(text); },
                            .allocator = host.callbacks()});
        const Film expected = picture.render(&device);
        host.fail(0, 0);
        static_cast<void>(picture.render(&device));
        const std::size_t count = host.counted();
        std::printf("%zu allocations\n", count);
        ASSERT_GT(count, 100u);  // the driver does use the callbacks
        for (const std::size_t times : {std::size_t{1}, ~std::size_t{0}})
            for (const std::size_t n : faults_to_try(count, 12)) {
                host.fail(n, times);
                Film film;
                const Outcome outcome = attempt([&] { film = picture.render(&device); });
                host.fail(~std::size_t{0}, 0);
                if (outcome.blame) {
                    EXPECT_EQ(*outcome.blame, Blame::machine) << n << ": " << outcome.message;
                    EXPECT_THAT(outcome.message, testing::HasSubstr("VK_ERROR_OUT_OF_")) << n;
                } else {
                    EXPECT_TRUE(same_bits(film, expected)) << n;
                }
                EXPECT_EQ(device.memory().in_use, 0u);
            }
        EXPECT_TRUE(same_bits(picture.render(&device), expected));
    }
    // Validation would name an object of ours that was left. Of its own, lavapipe 22.3.6 loses a little when a command
    // buffer or the end of a submission fails.
    EXPECT_THAT(messages, testing::IsEmpty());
    EXPECT_LE(host.held(), every_fault() ? 100u : 10u);
}

}  // namespace
}  // namespace etalon::test
