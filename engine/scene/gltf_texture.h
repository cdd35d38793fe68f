#pragma once
#include <string>
#include <vector>

#include "engine/scene/gltf_import.h"

namespace etalon::gltf {

/// The textures that materials use and their images, each made once, when it is first asked for.
class Textures {
 public:
    Textures(const Source& source, Scene& scene);

    /// What a textureInfo of glTF says. Not present where there is none, or (with a warning) where it cannot be read.
    template <typename TextureInfo>
    TextureUse use(const TextureInfo& info, const std::string& pointer)
    {
        if (info.index < 0) return {};
        return use(static_cast<std::size_t>(info.index), info.texCoord,
                   member(info.extensions, "KHR_texture_transform"), pointer);
    }
    /// The same of the textureInfo that is member `key` of an extension.
    TextureUse use(const Value& extension, const std::string& key, const std::string& pointer);

    /// Decodes the images of all textures used, side by side.
    void decode_images();

 private:
    TextureUse use(std::size_t index, int uv_set, const Value* transform, const std::string& pointer);
    Index texture(std::size_t index);
    Index image(std::size_t index);

    const Source& source_;
    Scene& scene_;
    std::vector<Index> texture_of_;         // of each glTF texture: which of ours
    std::vector<Index> image_of_;           // of each glTF image
    std::vector<std::size_t> used_images_;  // of each of our images: which of glTF's
};

}  // namespace etalon::gltf
