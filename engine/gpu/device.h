#pragma once
#include <vulkan/vulkan_core.h>

#include <chrono>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "engine/base/error.h"

namespace etalon::gpu {

struct DeviceState;
class GlDevice;

enum class DeviceKind { cpu, gpu };  ///< cpu: software (lavapipe); gpu: everything else
std::string_view name(DeviceKind kind);

/// What does a device's work.
enum class Backend { vulkan, opengl };
std::string_view name(Backend backend);  ///< "vulkan", "opengl"

/// One device of this machine, and why it is not the one in use.
struct DeviceReport {
    unsigned index = 0;  ///< in the loader's order; what DeviceOptions::device accepts
    std::string name;
    DeviceKind kind = DeviceKind::gpu;
    std::string type;          ///< "discrete", "integrated", "virtual", "cpu", "other"
    std::string driver;        ///< driver name and version info: "llvmpipe, Mesa 22.3.6 (LLVM 15.0.6)"
    std::string api_version;   ///< Vulkan version it offers: "1.3.230"
    std::uint64_t memory = 0;  ///< bytes of its largest device-local heap
    bool chosen = false;
    std::vector<std::string> reasons;  ///< every reason why it was not chosen; empty for the chosen one
};

struct DeviceOptions {
    Backend backend = Backend::vulkan;
    std::string device;  ///< an index, or a part of the name (case ignored); empty: GPUs first, then the CPU
    std::optional<DeviceKind> kind;  ///< only this kind will do
    bool validate = false;           ///< core and synchronization validation; see Device::validation_messages
    /// Also hears what validation says, until the device is gone; called by whichever thread makes the faulty call.
    std::function<void(const std::string&)> on_message;
    std::optional<std::uint64_t> memory_budget;  ///< bytes; see Device::memory_budget
    /// Every Vulkan object is made and destroyed with these; null: as the driver likes. Must outlive the Device. For
    /// tests of a host that is out of memory.
    const VkAllocationCallbacks* allocator = nullptr;
    /// Never maps device memory, as on a discrete GPU, also where it is the host's: for tests of that way.
    bool staged = false;
    /// To present: what the window system needs of the instance, and how it makes a surface. The Device owns the
    /// surface and is chosen so that it can present to it.
    std::vector<std::string> instance_extensions;
    std::function<VkSurfaceKHR(VkInstance)> make_surface;
};

/// What the device allows and has, as far as this project asks.
struct DeviceLimits {
    std::uint64_t storage_buffer_range = 0;   ///< bytes visible through one storage buffer binding
    std::uint64_t uniform_buffer_range = 0;   ///< bytes
    std::uint64_t texel_buffer_elements = 0;  ///< texels of one texel buffer view
    std::uint64_t buffer_size = 0;            ///< bytes of one buffer
    std::uint64_t allocation = 0;             ///< bytes of one buffer or image, whatever the memory
    std::uint32_t image_side = 0;             ///< texels of a 2D image
    std::uint32_t image_layers = 0;
    std::uint32_t push_constants = 0;  ///< bytes
    std::uint32_t sampled_images_per_stage = 0;
    std::uint32_t storage_buffers_per_stage = 0;
    std::uint32_t storage_images_per_stage = 0;  ///< storage texel buffers count as these
    std::uint32_t workgroup_count[3] = {};
    std::uint32_t workgroup_size[3] = {};
    std::uint32_t workgroup_invocations = 0;
    std::uint32_t workgroup_memory = 0;  ///< bytes of shared memory
    std::uint32_t subgroup_size = 0;
    std::uint32_t samples = 0;        ///< bit n: 2^n samples a pixel, in float colour and depth alike
    std::uint32_t subpixel_bits = 0;  ///< of rasterization coordinates
    std::uint32_t subtexel_bits = 0;  ///< of linear filtering
    std::uint32_t mip_bits = 0;       ///< of the fraction between mip levels
    float anisotropy = 1;             ///< 1: none
    double timestamp_ns = 0;          ///< nanoseconds per tick; 0: the queue has no timestamps
    bool float64 = false;
    bool int64 = false;
    bool primitive_id = false;  ///< gl_PrimitiveID in fragment shaders (geometryShader)
    bool wide_lines = false;
    bool wireframe = false;
};

/// A Device that was lost: nothing made on it will work again, but Device::renew may bring it back.
class DeviceLost : public Error {
 public:
    using Error::Error;
};

/// Identifies a submission; submissions finish in order.
using Ticket = std::uint64_t;

/// Bytes of device memory: what is held of the driver, and what may be.
struct MemoryUse {
    std::uint64_t held = 0;    ///< in arenas
    std::uint64_t in_use = 0;  ///< by buffers and images
    std::uint64_t budget = 0;
};

/// Every Vulkan device, with the reasons for and against each under `options`. Never throws for lack of a device: the
/// list is empty then, or all its entries have reasons. Throws Error(machine) when there is no Vulkan loader.
std::vector<DeviceReport> list_devices(const DeviceOptions& options = {});

/// A device by Vulkan or OpenGL. By Vulkan:
/// a logical Vulkan 1.3 device with one graphics and compute queue, on which everything in engine/gpu is made and which
/// must outlive it all. Required of a device: dynamic rendering, synchronization2, timeline semaphores, buffer device
/// address, scalar block layout. Creation throws Error(machine) with every device's reasons when none will do.
/// Movable; submit and memory calls may come from several threads.
class Device {
 public:
    explicit Device(const DeviceOptions& options = {});
    Device(Device&&) noexcept;
    Device& operator=(Device&&) noexcept;
    ~Device();

    /// After DeviceLost: the same device anew, by the same options; what validation said is kept. Everything made on
    /// the old one must be gone. Throws as creation does; *this can then only be destroyed, assigned to or renewed.
    void renew();

    const DeviceReport& report() const;                   ///< of the device in use
    const std::vector<DeviceReport>& candidates() const;  ///< of all
    const DeviceLimits& limits() const;
    DeviceKind kind() const { return report().kind; }
    const std::string& name() const { return report().name; }
    /// What it was made by, for metadata: "llvmpipe (LLVM 15.0.6, 256 bits), llvmpipe Mesa 22.3.6, Vulkan 1.3.230".
    std::string description() const;

    /// Most bytes that may be allocated; more throws Error(machine) with what was needed and what there is. By default
    /// 75% of the machine's memory on CPU devices and 75% of the largest device-local heap on others.
    std::uint64_t memory_budget() const { return memory().budget; }
    MemoryUse memory() const;
    /// True where device memory is the host's: buffers of MemoryKind::device are mapped and need no staging.
    bool unified_memory() const;

    /// Whether an optimally tiled 2D image of `format` can do all of `features` with so many samples.
    bool supports(VkFormat format, VkFormatFeatureFlags features, std::uint32_t samples = 1) const;

    /// Blocks until the submission has finished. Throws Error(machine) when the time is over, DeviceLost when the
    /// device is lost.
    void wait(Ticket ticket, std::chrono::milliseconds timeout = std::chrono::minutes(2)) const;
    bool finished(Ticket ticket) const;
    void wait_idle() const;

    bool validating() const;
    /// What the validation layers have said since creation (errors and warnings); empty when not validating.
    std::vector<std::string> validation_messages() const;

    VkInstance instance() const;
    VkSurfaceKHR surface() const;  ///< null unless options.make_surface was given
    Backend backend() const { return options_.backend; }
    /// For the other files of engine/gpu. By Vulkan alone.
    DeviceState& state() const
    {
        assume(state_ != nullptr);
        return *state_;
    }
    /// By OpenGL; null by Vulkan.
    GlDevice* gl() const { return gl_.get(); }

 private:
    DeviceOptions options_;
    std::vector<std::string> earlier_messages_;  // of validation, before renewals
    void make();

    std::unique_ptr<DeviceState> state_;  // of one backend or the other
    std::unique_ptr<GlDevice> gl_;
};

/// Versions of what stands between us and the device, for `info`: loader and layers ("name version"
/// each); empty without a loader.
std::vector<std::string> vulkan_versions();

}  // namespace etalon::gpu
