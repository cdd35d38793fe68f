#include "engine/render/path_textures.h"

#include <cstring>
#include <map>

#include "engine/base/error.h"
#include "shaders/shared/path.h"

namespace etalon {
namespace {

std::uint32_t code(Wrap wrap)
{
    switch (wrap) {
        case Wrap::repeat:
            return 0;
        case Wrap::mirrored_repeat:
            return 1;
        case Wrap::clamp_to_edge:
            return 2;
    }
    return 0;
}

/// Appends the image's texels; returns the index of the first.
std::uint32_t add_image(PathTextures& out, const Texels& image)
{
    const std::size_t count = std::size_t(image.width) * std::size_t(image.height);
    const std::size_t first = image.is_8_bit ? out.texels_8.size() : out.texels_wide.size();
    if (first + count > 0x7fffffffu || image.width > 0xffff || image.height > 0xffff)
        throw Error(Blame::machine, "the textures have more texels than one list can hold", "use smaller textures");
    if (image.is_8_bit) {
        out.texels_8.resize(first + count);
        std::memcpy(&out.texels_8[first], image.bytes.data(), 4 * count);
    } else {
        out.texels_wide.resize(first + count);
        std::memcpy(&out.texels_wide[first], image.wide.data(), sizeof(vec4) * count);
    }
    return static_cast<std::uint32_t>(first);
}

}  // namespace

PathTextures make_path_textures(const Scene& scene, const Requirements& required)
{
    PathTextures out;
    out.texels_8.push_back(0xffffffffu);
    const uvec4 white(0u, 1u | 1u << 16, 0u, 0u);
    std::map<Index, std::uint32_t> first_texel;
    for (std::size_t i = 0; i < scene.textures.size(); ++i) {
        const Texture& texture = scene.textures[i];
        const bool usable = required.texture_used[i] && texture.image != kNone &&
                            scene.images[texture.image].width > 0 && scene.images[texture.image].height > 0;
        if (!usable) {
            out.table.push_back(white);
            continue;
        }
        const Texels& image = scene.images[texture.image];
        const auto known = first_texel.find(texture.image);
        const std::uint32_t first = known != first_texel.end() ? known->second : add_image(out, image);
        first_texel[texture.image] = first;
        std::uint32_t flags = code(texture.sampler.wrap_u) | code(texture.sampler.wrap_v) << shared::kTextureWrapVShift;
        if (texture.sampler.mag == Filter::nearest) flags |= shared::kTextureNearest;
        if (!image.is_8_bit) flags |= shared::kTextureWide;
        out.table.emplace_back(first, std::uint32_t(image.width) | std::uint32_t(image.height) << 16, flags, 0u);
    }
    return out;
}

}  // namespace etalon
