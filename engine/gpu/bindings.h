#pragma once
#include <variant>
#include <vector>

#include "engine/gpu/buffer.h"
#include "engine/gpu/image.h"
#include "engine/gpu/pipeline.h"

namespace etalon::gpu {

void destroy_descriptor_pool(const DeviceState& state, VkDescriptorPool pool);

/// A range of a buffer, for storage and uniform blocks.
struct BufferRange {
    const Buffer* buffer = nullptr;
    std::uint64_t offset = 0;  ///< a multiple of kOffsetAlignment
    std::uint64_t size = VK_WHOLE_SIZE;
};

/// An image as a shader sees it. `sampler` null: a storage image, or a texture2D without sampler.
struct ImageBinding {
    const Image* image = nullptr;
    const Sampler* sampler = nullptr;
};

/// What goes to one binding number. An array of textures gets a vector of at most as many as the shader declares; the
/// rest of the array repeats its last element.
struct Bind {
    std::uint32_t binding = 0;
    std::variant<BufferRange, const TexelView*, ImageBinding, std::vector<ImageBinding>, const Sampler*> what;

    Bind(std::uint32_t b, const Buffer& buffer) : binding(b), what(BufferRange{&buffer}) {}
    Bind(std::uint32_t b, const BufferRange& range) : binding(b), what(range) {}
    Bind(std::uint32_t b, const TexelView& view) : binding(b), what(&view) {}
    Bind(std::uint32_t b, const Image& image) : binding(b), what(ImageBinding{&image}) {}
    Bind(std::uint32_t b, const Image& image, const Sampler& sampler) : binding(b), what(ImageBinding{&image, &sampler})
    {}
    Bind(std::uint32_t b, std::vector<ImageBinding> images) : binding(b), what(std::move(images)) {}
    Bind(std::uint32_t b, const Sampler& sampler) : binding(b), what(&sampler) {}
};

/// One descriptor set, filled once. What is bound must outlive it.
class Bindings {
 public:
    Bindings() = default;
    /// For descriptor set `set` of `layout` (any pipeline whose shaders declare that set alike can use it). Entries
    /// whose number the shaders do not declare are passed over, so that one list can serve several kernels. Throws
    /// Error(input) naming the binding when one is missing, of the wrong kind, or larger than the device can bind.
    Bindings(Device& device, const Layout& layout, const std::vector<Bind>& binds, std::uint32_t set = 0);

    VkDescriptorSet handle() const { return set_; }
    /// By OpenGL; null by Vulkan.
    const GlBindings* gl() const { return gl_.get(); }
    std::uint32_t index() const { return index_; }

 private:
    Owned<VkDescriptorPool, destroy_descriptor_pool> pool_;  // of exactly this set
    VkDescriptorSet set_ = VK_NULL_HANDLE;
    std::uint32_t index_ = 0;
    GlOwned<GlBindings> gl_;
};

}  // namespace etalon::gpu
