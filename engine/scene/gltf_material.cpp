#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "engine/base/parallel.h"
#include "engine/image/io.h"
#include "engine/scene/gltf_import.h"
#include "engine/scene/resources.h"

namespace etalon::gltf {

namespace {

constexpr double kHuge = std::numeric_limits<float>::max();
constexpr std::size_t kMaxImageBytes = std::size_t{1} << 30;  // of one coded image

Wrap wrap_of(int value, const std::string& pointer)
{
    switch (value) {
        case TINYGLTF_TEXTURE_WRAP_REPEAT:
            return Wrap::repeat;
        case TINYGLTF_TEXTURE_WRAP_MIRRORED_REPEAT:
            return Wrap::mirrored_repeat;
        case TINYGLTF_TEXTURE_WRAP_CLAMP_TO_EDGE:
            return Wrap::clamp_to_edge;
        default:
            throw fault(pointer, fmt::format("wrap mode {} [VALUE_NOT_IN_LIST]", value));
    }
}

Sampler sampler_of(const tinygltf::Sampler& in, const std::string& pointer)
{
    Sampler out;
    out.wrap_u = wrap_of(in.wrapS, pointer + "/wrapS");
    out.wrap_v = wrap_of(in.wrapT, pointer + "/wrapT");
    switch (in.magFilter) {
        case -1:
        case TINYGLTF_TEXTURE_FILTER_LINEAR:
            break;
        case TINYGLTF_TEXTURE_FILTER_NEAREST:
            out.mag = Filter::nearest;
            break;
        default:
            throw fault(pointer + "/magFilter", fmt::format("filter {} [VALUE_NOT_IN_LIST]", in.magFilter));
    }
    const auto set = [&](Filter min, Filter mip, bool mipmapped) {
        out.min = min;
        out.mip = mip;
        out.mipmapped = mipmapped;
    };
    switch (in.minFilter) {
        case -1:
        case TINYGLTF_TEXTURE_FILTER_LINEAR_MIPMAP_LINEAR:
            break;
        case TINYGLTF_TEXTURE_FILTER_NEAREST:
            set(Filter::nearest, Filter::nearest, false);
            break;
        case TINYGLTF_TEXTURE_FILTER_LINEAR:
            set(Filter::linear, Filter::nearest, false);
            break;
        case TINYGLTF_TEXTURE_FILTER_NEAREST_MIPMAP_NEAREST:
            set(Filter::nearest, Filter::nearest, true);
            break;
        case TINYGLTF_TEXTURE_FILTER_LINEAR_MIPMAP_NEAREST:
            set(Filter::linear, Filter::nearest, true);
            break;
        case TINYGLTF_TEXTURE_FILTER_NEAREST_MIPMAP_LINEAR:
            set(Filter::nearest, Filter::linear, true);
            break;
        default:
            throw fault(pointer + "/minFilter", fmt::format("filter {} [VALUE_NOT_IN_LIST]", in.minFilter));
    }
    return out;
}

// uv' = T · R · S · uv (KHR_texture_transform). v grows downwards, so a turn that looks counter-clockwise takes u to
// -v: the Khronos TextureTransformTest points at its green marks with this sign alone.
dmat3 texture_transform(const Value& extension, const std::string& pointer)
{
    const auto pair = [&](const char* key, double standard) {
        const Value* found = member(extension, key);
        if (found == nullptr) return dvec2(standard);
        dvec2 out(std::numeric_limits<double>::quiet_NaN());
        for (int i = 0; i < 2; ++i)
            if (found->IsArray() && found->ArrayLen() == 2 && found->Get(i).IsNumber())
                out[i] = found->Get(i).GetNumberAsDouble();
        if (!std::isfinite(out.x) || !std::isfinite(out.y))
            throw fault(pointer + "/" + key, "not two numbers [TYPE_MISMATCH]");
        return out;
    };
    const dvec2 offset = pair("offset", 0);
    const dvec2 scale = pair("scale", 1);
    const double angle = number(extension, "rotation", pointer, 0, -kHuge, kHuge);
    const double c = std::cos(angle);
    const double s = std::sin(angle);
    return dmat3(dvec3(c * scale.x, -s * scale.x, 0), dvec3(s * scale.y, c * scale.y, 0), dvec3(offset, 1));
}

class Materials {
 public:
    Materials(const Source& source, Scene& scene)
        : source_(source),
          scene_(scene),
          texture_of_(source.model.textures.size(), kNone),
          image_of_(source.file.images.size(), kNone)
    {
        for (std::size_t i = 0; i < source_.model.materials.size(); ++i) convert(i);
        decode_images();
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
        const auto& pbr = in.pbrMetallicRoughness;
        const std::string at = pointer + "/pbrMetallicRoughness";
        for (int c = 0; c < 4; ++c)
            out.base_color[c] = unit(pbr.baseColorFactor.at(static_cast<std::size_t>(c)), at + "/baseColorFactor");
        out.metallic = unit(pbr.metallicFactor, at + "/metallicFactor");
        out.roughness = unit(pbr.roughnessFactor, at + "/roughnessFactor");
        out.normal_scale = in.normalTexture.scale;
        out.occlusion_strength = in.occlusionTexture.index < 0
                                     ? 1
                                     : unit(in.occlusionTexture.strength, pointer + "/occlusionTexture/strength");
        extensions(in, pointer, out);
        // Each texture after the extensions: an unlit or non-emissive material decodes no texture that it does not
        // show.
        const bool lit = out.model != BsdfModel::unlit;
        out.base_color_texture = use(pbr.baseColorTexture, at + "/baseColorTexture");
        if (lit) {
            out.metallic_roughness_texture = use(pbr.metallicRoughnessTexture, at + "/metallicRoughnessTexture");
            out.normal_texture = use(in.normalTexture, pointer + "/normalTexture");
            out.occlusion_texture = use(in.occlusionTexture, pointer + "/occlusionTexture");
            if (out.emission != dvec3(0)) out.emissive_texture = use(in.emissiveTexture, pointer + "/emissiveTexture");
        }
        apply_material_extras(in.extras, pointer, out);
        scene_.materials.push_back(std::move(out));
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

    static void extensions(const tinygltf::Material& in, const std::string& pointer, Material& out)
    {
        if (const Value* strength = member(in.extensions, "KHR_materials_emissive_strength"))
            out.emission = out.emission * number(*strength, "emissiveStrength",
                                                 pointer + "/extensions/KHR_materials_emissive_strength", 1, 0, kHuge);
        if (member(in.extensions, "KHR_materials_unlit") != nullptr) {
            out.model = BsdfModel::unlit;
            out.emission = dvec3(0);  // the extension shows the base colour alone
        }
    }

    template <typename TextureInfo>
    TextureUse use(const TextureInfo& info, const std::string& pointer)
    {
        TextureUse out;
        if (info.index < 0) return out;
        int set = info.texCoord;
        if (const Value* transform = member(info.extensions, "KHR_texture_transform")) {
            const std::string at = pointer + "/extensions/KHR_texture_transform";
            out.transform = texture_transform(*transform, at);
            set = static_cast<int>(number(*transform, "texCoord", at, set, 0, 1e6));
        }
        if (set < 0 || set > 1) {
            scene_.warnings.push_back(fmt::format(
                "{}: texture coordinates of set {} are not read (0 and 1 are): the texture is ignored", pointer, set));
            return {};
        }
        out.uv_set = set;
        out.texture = texture(static_cast<std::size_t>(info.index));
        return out;
    }

    Index texture(std::size_t index)
    {
        if (texture_of_.at(index) != kNone) return texture_of_[index];
        const tinygltf::Texture& in = source_.model.textures[index];
        const std::string pointer = fmt::format("/textures/{}", index);
        int source = in.source;
        if (const Value* webp = member(in.extensions, "EXT_texture_webp"))
            source =
                static_cast<int>(number(*webp, "source", pointer + "/extensions/EXT_texture_webp", source, 0, 1e9));
        if (source < 0) {
            scene_.warnings.push_back(pointer + ": no image in a format that is read: the texture is ignored");
            return kNone;
        }
        Texture out;
        out.name = in.name.empty() ? source_.file.images.at(static_cast<std::size_t>(source)).name : in.name;
        out.image = image(static_cast<std::size_t>(source));
        if (in.sampler >= 0)
            out.sampler = sampler_of(source_.model.samplers.at(static_cast<std::size_t>(in.sampler)),
                                     fmt::format("/samplers/{}", in.sampler));
        scene_.textures.push_back(std::move(out));
        return texture_of_[index] = static_cast<Index>(scene_.textures.size() - 1);
    }

    Index image(std::size_t index)
    {
        if (image_of_.at(index) == kNone) {
            image_of_[index] = static_cast<Index>(used_images_.size());
            used_images_.push_back(index);
        }
        return image_of_[index];
    }

    void decode_images()
    {
        scene_.images.resize(used_images_.size());
        parallel_for(used_images_.size(), [&](std::size_t i) {
            const GltfImage& in = source_.file.images[used_images_[i]];
            try {
                if (in.bytes && in.bytes->empty())
                    throw Error(Blame::input, "its buffer has no data in this file [BUFFER_MISSING_GLB_DATA]");
                scene_.images[i] = in.bytes ? decode_texels(*in.bytes, in.name)
                                            : decode_texels(read_uri(in.uri, source_.folder, kMaxImageBytes), in.name);
            } catch (Error& error) {
                throw error.at(fmt::format("/images/{}", used_images_[i]));
            }
        });
    }

    const Source& source_;
    Scene& scene_;
    std::vector<Index> texture_of_;         // of each glTF texture: which of ours
    std::vector<Index> image_of_;           // of each glTF image
    std::vector<std::size_t> used_images_;  // of each of our images: which of glTF's
};

}  // namespace

void import_materials(const Source& source, Scene& scene)
{
    Materials(source, scene);
}

}  // namespace etalon::gltf
