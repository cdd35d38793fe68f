#include "engine/render/path_textures.h"

#include <cstring>
#include <map>
#include <optional>

#include "engine/base/error.h"
#include "engine/scene/simplify.h"
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

struct StoredImage {
    std::uint32_t first = 0;  ///< texel
    int width = 0;
    int height = 0;
    bool is_8_bit = true;
};

/// Appends the image's texels.
StoredImage add_image(PathTextures& out, const Texels& whole)
{
    const std::optional<Texels> constant = shrunk_constant(whole);
    const Texels& image = constant ? *constant : whole;
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
    return {static_cast<std::uint32_t>(first), image.width, image.height, image.is_8_bit};
}

}  // namespace

PathTextures make_path_textures(const Scene& scene, const Requirements& required)
{
    PathTextures out;
    out.texels_8.push_back(0xffffffffu);
    const uvec4 white(0u, 1u | 1u << 16, 0u, 0u);
    std::map<Index, StoredImage> stored;
    for (std::size_t i = 0; i < scene.textures.size(); ++i) {
        const Texture& texture = scene.textures[i];
        const bool usable = required.texture_used[i] && texture.image != kNone &&
                            scene.images[texture.image].width > 0 && scene.images[texture.image].height > 0;
        if (!usable) {
            out.table.push_back(white);
            continue;
        }
        const auto [known, is_new] = stored.try_emplace(texture.image);
        if (is_new) known->second = add_image(out, scene.images[texture.image]);
        const StoredImage& image = known->second;
        std::uint32_t flags = code(texture.sampler.wrap_u) | code(texture.sampler.wrap_v) << shared::kTextureWrapVShift;
        if (texture.sampler.mag == Filter::nearest) flags |= shared::kTextureNearest;
        if (!image.is_8_bit) flags |= shared::kTextureWide;
        out.table.emplace_back(image.first, std::uint32_t(image.width) | std::uint32_t(image.height) << 16, flags, 0u);
    }
    return out;
}

}  // namespace etalon
