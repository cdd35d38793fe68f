#pragma once
#include <cstdint>
#include <string>
#include <vector>

#include "engine/scene/pose.h"
#include "engine/scene/requirements.h"
#include "engine/scene/settings.h"

namespace etalon {

/// One shader of the picture, and what specialising it to the scene leaves of it. Instructions of SPIR-V.
struct ShaderCost {
    std::string shader;       ///< "path/shade.comp"
    std::size_t written = 0;  ///< as compiled, with everything that it could do
    std::size_t special = 0;  ///< as the driver gets it for this scene; of several variants the longest
    std::size_t variants = 1;
};

/// What a scene's requirements make of shaders and data, against the same scene with every requirement set.
struct SceneCosts {
    std::vector<ShaderCost> shaders;
    std::uint64_t vertex_bytes = 0;  ///< attributes of a triangle on the device (path), all three vertices
    std::uint64_t vertex_bytes_uber = 0;
    std::uint64_t texture_bytes = 0;  ///< of the scene's images at 4 bytes a texel, those that are read
    std::uint64_t texture_bytes_uber = 0;

    std::size_t written() const;
    std::size_t special() const;
};

/// Of the rasterizer or the path tracer; no device is needed.
SceneCosts scene_costs(const PosedScene& posed, const Requirements& required, const RenderSettings& settings);

/// Every requirement set, whatever the scene asks for: the same pixels, only slower.
Requirements everything(Requirements required);

}  // namespace etalon
