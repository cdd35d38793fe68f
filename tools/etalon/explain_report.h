#pragma once
#include <optional>
#include <string>
#include <vector>

#include "engine/render/costs.h"
#include "engine/render/specialisation.h"
#include "engine/scene/simplify.h"
#include "engine/scene/suggestions.h"
#include "engine/scene/unseen.h"

namespace etalon::cli {

/// All that `explain` finds out about a scene.
struct Explained {
    const Scene* scene = nullptr;
    RenderSettings settings;
    ivec2 size{0};
    Requirements required;
    std::vector<Removal> removals;
    std::vector<Suggestion> suggestions;
    std::optional<SceneCosts> costs;  ///< of the device's renderers
    std::vector<RequirementCost> each;
    std::optional<Specialisation> measured;
    std::optional<Unseen> unseen;  ///< of rasterizers
    std::size_t draws = 0;
};

std::string explained_text(const Explained& explained);
/// schema "etalon-explain/2"
std::string explained_json(const Explained& explained);

}  // namespace etalon::cli
