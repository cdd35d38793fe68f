#include "engine/render/raster_textures.h"

#include <fmt/format.h>

#include <optional>

#include "engine/base/error.h"
#include "engine/scene/simplify.h"

namespace etalon {

/// One binding of surface.glsl.
struct RasterTextures::Slot {
    std::uint32_t binding;
    const TextureUse* use;  // null: not read
    Coding coding;
};

namespace {

constexpr std::uint32_t kFirstLayerBinding = 5;  // of layers.glsl
constexpr VkFormat kTexelFormat = VK_FORMAT_R16G16B16A16_UNORM;

VkSamplerAddressMode address_mode(Wrap wrap)
{
    switch (wrap) {
        case Wrap::mirrored_repeat:
            return VK_SAMPLER_ADDRESS_MODE_MIRRORED_REPEAT;
        case Wrap::clamp_to_edge:
            return VK_SAMPLER_ADDRESS_MODE_CLAMP_TO_EDGE;
        default:
            return VK_SAMPLER_ADDRESS_MODE_REPEAT;
    }
}

VkFilter filter(Filter filter)
{
    return filter == Filter::nearest ? VK_FILTER_NEAREST : VK_FILTER_LINEAR;
}

gpu::SamplerSpec describe(Sampler sampler, bool mipmaps, TextureFilter by)
{
    if (by != TextureFilter::file) {
        sampler.mag = sampler.min = by == TextureFilter::nearest ? Filter::nearest : Filter::linear;
        sampler.mip = by == TextureFilter::trilinear ? Filter::linear : Filter::nearest;
        sampler.mipmapped = true;
    }
    const bool levels = sampler.mipmapped && mipmaps;
    return {.magnify = filter(sampler.mag),
            .minify = filter(sampler.min),
            .mipmap = levels && sampler.mip == Filter::linear ? VK_SAMPLER_MIPMAP_MODE_LINEAR
                                                              : VK_SAMPLER_MIPMAP_MODE_NEAREST,
            .wrap_u = address_mode(sampler.wrap_u),
            .wrap_v = address_mode(sampler.wrap_v),
            // 0.25: level 0 alone, yet minified where the level is above 0 (VkSamplerCreateInfo, note on minFilter).
            .max_lod = levels ? VK_LOD_CLAMP_NONE : 0.25f};
}

}  // namespace

RasterTextures::RasterTextures(gpu::Device& device, const Scene& scene, bool mipmaps, TextureFilter filter,
                               unsigned threads)
    : device_(device), scene_(scene), mipmaps_(mipmaps), filter_(filter), threads_(threads), white_sampler_(device, {})
{
    const Texels texel{.width = 1, .height = 1, .is_8_bit = true, .bytes = {255, 255, 255, 255}, .wide = {}};
    white_ = upload(decode_mips(texel, Coding::linear, false), "white");
}

std::vector<RasterTextures::Slot> RasterTextures::slots(const Material& material, const RasterVariant& variant)
{
    using C = RasterConstant;
    const bool glossy = material.model == BsdfModel::specular_glossiness;
    const auto slot = [&](C constant, const TextureUse& use, Coding coding) {
        const auto binding = static_cast<std::uint32_t>(constant) - static_cast<std::uint32_t>(C::base_color_texture);
        return Slot{binding, variant.get(constant) != 0 && use.present() ? &use : nullptr, coding};
    };
    std::vector<Slot> all{slot(C::base_color_texture, material.base_color_texture, Coding::srgb),
                          slot(C::metallic_roughness_texture, material.metallic_roughness_texture,
                               glossy ? Coding::srgb : Coding::linear),
                          slot(C::normal_texture, material.normal_texture, Coding::normal),
                          slot(C::occlusion_texture, material.occlusion_texture, Coding::linear),
                          slot(C::emissive_texture, material.emissive_texture, Coding::srgb)};
    for (std::uint32_t i = 0; i < kLayerTextures; ++i) {
        const auto texture = static_cast<LayerTexture>(i);
        const bool colored = texture == LayerTexture::specular_color || texture == LayerTexture::sheen_color ||
                             texture == LayerTexture::diffuse_transmission_color;
        const bool read =
            variant.reads(texture) && material.layers && layer_texture(*material.layers, texture).present();
        all.push_back({kFirstLayerBinding + i, read ? &layer_texture(*material.layers, texture) : nullptr,
                       texture == LayerTexture::clearcoat_normal ? Coding::normal
                       : colored                                 ? Coding::srgb
                                                                 : Coding::linear});
    }
    return all;
}

RasterTextures::Key RasterTextures::key(const Material& material, const RasterVariant& variant)
{
    Key key;
    for (const Slot& slot : slots(material, variant))
        key.emplace_back(slot.use != nullptr ? slot.use->texture : kNone, slot.coding);
    return key;
}

void RasterTextures::require(const Material& material, const RasterVariant& variant)
{
    for (const Slot& slot : slots(material, variant)) {
        if (slot.use == nullptr) continue;
        const Texture& texture = scene_.textures[slot.use->texture];
        sampler(texture.sampler);
        if (texture.image == kNone || images_.contains({texture.image, slot.coding})) continue;
        const Texels& image = scene_.images[texture.image];
        const std::optional<Texels> constant = shrunk_constant(image);
        const MipChain chain = decode_mips(constant ? *constant : image, slot.coding, mipmaps_, threads_);
        images_.emplace(ImageKey{texture.image, slot.coding}, upload(chain, fmt::format("image {}", texture.image)));
    }
}

gpu::Bindings RasterTextures::bind(const gpu::Layout& layout, const Material& material,
                                   const RasterVariant& variant) const
{
    std::vector<gpu::Bind> binds;
    for (const Slot& slot : slots(material, variant)) {
        const Texture* texture = slot.use != nullptr ? &scene_.textures[slot.use->texture] : nullptr;
        if (texture == nullptr || texture->image == kNone)
            binds.emplace_back(slot.binding, white_, white_sampler_);
        else
            binds.emplace_back(slot.binding, images_.at({texture->image, slot.coding}),
                               *find_sampler(texture->sampler));
    }
    return {device_, layout, binds, 1};
}

const gpu::Sampler* RasterTextures::find_sampler(const Sampler& sampler) const
{
    const gpu::SamplerSpec spec = describe(sampler, mipmaps_, filter_);
    for (const auto& [known, made] : samplers_)
        if (known == spec) return &made;
    return nullptr;
}

const gpu::Sampler& RasterTextures::sampler(const Sampler& sampler)
{
    if (const gpu::Sampler* known = find_sampler(sampler)) return *known;
    const gpu::SamplerSpec spec = describe(sampler, mipmaps_, filter_);
    return samplers_.emplace_back(spec, gpu::Sampler(device_, spec)).second;
}

gpu::Image RasterTextures::upload(const MipChain& chain, const std::string& name) const
{
    gpu::Image image(device_, {.format = kTexelFormat,
                               .width = static_cast<std::uint32_t>(chain.levels[0].width),
                               .height = static_cast<std::uint32_t>(chain.levels[0].height),
                               .mips = static_cast<std::uint32_t>(chain.levels.size()),
                               .usage = VK_IMAGE_USAGE_SAMPLED_BIT,
                               .name = name});
    std::vector<gpu::ImagePart> parts;
    for (std::uint32_t mip = 0; mip < chain.levels.size(); ++mip)
        parts.push_back({.texels = std::as_bytes(std::span(chain.levels[mip].values)), .mip = mip});
    gpu::upload(device_, image, parts);
    return image;
}

}  // namespace etalon
