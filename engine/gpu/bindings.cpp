#include "engine/gpu/bindings.h"

#include <fmt/format.h>

#include <algorithm>
#include <list>

#include "engine/base/error.h"
#include "engine/gpu/device_state.h"
#include "engine/gpu/gl_commands.h"

namespace etalon::gpu {
namespace {

std::string_view name(VkDescriptorType type)
{
    switch (type) {
        case VK_DESCRIPTOR_TYPE_SAMPLER:
            return "a sampler";
        case VK_DESCRIPTOR_TYPE_COMBINED_IMAGE_SAMPLER:
            return "an image with a sampler";
        case VK_DESCRIPTOR_TYPE_SAMPLED_IMAGE:
            return "an image without sampler";
        case VK_DESCRIPTOR_TYPE_STORAGE_IMAGE:
            return "a storage image";
        case VK_DESCRIPTOR_TYPE_UNIFORM_TEXEL_BUFFER:
        case VK_DESCRIPTOR_TYPE_STORAGE_TEXEL_BUFFER:
            return "a texel view";
        default:
            return "a buffer";
    }
}

[[noreturn]] void throw_wrong_kind(const Layout& layout, const DeclaredBinding& declared)
{
    throw Error(Blame::input, fmt::format("pipeline \"{}\": binding {} wants {}{}, and was given something else",
                                          layout.name(), declared.binding, name(declared.type),
                                          declared.count > 1 ? fmt::format(", {} times", declared.count) : ""));
}

/// Bytes that are bound. Throws Error(machine) when they are more than the device binds.
std::uint64_t size_of(const DeviceLimits& limits, const Layout& layout, const DeclaredBinding& declared,
                      const BufferRange& range)
{
    assume(range.offset < range.buffer->size() && range.offset % kOffsetAlignment == 0);
    const std::uint64_t size = range.size == VK_WHOLE_SIZE ? range.buffer->size() - range.offset : range.size;
    const std::uint64_t most =
        declared.type == VK_DESCRIPTOR_TYPE_UNIFORM_BUFFER ? limits.uniform_buffer_range : limits.storage_buffer_range;
    if (size > most)
        throw Error(Blame::machine,
                    fmt::format("pipeline \"{}\": binding {} needs {} bytes in one piece; this device binds at most {}",
                                layout.name(), declared.binding, size, most),
                    "use a smaller picture or scene");
    return size;
}

/// The bind for a declared binding. Throws Error(input) where there is none.
const Bind& find(const Layout& layout, const std::vector<Bind>& binds, const DeclaredBinding& declared)
{
    const auto bind = std::find_if(binds.begin(), binds.end(),
                                   [&](const Bind& candidate) { return candidate.binding == declared.binding; });
    if (bind == binds.end())
        throw Error(Blame::input,
                    fmt::format("pipeline \"{}\": nothing was given for set {}, binding {}, which wants {}",
                                layout.name(), declared.set, declared.binding, name(declared.type)));
    return *bind;
}

/// Collects descriptor writes and what they point to; lists, because the writes keep addresses.
class Writer {
 public:
    Writer(const DeviceState& state, const Layout& layout, VkDescriptorSet set)
        : state_(state), layout_(layout), set_(set)
    {}

    void add(const DeclaredBinding& declared, const Bind& bind)
    {
        VkWriteDescriptorSet write{.sType = VK_STRUCTURE_TYPE_WRITE_DESCRIPTOR_SET,
                                   .dstSet = set_,
                                   .dstBinding = declared.binding,
                                   .descriptorCount = declared.count,
                                   .descriptorType = declared.type};
        switch (declared.type) {
            case VK_DESCRIPTOR_TYPE_UNIFORM_BUFFER:
            case VK_DESCRIPTOR_TYPE_STORAGE_BUFFER:
                write.pBufferInfo = buffer_info(declared, bind);
                break;
            case VK_DESCRIPTOR_TYPE_UNIFORM_TEXEL_BUFFER:
            case VK_DESCRIPTOR_TYPE_STORAGE_TEXEL_BUFFER:
                write.pTexelBufferView = texel_info(declared, bind);
                break;
            default:
                write.pImageInfo = image_infos(declared, bind);
                break;
        }
        writes_.push_back(write);
    }

    void flush() const
    {
        state_.vk.vkUpdateDescriptorSets(state_.device, static_cast<std::uint32_t>(writes_.size()), writes_.data(), 0,
                                         nullptr);
    }

 private:
    const VkDescriptorBufferInfo* buffer_info(const DeclaredBinding& declared, const Bind& bind)
    {
        const auto* range = std::get_if<BufferRange>(&bind.what);
        if (range == nullptr || range->buffer == nullptr || declared.count != 1) throw_wrong_kind(layout_, declared);
        const std::uint64_t size = size_of(state_.limits, layout_, declared, *range);
        return &buffers_.emplace_back(VkDescriptorBufferInfo{range->buffer->handle(), range->offset, size});
    }

    const VkBufferView* texel_info(const DeclaredBinding& declared, const Bind& bind)
    {
        const auto* view = std::get_if<const TexelView*>(&bind.what);
        if (view == nullptr || (*view)->handle() == VK_NULL_HANDLE || declared.count != 1)
            throw_wrong_kind(layout_, declared);
        return &views_.emplace_back((*view)->handle());
    }

    const VkDescriptorImageInfo* image_infos(const DeclaredBinding& declared, const Bind& bind)
    {
        std::vector<VkDescriptorImageInfo>& infos = images_.emplace_back();
        if (const auto* sampler = std::get_if<const Sampler*>(&bind.what))
            infos.push_back({.sampler = (*sampler)->handle()});
        else if (const auto* image = std::get_if<ImageBinding>(&bind.what))
            infos.push_back(image_info(declared, *image));
        else if (const auto* list = std::get_if<std::vector<ImageBinding>>(&bind.what))
            for (const ImageBinding& each : *list) infos.push_back(image_info(declared, each));
        const bool samplers = std::holds_alternative<const Sampler*>(bind.what);
        if (infos.empty() || infos.size() > declared.count || samplers != (declared.type == VK_DESCRIPTOR_TYPE_SAMPLER))
            throw_wrong_kind(layout_, declared);
        infos.resize(declared.count, infos.back());
        return infos.data();
    }

    VkDescriptorImageInfo image_info(const DeclaredBinding& declared, const ImageBinding& bind) const
    {
        const bool sampled = declared.type == VK_DESCRIPTOR_TYPE_COMBINED_IMAGE_SAMPLER;
        if (bind.image == nullptr || !*bind.image || sampled != (bind.sampler != nullptr))
            throw_wrong_kind(layout_, declared);
        return {.sampler = sampled ? bind.sampler->handle() : VK_NULL_HANDLE,
                .imageView = bind.image->view(),
                .imageLayout = declared.type == VK_DESCRIPTOR_TYPE_STORAGE_IMAGE
                                   ? VK_IMAGE_LAYOUT_GENERAL
                                   : VK_IMAGE_LAYOUT_SHADER_READ_ONLY_OPTIMAL};
    }

    const DeviceState& state_;
    const Layout& layout_;
    VkDescriptorSet set_;
    std::vector<VkWriteDescriptorSet> writes_;
    std::list<VkDescriptorBufferInfo> buffers_;
    std::list<VkBufferView> views_;
    std::list<std::vector<VkDescriptorImageInfo>> images_;
};

GlBound::Texture gl_texture(const Layout& layout, const DeclaredBinding& declared, const ImageBinding& bind)
{
    const bool sampled = declared.type == VK_DESCRIPTOR_TYPE_COMBINED_IMAGE_SAMPLER;
    if (bind.image == nullptr || !*bind.image || sampled != (bind.sampler != nullptr))
        throw_wrong_kind(layout, declared);
    return {.image = bind.image->gl()->name(),
            .format = bind.image->gl()->format().internal,
            .array = bind.image->gl()->is_array(),
            .sampler = sampled ? bind.sampler->gl()->name() : 0};
}

GlBound gl_bound(const DeviceLimits& limits, const Layout& layout, const DeclaredBinding& declared, const Bind& bind)
{
    GlBound out{.binding = declared.binding, .textures = {}};
    if (declared.type == VK_DESCRIPTOR_TYPE_UNIFORM_BUFFER || declared.type == VK_DESCRIPTOR_TYPE_STORAGE_BUFFER) {
        const auto* range = std::get_if<BufferRange>(&bind.what);
        if (range == nullptr || range->buffer == nullptr || declared.count != 1) throw_wrong_kind(layout, declared);
        out.size = size_of(limits, layout, declared, *range);
        out.offset = range->offset;
        out.buffer = range->buffer->gl();
    } else if (const auto* sampler = std::get_if<const Sampler*>(&bind.what)) {
        if (declared.type != VK_DESCRIPTOR_TYPE_SAMPLER) throw_wrong_kind(layout, declared);
        out.textures.push_back({.sampler = (*sampler)->gl()->name()});
    } else if (const auto* image = std::get_if<ImageBinding>(&bind.what)) {
        out.textures.push_back(gl_texture(layout, declared, *image));
    } else if (const auto* list = std::get_if<std::vector<ImageBinding>>(&bind.what)) {
        for (const ImageBinding& each : *list) out.textures.push_back(gl_texture(layout, declared, each));
    }
    if (out.buffer == nullptr && (out.textures.empty() || out.textures.size() > declared.count))
        throw_wrong_kind(layout, declared);
    return out;
}

GlBindings bind_gl(const DeviceLimits& limits, const Layout& layout, const std::vector<Bind>& binds, std::uint32_t set)
{
    GlBindings out;
    for (const DeclaredBinding& declared : layout.bindings())
        if (declared.set == set) out.bound.push_back(gl_bound(limits, layout, declared, find(layout, binds, declared)));
    return out;
}

}  // namespace

void destroy_descriptor_pool(const DeviceState& state, VkDescriptorPool pool)
{
    state.vk.vkDestroyDescriptorPool(state.device, pool, state.instance.allocator);
}

Bindings::Bindings(Device& device, const Layout& layout, const std::vector<Bind>& binds, std::uint32_t set)
    : index_(set)
{
    std::vector<VkDescriptorPoolSize> sizes;
    for (const DeclaredBinding& declared : layout.bindings())
        if (declared.set == set) sizes.push_back({declared.type, declared.count});
    if (sizes.empty())
        throw Error(Blame::input, fmt::format("pipeline \"{}\" declares no descriptor set {}", layout.name(), set));
    if (device.gl() != nullptr) {
        gl_.reset(new GlBindings(bind_gl(device.limits(), layout, binds, set)));
        return;
    }
    const DeviceState& state = device.state();
    const VkDescriptorPoolCreateInfo info{.sType = VK_STRUCTURE_TYPE_DESCRIPTOR_POOL_CREATE_INFO,
                                          .maxSets = 1,
                                          .poolSizeCount = static_cast<std::uint32_t>(sizes.size()),
                                          .pPoolSizes = sizes.data()};
    VkDescriptorPool pool = VK_NULL_HANDLE;
    check(state.vk.vkCreateDescriptorPool(state.device, &info, state.instance.allocator, &pool),
          "vkCreateDescriptorPool");
    pool_ = {state, pool};
    const VkDescriptorSetLayout set_layout = layout.set(set);
    const VkDescriptorSetAllocateInfo allocation{.sType = VK_STRUCTURE_TYPE_DESCRIPTOR_SET_ALLOCATE_INFO,
                                                 .descriptorPool = pool,
                                                 .descriptorSetCount = 1,
                                                 .pSetLayouts = &set_layout};
    check(state.vk.vkAllocateDescriptorSets(state.device, &allocation, &set_), "vkAllocateDescriptorSets");

    Writer writer(state, layout, set_);
    for (const DeclaredBinding& declared : layout.bindings()) {
        if (declared.set != set) continue;
        writer.add(declared, find(layout, binds, declared));
    }
    writer.flush();
}

}  // namespace etalon::gpu
