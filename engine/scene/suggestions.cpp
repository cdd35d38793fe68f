#include "engine/scene/suggestions.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstdlib>
#include <map>
#include <set>
#include <span>
#include <utility>

#include "engine/scene/animation.h"
#include "engine/scene/digest.h"
#include "engine/scene/simplify.h"
#include "engine/scene/texture_slots.h"

namespace etalon {
namespace {

/// What is said of one place and of several ({}), and the validator's code.
struct Kind {
    const char* one;
    const char* many;
    const char* code = "";
};

constexpr Kind kFlatNormals{"normal map on 1 material is flat (to 0.3 degrees)",
                            "normal map on {} materials is flat (to 0.3 degrees)"};
constexpr Kind kConstant{"1 texture has one value everywhere: its factor can say it",
                         "{} textures have one value everywhere: their factors can say it"};
constexpr Kind kNotRead{"1 texture is not read: its factor or layer is 0",
                        "{} textures are not read: their factors or layers are 0"};
constexpr Kind kRepeatedImages{"1 texture has an image of its own that another has too",
                               "{} textures have images of their own that others have too"};
constexpr Kind kRepeatedMaterials{"1 material repeats another but for its name",
                                  "{} materials repeat others but for their names"};
constexpr Kind kUnusedMaterials{"1 material is used by no mesh", "{} materials are used by no mesh", "UNUSED_OBJECT"};
constexpr Kind kUnusedMeshes{"1 mesh is used by no node", "{} meshes are used by no node", "UNUSED_OBJECT"};
constexpr Kind kSolid{"alphaMode of 1 material may be OPAQUE: its alpha is 1 everywhere",
                      "alphaMode of {} materials may be OPAQUE: their alpha is 1 everywhere"};
constexpr Kind kVolume{"volume of 1 material has no effect: nothing is transmitted",
                       "volume of {} materials has no effect: nothing is transmitted",
                       "KHR_MATERIALS_VOLUME_NO_TRANSMISSION"};
constexpr Kind kDispersion{"dispersion of 1 material has no effect without a volume",
                           "dispersion of {} materials has no effect without a volume",
                           "KHR_MATERIALS_DISPERSION_NO_VOLUME"};
constexpr Kind kFilm{"iridescence thickness of 1 material is the same whatever its texture says",
                     "iridescence thickness of {} materials is the same whatever their textures say",
                     "KHR_MATERIALS_IRIDESCENCE_THICKNESS_TEXTURE_UNUSED"};
constexpr Kind kWhiteColors{"vertex colours of 1 primitive are white", "vertex colours of {} primitives are white"};
constexpr Kind kTangents{"tangents of 1 primitive are read by no material",
                         "tangents of {} primitives are read by no material", "UNUSED_MESH_TANGENT"};
constexpr Kind kTexcoords{"1 set of texture coordinates is read by no texture",
                          "{} sets of texture coordinates are read by no texture", "MESH_PRIMITIVE_UNUSED_TEXCOORD"};
constexpr Kind kTargets{"1 morph target moves nothing", "{} morph targets move nothing"};
constexpr Kind kChannels{"1 animation channel moves nothing", "{} animation channels move nothing"};

std::uint64_t bytes_of(const Texels& image)
{
    return std::uint64_t(image.width) * std::uint64_t(image.height) * (image.is_8_bit ? 4 : 16) * 4 / 3;
}

/// The vector of every texel is within 0.3 degrees of the surface's own normal: 128 128 255, the nearest that 8 bits
/// come to it, give or take one. That is not the same to the bit.
bool is_flat(const Texels& image)
{
    if (!image.is_8_bit || image.bytes.empty()) return false;
    for (std::size_t i = 0; i + 3 < image.bytes.size(); i += 4)
        if (std::abs(2 * image.bytes[i] - 255) > 1 || std::abs(2 * image.bytes[i + 1] - 255) > 1 ||
            image.bytes[i + 2] < 254)
            return false;
    return true;
}

bool is_constant(const Texels& image)
{
    for (int channel = 0; channel < 4; ++channel)
        if (!constant_channel(image, channel)) return false;
    return true;
}

bool is_zero(const std::vector<vec3>& offsets)
{
    return std::all_of(offsets.begin(), offsets.end(), [](const vec3& v) { return v == vec3(0); });
}

class Reader {
 public:
    explicit Reader(const Scene& scene) : scene_(scene)
    {
        count_uses();
        images();
        for (Index i = 0; i < scene_.materials.size(); ++i) material(i);
        repeated_materials();
        unused();
        for (Index m = 0; m < scene_.meshes.size(); ++m)
            for (Index p = 0; p < scene_.meshes[m].primitives.size(); ++p) primitive(m, p);
        for (Index a = 0; a < scene_.animations.size(); ++a) animation(a);
    }

    std::vector<Suggestion> result()
    {
        std::vector<Suggestion> out;
        for (const auto& [kind, found] : found_) {
            Suggestion one{.what = found.pointers.size() == 1
                                       ? std::string(kind->one)
                                       : fmt::format(fmt::runtime(kind->many), found.pointers.size()),
                           .pointers = found.pointers,
                           .bytes = found.bytes,
                           .code = kind->code};
            // An image goes when all its uses do.
            for (const auto& [image, slots] : found.slots)
                if (slots == slots_of_image_[image]) one.bytes += bytes_of(scene_.images[image]);
            out.push_back(std::move(one));
        }
        std::stable_sort(out.begin(), out.end(),
                         [](const Suggestion& a, const Suggestion& b) { return a.bytes > b.bytes; });
        return out;
    }

 private:
    struct Found {
        std::vector<std::string> pointers;
        std::uint64_t bytes = 0;
        std::map<Index, std::size_t> slots;  // of images, that would go
    };

    Found& say(const Kind& kind, std::string pointer)
    {
        const auto known = std::find_if(found_.begin(), found_.end(), [&](const auto& f) { return f.first == &kind; });
        Found& found = known != found_.end() ? known->second : found_.emplace_back(&kind, Found{}).second;
        found.pointers.push_back(std::move(pointer));
        return found;
    }

    void say_slot(const Kind& kind, Index material, const TextureSlot& slot)
    {
        Found& found = say(kind, fmt::format("/materials/{}/{}", material, slot.where));
        ++found.slots[image_of(*slot.of(scene_.materials[material]))];
    }

    Index image_of(const TextureUse& use) const { return scene_.textures[use.texture].image; }

    void count_uses()
    {
        slots_of_image_.resize(scene_.images.size());
        for (const Material& material : scene_.materials)
            for (const TextureSlot& slot : texture_slots()) {
                const TextureUse* const use = slot.of(material);
                if (use == nullptr || !use->present()) continue;
                if (image_of(*use) != kNone) ++slots_of_image_[image_of(*use)];
            }
        solid_colors_.assign(scene_.materials.size(), true);
        material_used_.resize(scene_.materials.size());
        for (const Mesh& mesh : scene_.meshes)
            for (const Primitive& p : mesh.primitives) {
                material_used_[p.material] = true;
                if (std::any_of(p.colors.begin(), p.colors.end(), [](const vec4& c) { return c.w != 1; }))
                    solid_colors_[p.material] = false;
            }
        for (const Node& node : scene_.nodes)
            if (node.sphere) material_used_[node.sphere->material] = true;
        for (const Animation& animation : scene_.animations)
            for (const AnimationChannel& channel : animation.channels) {
                ++moved_[{channel.property, channel.object}];
                if (animated_properties()[channel.property].pointer.starts_with("/materials/"))
                    moved_materials_.insert(channel.object);
            }
    }

    /// Images that no texture reads are those whose textures read an equal one instead (share_equal_images).
    void images()
    {
        const std::vector<Index> first = equal_images(scene_.images);
        std::map<Index, std::uint64_t> repeated;
        for (Index i = 0; i < scene_.images.size(); ++i)
            if (first[i] != i) repeated[first[i]] += bytes_of(scene_.images[i]);
        std::map<Index, Index> texture_of;  // the first of each image
        for (Index m = 0; m < scene_.materials.size(); ++m)
            for (const TextureSlot& slot : texture_slots()) {
                const TextureUse* const use = slot.of(scene_.materials[m]);
                if (use == nullptr || !use->present() || !repeated.contains(image_of(*use))) continue;
                const Index image = image_of(*use);
                const auto [known, is_new] = texture_of.try_emplace(image, use->texture);
                if (is_new || known->second == use->texture) continue;
                say(kRepeatedImages, fmt::format("/materials/{}/{}", m, slot.where)).bytes +=
                    std::exchange(repeated[image], 0);
            }
    }

    void material(Index index)
    {
        if (moved_materials_.contains(index)) return;
        const Material& m = scene_.materials[index];
        for (const TextureSlot& slot : texture_slots()) {
            const TextureUse* const use = slot.of(m);
            if (use == nullptr || !use->present() || image_of(*use) == kNone) continue;
            const Texels& image = scene_.images[image_of(*use)];
            const bool bends = use == &m.normal_texture || (m.layers && use == &m.layers->clearcoat_normal_texture);
            if (!is_read(m, *use))
                say_slot(kNotRead, index, slot);
            else if (bends && is_flat(image))
                say_slot(kFlatNormals, index, slot);
            else if (!bends && is_constant(image))
                say_slot(kConstant, index, slot);
        }
        if (m.alpha_mode != AlphaMode::opaque && is_solid(index))
            say(kSolid, fmt::format("/materials/{}/alphaMode", index));
        if (m.layers) layers(index, *m.layers);
    }

    void layers(Index index, const MaterialLayers& m)
    {
        const auto extension = [&](const char* name) {
            return fmt::format("/materials/{}/extensions/{}", index, name);
        };
        if (m.thickness > 0 && m.transmission == 0 && m.diffuse_transmission == 0)
            say(kVolume, extension("KHR_materials_volume"));
        if (m.dispersion > 0 && m.thickness == 0) say(kDispersion, extension("KHR_materials_dispersion"));
        if (m.iridescence_thickness_texture.present() && m.iridescence_thickness_min == m.iridescence_thickness_max)
            say(kFilm, extension("KHR_materials_iridescence/iridescenceThicknessTexture"));
    }

    /// Is this texture of the material multiplied by anything but 0?
    static bool is_read(const Material& m, const TextureUse& use)
    {
        if (&use == &m.emissive_texture) return m.emission != dvec3(0);
        if (&use == &m.occlusion_texture) return m.occlusion_strength != 0;
        if (!m.layers) return true;
        const MaterialLayers& l = *m.layers;
        const auto one_of = [&](std::initializer_list<const TextureUse*> uses) {
            return std::find(uses.begin(), uses.end(), &use) != uses.end();
        };
        if (one_of({&l.clearcoat_texture, &l.clearcoat_roughness_texture, &l.clearcoat_normal_texture}))
            return l.clearcoat > 0;
        if (one_of({&l.sheen_color_texture, &l.sheen_roughness_texture})) return l.sheen_color != dvec3(0);
        if (&use == &l.transmission_texture) return l.transmission > 0;
        if (&use == &l.thickness_texture) return l.volumetric();
        if (one_of({&l.iridescence_texture, &l.iridescence_thickness_texture})) return l.iridescence > 0;
        if (&use == &l.anisotropy_texture) return l.anisotropy != 0;
        if (one_of({&l.diffuse_transmission_texture, &l.diffuse_transmission_color_texture}))
            return l.diffuse_transmission > 0;
        return true;
    }

    bool is_solid(Index index) const
    {
        const Material& m = scene_.materials[index];
        if (!solid_colors_[index] || m.base_color.w != 1) return false;
        if (m.alpha_mode == AlphaMode::mask && m.alpha_cutoff > 1) return false;
        if (!m.base_color_texture.present() || image_of(m.base_color_texture) == kNone) return true;
        return constant_channel(scene_.images[image_of(m.base_color_texture)], 3) == 1.0;
    }

    void repeated_materials()
    {
        std::map<std::uint64_t, Index> first;
        for (Index i = 0; i < scene_.materials.size(); ++i) {
            if (moved_materials_.contains(i) || !material_used_[i]) continue;
            const auto [known, is_new] = first.try_emplace(digest(scene_.materials[i]).value(), i);
            if (!is_new) say(kRepeatedMaterials, fmt::format("/materials/{} repeats /materials/{}", i, known->second));
        }
    }

    void unused()
    {
        // The materials of other variants are used when those are chosen.
        for (Index i = 0; scene_.variants.empty() && i < scene_.materials.size(); ++i)
            if (!material_used_[i]) say(kUnusedMaterials, fmt::format("/materials/{}", i));
        std::vector<bool> used(scene_.meshes.size());
        for (const Node& node : scene_.nodes)
            if (node.mesh != kNone) used[node.mesh] = true;
        for (Index i = 0; i < scene_.meshes.size(); ++i)
            if (!used[i]) say(kUnusedMeshes, fmt::format("/meshes/{}", i));
    }

    void primitive(Index mesh, Index index)
    {
        const Primitive& p = scene_.meshes[mesh].primitives[index];
        const std::string where = fmt::format("/meshes/{}/primitives/{}", mesh, index);
        if (!p.colors.empty() &&
            std::all_of(p.colors.begin(), p.colors.end(), [](const vec4& c) { return c == vec4(1); }))
            say(kWhiteColors, where + "/attributes/COLOR_0").bytes += p.colors.size() * sizeof(vec4);
        for (Index t = 0; t < p.targets.size(); ++t) {
            const MorphTarget& target = p.targets[t];
            if (!is_zero(target.positions) || !is_zero(target.normals) || !is_zero(target.tangents)) continue;
            say(kTargets, fmt::format("{}/targets/{}", where, t)).bytes +=
                (target.positions.size() + target.normals.size() + target.tangents.size()) * sizeof(vec3);
        }
        // Another variant may read what this one does not.
        if (!scene_.variants.empty() || moved_materials_.contains(p.material)) return;
        const Material& m = scene_.materials[p.material];
        const bool reads_tangents =
            m.normal_texture.present() ||
            (m.layers && (m.layers->clearcoat_normal_texture.present() || m.layers->anisotropy != 0));
        if (!p.tangents.empty() && !p.tangents_from_uv && !reads_tangents)
            say(kTangents, where + "/attributes/TANGENT").bytes += p.tangents.size() * sizeof(vec4);
        for (std::size_t set = 0; set < p.uv.size(); ++set)
            if (!p.uv[set].empty() && !reads_set(m, static_cast<int>(set)))
                say(kTexcoords, fmt::format("{}/attributes/TEXCOORD_{}", where, set)).bytes +=
                    p.uv[set].size() * sizeof(vec2);
    }

    static bool reads_set(const Material& material, int set)
    {
        return std::any_of(texture_slots().begin(), texture_slots().end(), [&](const TextureSlot& slot) {
            const TextureUse* const use = slot.of(material);
            return use != nullptr && use->present() && use->uv_set == set;
        });
    }

    void animation(Index index)
    {
        const Animation& animation = scene_.animations[index];
        for (Index c = 0; c < animation.channels.size(); ++c)
            if (const AnimationChannel& channel = animation.channels[c]; moves_nothing(animation, channel))
                say(kChannels, fmt::format("/animations/{}, of {}", index,
                                           fmt::format(fmt::runtime(animated_properties()[channel.property].pointer),
                                                       channel.object)));
    }

    /// One value at all times, and that of the rest pose; nor does it undo what another animation does.
    bool moves_nothing(const Animation& animation, const AnimationChannel& channel) const
    {
        const auto moved = moved_.find({channel.property, channel.object});
        if (moved == moved_.end() || moved->second > 1) return false;
        const AnimationSampler& sampler = animation.samplers[channel.sampler];
        const AnimatedProperty& property = animated_properties()[channel.property];
        const bool cubic = sampler.interpolation == Interpolation::cubic;
        const std::size_t width = sampler.width, key = cubic ? 3 * width : width;
        if (width == 0 || sampler.values.size() % key != 0) return false;
        for (std::size_t i = 0; i < sampler.values.size(); ++i) {
            const bool tangent = cubic && (i % key < width || i % key >= 2 * width);
            const double expected = tangent ? 0 : sampler.values[(cubic ? width : 0) + i % width];
            if (sampler.values[i] != expected) return false;
        }
        Motion motion;
        const std::vector<double> value = sample(sampler, sampler.times.front(), property.is_rotation);
        property.set(scene_, channel.object, value, motion);
        return is_rest(motion);
    }

    bool is_rest(const Motion& motion) const
    {
        if (!motion.mesh_weights.empty() || !motion.visible.empty() || !motion.materials.empty() ||
            !motion.lights.empty() || !motion.cameras.empty())
            return false;
        for (const auto& [node, trs] : motion.nodes) {
            const std::optional<Trs>& rest = scene_.nodes[node].trs;
            if (!rest || rest->translation != trs.translation || rest->rotation != trs.rotation ||
                rest->scale != trs.scale)
                return false;
        }
        for (const auto& [node, weights] : motion.weights) {
            const Node& at = scene_.nodes[node];
            if (weights != at.weights &&
                !(at.weights.empty() && at.mesh != kNone && weights == scene_.meshes[at.mesh].weights))
                return false;
        }
        return true;
    }

    const Scene& scene_;
    std::vector<std::pair<const Kind*, Found>> found_;
    std::vector<std::size_t> slots_of_image_;
    std::vector<bool> material_used_, solid_colors_;
    std::set<Index> moved_materials_;
    std::map<std::pair<Index, Index>, std::size_t> moved_;  // by property and object: channels of all animations
};

}  // namespace

std::vector<Suggestion> suggest(const Scene& scene)
{
    return Reader(scene).result();
}

}  // namespace etalon
