#include "engine/scene/gltf_texture.h"

#include <fmt/format.h>

#include <cmath>
#include <limits>

#include "engine/base/parallel.h"
#include "engine/image/io.h"
#include "engine/scene/resources.h"

namespace etalon::gltf {

namespace {

constexpr double kHuge = std::numeric_limits<float>::max();

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

// Why a texture without a source of its own shows nothing.
std::string why_unread(const tinygltf::Texture& texture)
{
    struct Row {
        const char* extension;
        const char* format;
    };
    for (const Row& row :
         {Row{"KHR_texture_basisu", "KTX 2"}, Row{"EXT_texture_avif", "AVIF"}, Row{"MSFT_texture_dds", "DDS"}})
        if (member(texture.extensions, row.extension) != nullptr)
            return fmt::format("it has only a {} image ({}), which Etalon does not read", row.format, row.extension);
    return "no image in a format that is read";
}

}  // namespace

Textures::Textures(const Source& source, Scene& scene)
    : source_(source),
      scene_(scene),
      texture_of_(source.model.textures.size(), kNone),
      image_of_(source.file.images.size(), kNone)
{}

TextureUse Textures::use(const Value& extension, const std::string& key, const std::string& pointer)
{
    const Value* info = member(extension, key);
    if (info == nullptr) return {};
    const std::string at = pointer + "/" + key;
    const double index = number(*info, "index", at, -1, 0, 1e9);
    if (index < 0) throw fault(at, "index is missing [UNDEFINED_PROPERTY]");
    const Value* extensions = member(*info, "extensions");
    return use(static_cast<std::size_t>(index), static_cast<int>(number(*info, "texCoord", at, 0, 0, 1e6)),
               extensions == nullptr ? nullptr : member(*extensions, "KHR_texture_transform"), at);
}

TextureUse Textures::use(std::size_t index, int uv_set, const Value* transform, const std::string& pointer)
{
    TextureUse out;
    if (transform != nullptr) {
        const std::string at = pointer + "/extensions/KHR_texture_transform";
        out.transform = texture_transform(*transform, at);
        uv_set = static_cast<int>(number(*transform, "texCoord", at, uv_set, 0, 1e6));
    }
    if (uv_set < 0 || uv_set > 1) {
        scene_.warnings.push_back(fmt::format(
            "{}: texture coordinates of set {} are not read (0 and 1 are): the texture is ignored", pointer, uv_set));
        return {};
    }
    out.uv_set = uv_set;
    out.texture = texture(index);
    return out;
}

Index Textures::texture(std::size_t index)
{
    if (texture_of_.at(index) != kNone) return texture_of_[index];
    const tinygltf::Texture& in = source_.model.textures[index];
    const std::string pointer = fmt::format("/textures/{}", index);
    int source = in.source;
    if (const Value* webp = member(in.extensions, "EXT_texture_webp"))
        source = static_cast<int>(number(*webp, "source", pointer + "/extensions/EXT_texture_webp", source, 0, 1e9));
    if (source < 0) {
        scene_.warnings.push_back(fmt::format("{}: {}: the texture is ignored", pointer, why_unread(in)));
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

Index Textures::image(std::size_t index)
{
    if (image_of_.at(index) == kNone) {
        image_of_[index] = static_cast<Index>(used_images_.size());
        used_images_.push_back(index);
    }
    return image_of_[index];
}

void Textures::decode_images()
{
    scene_.images.resize(used_images_.size());
    parallel_for(used_images_.size(), [&](std::size_t i) {
        const GltfImage& in = source_.file.images[used_images_[i]];
        try {
            if (in.bytes && in.bytes->empty())
                throw Error(Blame::input, "its buffer has no data in this file [BUFFER_MISSING_GLB_DATA]");
            const Limits& limits = source_.limits;
            scene_.images[i] =
                in.bytes ? decode_texels(*in.bytes, in.name, limits)
                         : decode_texels(read_uri(in.source(), source_.folder, limits.resource_bytes), in.name, limits);
        } catch (Error& error) {
            throw error.at(fmt::format("/images/{}", used_images_[i]));
        }
    });
}

}  // namespace etalon::gltf
