#pragma once
#include <vector>

#include "engine/scene/requirements.h"

namespace etalon {

/// The textures that a picture needs, as the path tracer reads them: level 0, as coded. Layouts: shaders/shared/path.h.
struct PathTextures {
    std::vector<uvec4> table;             ///< per Scene texture; unused ones are a single white texel
    std::vector<std::uint32_t> texels_8;  ///< RGBA
    std::vector<vec4> texels_wide;
};

PathTextures make_path_textures(const Scene& scene, const Requirements& required);

}  // namespace etalon
