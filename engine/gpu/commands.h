#pragma once
#include <array>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "engine/gpu/bindings.h"
#include "engine/gpu/buffer.h"
#include "engine/gpu/image.h"
#include "engine/gpu/pipeline.h"

namespace etalon::gpu {

void destroy_command_pool(const DeviceState& state, VkCommandPool pool);
void destroy_query_pool(const DeviceState& state, VkQueryPool pool);

/// Kinds of work that wait for one another.
enum class Work { compute, copy, draw, indirect, host, all };

struct ColorTarget {
    Image* image = nullptr;
    std::optional<VkClearColorValue> clear;  ///< nothing: keeps what is there
    Image* resolve = nullptr;  ///< single-sample image that receives the mean of samples (first one for integers)
    bool store = true;         ///< of `image` itself; a resolved multisample image needs it not
};

struct DepthTarget {
    Image* image = nullptr;
    std::optional<float> clear = 0.f;  ///< reversed depth: 0 is infinitely far
    bool store = false;
    Image* resolve = nullptr;  ///< single-sample image that receives sample 0
};

/// Milliseconds that the device spent between begin_region and end_region.
struct RegionTime {
    std::string name;
    double milliseconds = 0;
};

/// A list of device work: recorded once, submitted once or often. Everything recorded before it on this device is seen
/// by it, in whatever Commands, and its results are seen by the host once waited for. Barriers are needed only between
/// what is recorded in the same list. Destruction waits for the last submission.
class Commands {
 public:
    explicit Commands(Device& device, std::string name = {});
    Commands(Commands&&) noexcept;
    Commands& operator=(Commands&&) = delete;
    ~Commands();

    /// Pipeline for what follows, with its bindings (each knows its set number).
    void bind(const ComputePipeline& pipeline, const Bindings& bindings);
    void bind(const ComputePipeline& pipeline);
    void bind(const GraphicsPipeline& pipeline);
    /// For the pipeline bound last.
    void bind(const Bindings& bindings);
    /// Push constants of the pipeline bound last, from offset 0. Must be exactly as large as the shaders declare.
    template <class T>
    void push(const T& value)
    {
        push_bytes(std::as_bytes(std::span(&value, 1)));
    }
    void push_bytes(std::span<const std::byte> bytes);

    /// Workgroups.
    void dispatch(std::uint32_t x, std::uint32_t y = 1, std::uint32_t z = 1);
    /// As many workgroups as cover this many invocations along x.
    void dispatch_over(std::uint32_t invocations);
    /// Workgroup counts from 3 uints at `offset`.
    void dispatch_indirect(const Buffer& counts, std::uint64_t offset = 0);

    /// What `before` wrote is done and seen by `after`.
    void barrier(Work before, Work after);
    /// Makes the image ready for its next use, after its last one. From ImageUse::undefined, or with `discard`, the
    /// contents are lost.
    void prepare(Image& image, ImageUse use, bool discard = false);

    void fill(const Buffer& buffer, std::uint32_t word, std::uint64_t offset = 0, std::uint64_t size = VK_WHOLE_SIZE);
    void copy(const Buffer& from, const Buffer& to, std::uint64_t size, std::uint64_t from_offset = 0,
              std::uint64_t to_offset = 0);
    /// Tightly packed texels; the image must have been prepared as copy_target / copy_source.
    void copy(const Buffer& from, const Image& to, std::uint32_t mip, std::uint32_t layer, std::uint64_t offset = 0);
    void copy(const Image& from, const Buffer& to, std::uint32_t mip, std::uint32_t layer, std::uint64_t offset = 0);
    /// Scales the whole of `from` into the whole of `to` (level 0, layer 0); prepared as copy_source and copy_target.
    void blit(const Image& from, const Image& to, VkFilter filter);
    void clear(const Image& image, const VkClearColorValue& value);  ///< prepared as copy_target

    /// Prepares the targets and starts drawing to them; viewport and scissor are the whole of them.
    void begin_rendering(std::span<const ColorTarget> colors, const std::optional<DepthTarget>& depth = std::nullopt);
    void end_rendering();
    /// Pixels; y down, depth range [0, 1].
    void set_viewport(float x, float y, float width, float height);
    void set_scissor(int x, int y, std::uint32_t width, std::uint32_t height);
    void set_cull(VkCullModeFlags cull, VkFrontFace front);
    void bind_vertices(std::uint32_t stream, const Buffer& buffer, std::uint64_t offset = 0);
    void bind_indices(const Buffer& buffer, VkIndexType type = VK_INDEX_TYPE_UINT32, std::uint64_t offset = 0);
    void draw(std::uint32_t vertices, std::uint32_t instances = 1, std::uint32_t first_vertex = 0,
              std::uint32_t first_instance = 0);
    void draw_indexed(std::uint32_t indices, std::uint32_t instances = 1, std::uint32_t first_index = 0,
                      std::int32_t vertex_offset = 0, std::uint32_t first_instance = 0);

    /// Times what is recorded between the two; regions may nest. At most kMaxRegions a list. Where the device has no
    /// timestamps, nothing is timed. Submitting a list with regions again waits for its last run.
    void begin_region(const std::string& name);
    void end_region();
    static constexpr std::uint32_t kMaxRegions = 128;
    /// Of the last submission, which must have finished; in the order of begin_region.
    std::vector<RegionTime> times() const;

    /// Hands the work to the device, ending the recording at the first call; may be called again to run it again.
    Ticket submit();
    /// The same with binary semaphores to wait for and to signal, for presentation.
    Ticket submit(VkSemaphore wait, VkSemaphore signal);
    void wait(std::chrono::milliseconds timeout = std::chrono::minutes(2)) const;

    VkCommandBuffer handle() const { return buffer_; }

 private:
    void begin_gl(std::span<const ColorTarget> colors, const std::optional<DepthTarget>& depth);

    void end();
    void bind(VkPipelineBindPoint point, VkPipeline pipeline, const Layout& layout);

    DeviceState* state_ = nullptr;  // by Vulkan
    GlOwned<GlCommands> gl_;        // by OpenGL
    Owned<VkCommandPool, destroy_command_pool> pool_;
    Owned<VkQueryPool, destroy_query_pool> queries_;
    VkCommandBuffer buffer_ = VK_NULL_HANDLE;
    std::string name_;
    bool recording_ = true;
    VkPipelineBindPoint point_ = VK_PIPELINE_BIND_POINT_COMPUTE;
    const Layout* layout_ = nullptr;
    std::uint32_t workgroup_x_ = 1;
    std::vector<std::string> regions_;
    std::vector<std::uint32_t> open_regions_;
    Ticket last_ = 0;
};

/// Records, submits and waits.
void run(Device& device, const std::function<void(Commands&)>& record,
         std::chrono::milliseconds timeout = std::chrono::minutes(2));

}  // namespace etalon::gpu
