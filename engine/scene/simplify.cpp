#include "engine/scene/simplify.h"

#include <fmt/format.h>

#include <algorithm>
#include <initializer_list>
#include <map>
#include <span>
#include <tuple>
#include <utility>

#include "engine/base/digest.h"
#include "engine/scene/texture_slots.h"

namespace etalon {
namespace {

bool alike(const Sampler& a, const Sampler& b)
{
    const auto parts = [](const Sampler& s) {
        return std::tuple(s.wrap_u, s.wrap_v, s.mag, s.min, s.mip, s.mipmapped);
    };
    return parts(a) == parts(b);
}

bool alike(const Texels& a, const Texels& b)
{
    return a.width == b.width && a.height == b.height && a.is_8_bit == b.is_8_bit && a.bytes == b.bytes &&
           a.wide == b.wide;
}

/// A channel of a texture and the factor that it is multiplied by, which is changed when the texture is folded into it.
struct Channel {
    int index;
    double* factor;
    bool may_be_0 = true;  ///< a factor of 0 instead of a texture of 0 changes nothing else
    bool may_be_1 = true;  ///< no texture instead of a texture of 1 changes nothing else
};

class Simplifier {
 public:
    explicit Simplifier(const PosedScene& posed) : scene_(*posed.scene) {}

    std::vector<Removal> removals;

    /// True when something went.
    bool simplify(Index index, Material& material)
    {
        material_ = index;
        const std::size_t before = removals.size();
        fold_own(material);
        if (material.layers) fold_layers(*material.layers);
        for (const TextureSlot& slot : texture_slots()) {
            TextureUse* const use = slot.of(material);
            if (use == nullptr || !use->present()) continue;
            const Index first = first_alike(use->texture);
            if (first == use->texture) continue;
            remove(slot.where, "another texture is the same");
            use->texture = first;
        }
        return removals.size() != before;
    }

 private:
    void fold_own(Material& m)
    {
        std::vector<Channel> base{{0, &m.base_color.x}, {1, &m.base_color.y}, {2, &m.base_color.z}};
        if (m.alpha_mode != AlphaMode::opaque) base.push_back({3, &m.base_color.w});
        fold(m.base_color_texture, "pbrMetallicRoughness/baseColorTexture", base);
        if (m.model == BsdfModel::metallic_roughness)
            fold(m.metallic_roughness_texture, "pbrMetallicRoughness/metallicRoughnessTexture",
                 {{1, &m.roughness}, {2, &m.metallic}});
        // In rasterizers what has a texture of emission does not light other surfaces (SH-39), whatever its texels.
        fold(m.emissive_texture, "emissiveTexture",
             {{0, &m.emission.x, true, false}, {1, &m.emission.y, true, false}, {2, &m.emission.z, true, false}});
    }

    void fold_layers(MaterialLayers& m)
    {
        const auto color = [](dvec3& factor) {
            return std::vector<Channel>{{0, &factor.x}, {1, &factor.y}, {2, &factor.z}};
        };
        fold(m.specular_texture, "extensions/KHR_materials_specular/specularTexture", {{3, &m.specular}});
        fold(m.specular_color_texture, "extensions/KHR_materials_specular/specularColorTexture",
             color(m.specular_color));
        // A factor of 0 takes the layer out of the shader, and rasterizers then round in other places; so they do
        // without textures of occlusion and of what is transmitted.
        fold(m.clearcoat_texture, "extensions/KHR_materials_clearcoat/clearcoatTexture", {{0, &m.clearcoat, false}});
        fold(m.clearcoat_roughness_texture, "extensions/KHR_materials_clearcoat/clearcoatRoughnessTexture",
             {{1, &m.clearcoat_roughness}});
        fold(m.sheen_color_texture, "extensions/KHR_materials_sheen/sheenColorTexture",
             {{0, &m.sheen_color.x, false}, {1, &m.sheen_color.y, false}, {2, &m.sheen_color.z, false}});
        fold(m.sheen_roughness_texture, "extensions/KHR_materials_sheen/sheenRoughnessTexture",
             {{3, &m.sheen_roughness}});
        fold(m.iridescence_texture, "extensions/KHR_materials_iridescence/iridescenceTexture",
             {{0, &m.iridescence, false}});
    }

    void fold(TextureUse& use, std::string_view where, const std::vector<Channel>& channels)
    {
        if (!use.present() || scene_.textures[use.texture].image == kNone) return;
        const Index image = scene_.textures[use.texture].image;
        std::vector<double> values;
        bool any_0 = false, any_1 = false;
        for (const Channel& channel : channels) {
            if (*channel.factor == 0) {
                values.push_back(0);
                continue;
            }
            const std::optional<double> value = constant(image, channel.index);
            if (!(value == 1.0 && channel.may_be_1) && !(value == 0.0 && channel.may_be_0)) return;
            (*value == 0 ? any_0 : any_1) = true;
            values.push_back(*value);
        }
        for (std::size_t i = 0; i < channels.size(); ++i) *channels[i].factor *= values[i];
        use = {};
        remove(where, any_0 && any_1 ? "every texel read is 0 or 1 by channel"
                      : any_0        ? "every texel read is 0"
                      : any_1        ? "every texel read is 1"
                                     : "its factor is 0");
    }

    void remove(std::string_view where, std::string what)
    {
        removals.push_back({fmt::format("/materials/{}/{}", material_, where), std::move(what)});
    }

    std::optional<double> constant(Index image, int channel)
    {
        const auto [known, is_new] = constants_.try_emplace({image, channel});
        if (is_new) known->second = constant_channel(scene_.images[image], channel);
        return known->second;
    }

    Index first_alike(Index texture)
    {
        const auto [known, is_new] = first_.try_emplace(texture, texture);
        if (!is_new) return known->second;
        const Texture& wanted = scene_.textures[texture];
        for (Index i = 0; i < texture; ++i)
            if (scene_.textures[i].image == wanted.image && alike(scene_.textures[i].sampler, wanted.sampler))
                return known->second = i;
        return texture;
    }

    const Scene& scene_;
    Index material_ = 0;
    std::map<std::pair<Index, int>, std::optional<double>> constants_;
    std::map<Index, Index> first_;
};

template <class Value>
std::optional<Value> constant_of(std::span<const Value> values, std::size_t channel)
{
    if (values.size() <= channel) return std::nullopt;
    const Value first = values[channel];
    for (std::size_t i = channel; i < values.size(); i += 4)
        if (values[i] != first) return std::nullopt;
    return first;
}

}  // namespace

std::optional<double> constant_channel(const Texels& image, int channel)
{
    const auto c = static_cast<std::size_t>(channel);
    if (!image.is_8_bit) return constant_of(std::span<const float>(image.wide), c);
    const auto code = constant_of(std::span<const std::uint8_t>(image.bytes), c);
    return code ? std::optional(*code / 255.0) : std::nullopt;
}

std::optional<Texels> shrunk_constant(const Texels& image)
{
    if (image.width < 1 || image.height < 1 || (image.width % 2 != 0 || image.height % 2 != 0)) return std::nullopt;
    for (int channel = 0; channel < 4; ++channel)
        if (!constant_channel(image, channel)) return std::nullopt;
    Texels out{.width = image.width, .height = image.height, .is_8_bit = image.is_8_bit, .bytes = {}, .wide = {}};
    while (out.width % 2 == 0 && out.height % 2 == 0) {
        out.width /= 2;
        out.height /= 2;
    }
    const std::size_t values = 4 * std::size_t(out.width) * std::size_t(out.height);
    if (image.is_8_bit)
        out.bytes.assign(image.bytes.begin(), image.bytes.begin() + static_cast<std::ptrdiff_t>(values));
    else
        out.wide.assign(image.wide.begin(), image.wide.begin() + static_cast<std::ptrdiff_t>(values));
    return out;
}

std::vector<Index> equal_images(const std::vector<Texels>& images)
{
    using Size = std::tuple<int, int, bool>;
    std::map<Size, std::vector<Index>> by_size;
    for (Index i = 0; i < images.size(); ++i)
        by_size[{images[i].width, images[i].height, images[i].is_8_bit}].push_back(i);
    std::vector<Index> first(images.size());
    for (const auto& [size, of_size] : by_size) {
        std::map<std::uint64_t, std::vector<Index>> by_digest;
        for (const Index i : of_size) {
            first[i] = i;
            if (of_size.size() == 1) continue;  // nothing to be mistaken for
            Digest digest;
            digest.add(std::as_bytes(std::span(images[i].bytes)));
            digest.add(std::as_bytes(std::span(images[i].wide)));
            std::vector<Index>& same = by_digest[digest.value()];
            if (!same.empty() && alike(images[same.front()], images[i]))
                first[i] = same.front();
            else
                same.push_back(i);
        }
    }
    return first;
}

void share_equal_images(Scene& scene)
{
    const std::vector<Index> first = equal_images(scene.images);
    for (Texture& texture : scene.textures)
        if (texture.image != kNone) texture.image = first[texture.image];
}

std::vector<Removal> simplify(PosedScene& posed)
{
    // A sphere has no texture coordinates: its factors alone count.
    std::vector<bool> of_sphere(posed.materials().size());
    for (const PosedSphere& sphere : posed.spheres) of_sphere[sphere.material] = true;
    Simplifier simplifier(posed);
    std::vector<std::pair<Index, Material>> changed;
    for (Index i = 0; i < posed.materials().size(); ++i) {
        if (of_sphere[i]) continue;
        Material material = posed.materials()[i];
        if (simplifier.simplify(i, material)) changed.emplace_back(i, std::move(material));
    }
    if (!changed.empty() && posed.moved_materials.empty()) posed.moved_materials = posed.scene->materials;
    for (auto& [index, material] : changed) posed.moved_materials[index] = std::move(material);
    return std::move(simplifier.removals);
}

}  // namespace etalon
