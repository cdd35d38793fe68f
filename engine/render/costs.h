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

/// Bytes that a scene takes on a device, and the passes of its picture.
struct DataCost {
    std::uint64_t attribute_bytes = 0;  ///< of vertices, what a shader may read of them
    std::uint64_t texture_bytes = 0;    ///< with mip levels where there are any
    std::size_t passes = 0;             ///< of the rasterizer; 0: it is no rasterizer
};

/// What a scene's requirements make of shaders and data, against the same scene with everything that its file has and
/// every requirement set.
struct SceneCosts {
    std::vector<ShaderCost> shaders;
    DataCost data;
    DataCost uber;

    std::size_t written() const;
    std::size_t special() const;
};

/// What would go if nothing needed a feature, nor any texture for its sake.
struct RequirementCost {
    Feature feature = Feature::count;
    bool needed = false;            ///< without it the scene is refused: it cannot be told apart
    std::int64_t instructions = 0;  ///< of the longest shader of each kind among those that it changes
    std::int64_t attribute_bytes = 0;
    std::int64_t texture_bytes = 0;
    std::int64_t passes = 0;
};

/// Of the rasterizer or the path tracer; no device is needed. `whole`: the scene as pose_whole() has it.
SceneCosts scene_costs(const PosedScene& whole, const PosedScene& posed, const RenderSettings& settings);
/// Of each feature that is required, in their order.
std::vector<RequirementCost> requirement_costs(const PosedScene& posed, const RenderSettings& settings);

/// Every requirement set, whatever the scene asks for: the same pixels, only slower.
Requirements everything(Requirements required);

}  // namespace etalon
