#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <limits>

#include "engine/scene/gltf_import.h"
#include "engine/scene/gltf_layers.h"
#include "engine/scene/gltf_texture.h"

namespace etalon::gltf {

namespace {

constexpr double kHuge = std::numeric_limits<float>::max();

class Materials {
 public:
    Materials(const Source& source, Scene& scene)
        : source_(source), scene_(scene), textures_(source, scene), animated_(source.model.materials.size())
    {
        find_animated();
        for (std::size_t i = 0; i < source_.model.materials.size(); ++i) convert(i);
        textures_.decode_images();
    }

 private:
    void convert(std::size_t index)
    {
        const tinygltf::Material& in = source_.model.materials[index];
        const std::string pointer = fmt::format("/materials/{}", index);
        Material out;
        out.name = in.name;
        out.double_sided = in.doubleSided;
        out.emission = emission(in.emissiveFactor, pointer + "/emissiveFactor");
        alpha(in, pointer, out);
        out.normal_scale = in.normalTexture.scale;
        out.occlusion_strength = in.occlusionTexture.index < 0
                                     ? 1
                                     : unit(in.occlusionTexture.strength, pointer + "/occlusionTexture/strength");
        emission_and_unlit(in, pointer, out);
        const bool lit = out.model != BsdfModel::unlit;
        if (!lit || !apply_specular_glossiness(in, pointer, textures_, scene_, out))
            metallic_roughness(in.pbrMetallicRoughness, pointer + "/pbrMetallicRoughness", out);
        const bool animated = animated_[index];
        // An unlit or non-emissive material decodes no texture that it does not show.
        if (lit) {
            out.normal_texture = textures_.use(in.normalTexture, pointer + "/normalTexture");
            out.occlusion_texture = textures_.use(in.occlusionTexture, pointer + "/occlusionTexture");
            if (out.emission != dvec3(0) || animated)
                out.emissive_texture = textures_.use(in.emissiveTexture, pointer + "/emissiveTexture");
        }
        apply_material_extras(in.extras, pointer, out);
        if (out.model == BsdfModel::metallic_roughness)
            out.layers = read_layers(in, pointer, out, animated, textures_, scene_);
        else if (out.model == BsdfModel::unlit || out.model == BsdfModel::specular_glossiness)
            warn_of_excluded_layers(in, pointer, scene_);
        scene_.materials.push_back(std::move(out));
    }

    // Notes the materials in which some channel of KHR_animation_pointer moves something.
    void find_animated()
    {
        constexpr std::string_view kMaterials = "/materials/";
        for (const tinygltf::Animation& animation : source_.model.animations)
            for (const tinygltf::AnimationChannel& channel : animation.channels) {
                const Value* extension = member(channel.target_extensions, "KHR_animation_pointer");
                const Value* text = extension == nullptr ? nullptr : member(*extension, "pointer");
                if (text == nullptr || !text->IsString()) continue;
                const auto& pointer = text->Get<std::string>();
                if (!pointer.starts_with(kMaterials)) continue;
                std::size_t index = animated_.size();
                std::from_chars(pointer.data() + kMaterials.size(), pointer.data() + pointer.size(), index);
                if (index < animated_.size()) animated_[index] = true;
            }
    }

    void metallic_roughness(const tinygltf::PbrMetallicRoughness& in, const std::string& pointer, Material& out)
    {
        for (int c = 0; c < 4; ++c)
            out.base_color[c] = unit(in.baseColorFactor.at(static_cast<std::size_t>(c)), pointer + "/baseColorFactor");
        out.metallic = unit(in.metallicFactor, pointer + "/metallicFactor");
        out.roughness = unit(in.roughnessFactor, pointer + "/roughnessFactor");
        out.base_color_texture = textures_.use(in.baseColorTexture, pointer + "/baseColorTexture");
        if (out.model != BsdfModel::unlit)
            out.metallic_roughness_texture =
                textures_.use(in.metallicRoughnessTexture, pointer + "/metallicRoughnessTexture");
    }

    // Factors are within [0, 1]; what is outside is drawn clamped, as other readers do, and said.
    double unit(double value, const std::string& pointer)
    {
        const double clamped = std::min(std::max(value, 0.0), 1.0);
        if (clamped != value)
            scene_.warnings.push_back(
                fmt::format("{}: {} is taken as {} [VALUE_NOT_IN_RANGE]", pointer, value, clamped));
        return clamped;
    }

    // Exporters write emission above 1 here, which KHR_materials_emissive_strength would say: it is meant, so it is
    // kept.
    dvec3 emission(const std::vector<double>& values, const std::string& pointer)
    {
        if (values.empty()) return dvec3(0);
        if (values.size() != 3) throw fault(pointer, "not three numbers [ARRAY_LENGTH_NOT_IN_LIST]");
        const dvec3 out(values[0], values[1], values[2]);
        for (const double value : values)
            if (!(value >= 0 && value <= kHuge)) throw fault(pointer, fmt::format("{} [VALUE_NOT_IN_RANGE]", value));
        if (std::max({out.x, out.y, out.z}) > 1)
            scene_.warnings.push_back(pointer + ": above 1, and taken as it is [VALUE_NOT_IN_RANGE]");
        return out;
    }

    static void alpha(const tinygltf::Material& in, const std::string& pointer, Material& out)
    {
        if (in.alphaMode == "MASK")
            out.alpha_mode = AlphaMode::mask;
        else if (in.alphaMode == "BLEND")
            out.alpha_mode = AlphaMode::blend;
        else if (in.alphaMode != "OPAQUE")
            throw fault(pointer + "/alphaMode", fmt::format("\"{}\" [VALUE_NOT_IN_LIST]", in.alphaMode),
                        "OPAQUE, MASK or BLEND");
        if (!(in.alphaCutoff >= 0) || in.alphaCutoff > kHuge)
            throw fault(pointer + "/alphaCutoff", fmt::format("{} is below 0 [VALUE_NOT_IN_RANGE]", in.alphaCutoff));
        out.alpha_cutoff = in.alphaCutoff;
    }

    static void emission_and_unlit(const tinygltf::Material& in, const std::string& pointer, Material& out)
    {
        if (const Value* strength = member(in.extensions, "KHR_materials_emissive_strength"))
            out.emission = out.emission * number(*strength, "emissiveStrength",
                                                 pointer + "/extensions/KHR_materials_emissive_strength", 1, 0, kHuge);
        if (member(in.extensions, "KHR_materials_unlit") != nullptr) {
            out.model = BsdfModel::unlit;
            out.emission = dvec3(0);  // the extension shows the base colour alone
        }
    }

    const Source& source_;
    Scene& scene_;
    Textures textures_;
    std::vector<bool> animated_;  // of each material
};

}  // namespace

void import_materials(const Source& source, Scene& scene)
{
    Materials(source, scene);
}

}  // namespace etalon::gltf
