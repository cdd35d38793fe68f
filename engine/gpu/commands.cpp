#include "engine/gpu/commands.h"

#include <fmt/format.h>

#include <algorithm>

#include "engine/base/error.h"
#include "engine/gpu/device_state.h"
#include "engine/gpu/gl_commands.h"

namespace etalon::gpu {
namespace {

/// Where in the pipeline a kind of work happens, and how it touches memory.
struct Scope {
    VkPipelineStageFlags2 stages;
    VkAccessFlags2 access;
};

constexpr VkAccessFlags2 kShaderAccess = VK_ACCESS_2_SHADER_READ_BIT | VK_ACCESS_2_SHADER_WRITE_BIT;
constexpr VkAccessFlags2 kMemoryAccess = VK_ACCESS_2_MEMORY_READ_BIT | VK_ACCESS_2_MEMORY_WRITE_BIT;

Scope scope(Work work)
{
    switch (work) {
        case Work::compute:
            return {VK_PIPELINE_STAGE_2_COMPUTE_SHADER_BIT, kShaderAccess};
        case Work::copy:
            return {VK_PIPELINE_STAGE_2_ALL_TRANSFER_BIT,
                    VK_ACCESS_2_TRANSFER_READ_BIT | VK_ACCESS_2_TRANSFER_WRITE_BIT};
        case Work::draw:
            return {VK_PIPELINE_STAGE_2_ALL_GRAPHICS_BIT, kMemoryAccess};
        case Work::indirect:
            return {VK_PIPELINE_STAGE_2_DRAW_INDIRECT_BIT, VK_ACCESS_2_INDIRECT_COMMAND_READ_BIT};
        case Work::host:
            return {VK_PIPELINE_STAGE_2_HOST_BIT, VK_ACCESS_2_HOST_READ_BIT | VK_ACCESS_2_HOST_WRITE_BIT};
        case Work::all:
            break;
    }
    return {VK_PIPELINE_STAGE_2_ALL_COMMANDS_BIT, kMemoryAccess};
}

struct ImageScope {
    VkImageLayout layout;
    Scope scope;
    bool writes;
};

ImageScope scope(ImageUse use)
{
    constexpr VkPipelineStageFlags2 kShaders = VK_PIPELINE_STAGE_2_VERTEX_SHADER_BIT |
                                               VK_PIPELINE_STAGE_2_FRAGMENT_SHADER_BIT |
                                               VK_PIPELINE_STAGE_2_COMPUTE_SHADER_BIT;
    switch (use) {
        case ImageUse::undefined:
            break;
        case ImageUse::copy_source:
            return {VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL,
                    {VK_PIPELINE_STAGE_2_ALL_TRANSFER_BIT, VK_ACCESS_2_TRANSFER_READ_BIT},
                    false};
        case ImageUse::copy_target:
            return {VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL,
                    {VK_PIPELINE_STAGE_2_ALL_TRANSFER_BIT, VK_ACCESS_2_TRANSFER_WRITE_BIT},
                    true};
        case ImageUse::sampled:
            return {VK_IMAGE_LAYOUT_SHADER_READ_ONLY_OPTIMAL, {kShaders, VK_ACCESS_2_SHADER_READ_BIT}, false};
        case ImageUse::storage:
            return {VK_IMAGE_LAYOUT_GENERAL, {kShaders, kShaderAccess}, true};
        case ImageUse::color_target:
            return {VK_IMAGE_LAYOUT_COLOR_ATTACHMENT_OPTIMAL,
                    {VK_PIPELINE_STAGE_2_COLOR_ATTACHMENT_OUTPUT_BIT,
                     VK_ACCESS_2_COLOR_ATTACHMENT_READ_BIT | VK_ACCESS_2_COLOR_ATTACHMENT_WRITE_BIT},
                    true};
        case ImageUse::depth_target:
            // A resolve of depth happens in the colour output stage.
            return {VK_IMAGE_LAYOUT_DEPTH_ATTACHMENT_OPTIMAL,
                    {VK_PIPELINE_STAGE_2_EARLY_FRAGMENT_TESTS_BIT | VK_PIPELINE_STAGE_2_LATE_FRAGMENT_TESTS_BIT |
                         VK_PIPELINE_STAGE_2_COLOR_ATTACHMENT_OUTPUT_BIT,
                     VK_ACCESS_2_DEPTH_STENCIL_ATTACHMENT_READ_BIT | VK_ACCESS_2_DEPTH_STENCIL_ATTACHMENT_WRITE_BIT |
                         VK_ACCESS_2_COLOR_ATTACHMENT_WRITE_BIT},
                    true};
        case ImageUse::present:
            // The semaphore that presentation waits for makes memory visible.
            return {VK_IMAGE_LAYOUT_PRESENT_SRC_KHR, {VK_PIPELINE_STAGE_2_ALL_COMMANDS_BIT, 0}, false};
    }
    // All commands, so that it also follows the semaphore by which a swapchain hands out an image.
    return {VK_IMAGE_LAYOUT_UNDEFINED, {VK_PIPELINE_STAGE_2_ALL_COMMANDS_BIT, 0}, true};
}

void memory_barrier(const DeviceState& state, VkCommandBuffer buffer, Scope before, Scope after)
{
    const VkMemoryBarrier2 barrier{.sType = VK_STRUCTURE_TYPE_MEMORY_BARRIER_2,
                                   .srcStageMask = before.stages,
                                   .srcAccessMask = before.access,
                                   .dstStageMask = after.stages,
                                   .dstAccessMask = after.access};
    const VkDependencyInfo info{
        .sType = VK_STRUCTURE_TYPE_DEPENDENCY_INFO, .memoryBarrierCount = 1, .pMemoryBarriers = &barrier};
    state.vk.vkCmdPipelineBarrier2(buffer, &info);
}

}  // namespace

void destroy_command_pool(const DeviceState& state, VkCommandPool pool)
{
    state.vk.vkDestroyCommandPool(state.device, pool, state.instance.allocator);
}

void destroy_query_pool(const DeviceState& state, VkQueryPool pool)
{
    state.vk.vkDestroyQueryPool(state.device, pool, state.instance.allocator);
}

Commands::Commands(Device& device, std::string name) : name_(std::move(name))
{
    if (GlDevice* gl = device.gl()) {
        gl_.reset(new GlCommands(*gl));
        return;
    }
    state_ = &device.state();
    const VkCommandPoolCreateInfo pool_info{.sType = VK_STRUCTURE_TYPE_COMMAND_POOL_CREATE_INFO,
                                            .queueFamilyIndex = state_->queue_family};
    VkCommandPool pool = VK_NULL_HANDLE;
    check(state_->vk.vkCreateCommandPool(state_->device, &pool_info, state_->instance.allocator, &pool),
          "vkCreateCommandPool");
    pool_ = {*state_, pool};
    const VkCommandBufferAllocateInfo allocation{.sType = VK_STRUCTURE_TYPE_COMMAND_BUFFER_ALLOCATE_INFO,
                                                 .commandPool = pool,
                                                 .level = VK_COMMAND_BUFFER_LEVEL_PRIMARY,
                                                 .commandBufferCount = 1};
    check(state_->vk.vkAllocateCommandBuffers(state_->device, &allocation, &buffer_), "vkAllocateCommandBuffers");
    set_name(*state_, VK_OBJECT_TYPE_COMMAND_BUFFER, reinterpret_cast<std::uint64_t>(buffer_), name_);
    const VkCommandBufferBeginInfo begin{.sType = VK_STRUCTURE_TYPE_COMMAND_BUFFER_BEGIN_INFO,
                                         .flags = VK_COMMAND_BUFFER_USAGE_SIMULTANEOUS_USE_BIT};
    check(state_->vk.vkBeginCommandBuffer(buffer_, &begin), "vkBeginCommandBuffer");
    barrier(Work::all, Work::all);
}

Commands::Commands(Commands&& other) noexcept
    : state_(std::exchange(other.state_, nullptr)),
      gl_(std::move(other.gl_)),
      pool_(std::move(other.pool_)),
      queries_(std::move(other.queries_)),
      buffer_(other.buffer_),
      name_(std::move(other.name_)),
      recording_(other.recording_),
      point_(other.point_),
      layout_(other.layout_),
      workgroup_x_(other.workgroup_x_),
      regions_(std::move(other.regions_)),
      open_regions_(std::move(other.open_regions_)),
      last_(other.last_)
{}

Commands::~Commands()
{
    if (state_ == nullptr || last_ == 0) return;
    const VkSemaphoreWaitInfo info{.sType = VK_STRUCTURE_TYPE_SEMAPHORE_WAIT_INFO,
                                   .semaphoreCount = 1,
                                   .pSemaphores = &state_->timeline,
                                   .pValues = &last_};
    // A destructor cannot report; a device that is lost or stuck is met by the next call that waits.
    constexpr std::uint64_t kTwoMinutes = 120'000'000'000;
    static_cast<void>(state_->vk.vkWaitSemaphores(state_->device, &info, kTwoMinutes));
}

void Commands::bind(VkPipelineBindPoint point, VkPipeline pipeline, const Layout& layout)
{
    assume(recording_);
    point_ = point;
    layout_ = &layout;
    state_->vk.vkCmdBindPipeline(buffer_, point, pipeline);
}

void Commands::bind(const ComputePipeline& pipeline)
{
    workgroup_x_ = pipeline.workgroup(0);
    if (gl_) return gl_->bind(*pipeline.gl());
    bind(VK_PIPELINE_BIND_POINT_COMPUTE, pipeline.handle(), pipeline.layout());
}

void Commands::bind(const ComputePipeline& pipeline, const Bindings& bindings)
{
    bind(pipeline);
    bind(bindings);
}

void Commands::bind(const GraphicsPipeline& pipeline)
{
    if (gl_)
        gl_->bind(*pipeline.gl());
    else
        bind(VK_PIPELINE_BIND_POINT_GRAPHICS, pipeline.handle(), pipeline.layout());
    set_cull(pipeline.cull(), pipeline.front());
}

void Commands::bind(const Bindings& bindings)
{
    if (gl_) return gl_->bind(*bindings.gl(), bindings.index());
    assume(layout_ != nullptr && bindings.handle() != VK_NULL_HANDLE);
    const VkDescriptorSet set = bindings.handle();
    state_->vk.vkCmdBindDescriptorSets(buffer_, point_, layout_->handle(), bindings.index(), 1, &set, 0, nullptr);
}

void Commands::push_bytes(std::span<const std::byte> bytes)
{
    if (gl_) return gl_->push(bytes);
    assume(layout_ != nullptr && bytes.size() == layout_->push_constants());
    state_->vk.vkCmdPushConstants(buffer_, layout_->handle(), layout_->push_stages(), 0,
                                  static_cast<std::uint32_t>(bytes.size()), bytes.data());
}

void Commands::dispatch(std::uint32_t x, std::uint32_t y, std::uint32_t z)
{
    if (gl_) return gl_->dispatch(x, y, z);
    const std::uint32_t counts[] = {x, y, z};
    for (int axis = 0; axis < 3; ++axis) assume(counts[axis] <= state_->limits.workgroup_count[axis]);
    state_->vk.vkCmdDispatch(buffer_, x, y, z);
}

void Commands::dispatch_over(std::uint32_t invocations)
{
    dispatch(invocations / workgroup_x_ + (invocations % workgroup_x_ != 0 ? 1 : 0));
}

void Commands::dispatch_indirect(const Buffer& counts, std::uint64_t offset)
{
    if (gl_) return gl_->dispatch_indirect(*counts.gl(), offset);
    state_->vk.vkCmdDispatchIndirect(buffer_, counts.handle(), offset);
}

void Commands::barrier(Work before, Work after)
{
    if (gl_) return gl_->barrier();
    memory_barrier(*state_, buffer_, scope(before), scope(after));
}

void Commands::prepare(Image& image, ImageUse use, bool discard)
{
    assume(use != ImageUse::undefined);
    if (gl_) {
        // OpenGL keeps its own order but for what shaders write.
        if (image.use() == ImageUse::storage) gl_->barrier();
        return image.set_use(use);
    }
    const ImageScope before = scope(image.use());
    const ImageScope after = scope(use);
    image.set_use(use);
    if (before.layout == after.layout && !before.writes && !after.writes) return;
    const VkImageMemoryBarrier2 barrier{
        .sType = VK_STRUCTURE_TYPE_IMAGE_MEMORY_BARRIER_2,
        .srcStageMask = before.scope.stages,
        .srcAccessMask = before.scope.access,
        .dstStageMask = after.scope.stages,
        .dstAccessMask = after.scope.access,
        .oldLayout = discard ? VK_IMAGE_LAYOUT_UNDEFINED : before.layout,
        .newLayout = after.layout,
        .srcQueueFamilyIndex = VK_QUEUE_FAMILY_IGNORED,
        .dstQueueFamilyIndex = VK_QUEUE_FAMILY_IGNORED,
        .image = image.handle(),
        .subresourceRange = {image.aspect(), 0, VK_REMAINING_MIP_LEVELS, 0, VK_REMAINING_ARRAY_LAYERS}};
    const VkDependencyInfo info{
        .sType = VK_STRUCTURE_TYPE_DEPENDENCY_INFO, .imageMemoryBarrierCount = 1, .pImageMemoryBarriers = &barrier};
    state_->vk.vkCmdPipelineBarrier2(buffer_, &info);
}

void Commands::begin_region(const std::string& region)
{
    assume(regions_.size() < kMaxRegions);
    if (!gl_ && state_->limits.timestamp_ns > 0 && !queries_) {
        const VkQueryPoolCreateInfo info{.sType = VK_STRUCTURE_TYPE_QUERY_POOL_CREATE_INFO,
                                         .queryType = VK_QUERY_TYPE_TIMESTAMP,
                                         .queryCount = 2 * kMaxRegions};
        VkQueryPool pool = VK_NULL_HANDLE;
        check(state_->vk.vkCreateQueryPool(state_->device, &info, state_->instance.allocator, &pool),
              "vkCreateQueryPool");
        queries_ = {*state_, pool};
        state_->vk.vkResetQueryPool(state_->device, pool, 0, 2 * kMaxRegions);
    }
    const auto index = static_cast<std::uint32_t>(regions_.size());
    regions_.push_back(region);
    open_regions_.push_back(index);
    if (gl_) gl_->stamp(2 * index);
    if (queries_)
        state_->vk.vkCmdWriteTimestamp2(buffer_, VK_PIPELINE_STAGE_2_ALL_COMMANDS_BIT, queries_.get(), 2 * index);
}

void Commands::end_region()
{
    assume(!open_regions_.empty());
    const std::uint32_t index = open_regions_.back();
    open_regions_.pop_back();
    if (gl_) gl_->stamp(2 * index + 1);
    if (queries_)
        state_->vk.vkCmdWriteTimestamp2(buffer_, VK_PIPELINE_STAGE_2_ALL_COMMANDS_BIT, queries_.get(), 2 * index + 1);
}

std::vector<RegionTime> Commands::times() const
{
    std::vector<RegionTime> out;
    if (gl_ && last_ != 0) {
        const std::vector<std::uint64_t> stamps = gl_->stamps();
        for (std::size_t i = 0; i < regions_.size(); ++i)
            out.push_back({regions_[i], static_cast<double>(stamps[2 * i + 1] - stamps[2 * i]) * 1e-6});
    }
    if (!queries_ || last_ == 0) return out;
    std::vector<std::uint64_t> ticks(2 * regions_.size());
    check(state_->vk.vkGetQueryPoolResults(state_->device, queries_.get(), 0, static_cast<std::uint32_t>(ticks.size()),
                                           ticks.size() * sizeof(std::uint64_t), ticks.data(), sizeof(std::uint64_t),
                                           VK_QUERY_RESULT_64_BIT | VK_QUERY_RESULT_WAIT_BIT),
          "vkGetQueryPoolResults");
    for (std::size_t i = 0; i < regions_.size(); ++i)
        out.push_back(
            {regions_[i], static_cast<double>(ticks[2 * i + 1] - ticks[2 * i]) * state_->limits.timestamp_ns * 1e-6});
    return out;
}

void Commands::end()
{
    if (!recording_) return;
    assume(open_regions_.empty());
    barrier(Work::all, Work::host);
    check(state_->vk.vkEndCommandBuffer(buffer_), "vkEndCommandBuffer");
    recording_ = false;
}

Ticket Commands::submit()
{
    if (gl_) return last_ = gl_->submit();
    return submit(VK_NULL_HANDLE, VK_NULL_HANDLE);
}

Ticket Commands::submit(VkSemaphore wait, VkSemaphore signal)
{
    end();
    if (queries_ && last_ != 0) {  // again: the stamps of the last time must be done with before they are reset
        this->wait();
        state_->vk.vkResetQueryPool(state_->device, queries_.get(), 0, 2 * kMaxRegions);
    }
    const auto semaphore = [](VkSemaphore handle, std::uint64_t value) {
        return VkSemaphoreSubmitInfo{.sType = VK_STRUCTURE_TYPE_SEMAPHORE_SUBMIT_INFO,
                                     .semaphore = handle,
                                     .value = value,
                                     .stageMask = VK_PIPELINE_STAGE_2_ALL_COMMANDS_BIT};
    };
    const std::lock_guard lock(state_->queue_mutex);
    const VkSemaphoreSubmitInfo waits[] = {semaphore(wait, 0)};
    const VkSemaphoreSubmitInfo signals[] = {semaphore(state_->timeline, state_->submitted + 1), semaphore(signal, 0)};
    const VkCommandBufferSubmitInfo commands{.sType = VK_STRUCTURE_TYPE_COMMAND_BUFFER_SUBMIT_INFO,
                                             .commandBuffer = buffer_};
    const VkSubmitInfo2 info{.sType = VK_STRUCTURE_TYPE_SUBMIT_INFO_2,
                             .waitSemaphoreInfoCount = wait != VK_NULL_HANDLE ? 1u : 0u,
                             .pWaitSemaphoreInfos = waits,
                             .commandBufferInfoCount = 1,
                             .pCommandBufferInfos = &commands,
                             .signalSemaphoreInfoCount = signal != VK_NULL_HANDLE ? 2u : 1u,
                             .pSignalSemaphoreInfos = signals};
    check(state_->vk.vkQueueSubmit2(state_->queue, 1, &info, VK_NULL_HANDLE), "vkQueueSubmit2");
    last_ = ++state_->submitted;
    return last_;
}

void Commands::wait(std::chrono::milliseconds timeout) const
{
    if (gl_) return gl_->device().wait(last_, timeout);
    if (last_ != 0) gpu::wait(*state_, last_, timeout);
}

void run(Device& device, const std::function<void(Commands&)>& record, std::chrono::milliseconds timeout)
{
    Commands commands(device);
    record(commands);
    device.wait(commands.submit(), timeout);
}

}  // namespace etalon::gpu
