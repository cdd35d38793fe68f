#pragma once
#include <functional>
#include <optional>
#include <span>
#include <string_view>

#include "engine/scene/pose.h"
#include "engine/scene/settings.h"

namespace etalon {

/// A scene whose picture is known before it is drawn.
struct Variant {
    Scene scene;
    double radiance = 1;                              ///< the picture's radiance is this times the unchanged one's
    bool mirrored = false;                            ///< it is seen with left and right exchanged
    double later = 0;                                 ///< it is posed so many seconds later
    std::function<void(RenderSettings&)> settings{};  ///< how else it is drawn; empty: alike
};

/// A change of a scene, of any size, that leaves its picture as it was (or multiplies it by a known factor) by glTF's
/// own rules: a metamorphic relation. The law of each is in docs/numerics.md under its id.
struct Relation {
    std::string_view id;    ///< "R1"
    std::string_view name;  ///< "scale up"
    std::string_view unit;  ///< of the size: "×", "m", ""
    double start = 1;       ///< the least size, where next to nothing is changed
    double promised = 1;    ///< the size up to which it holds: start … promised is the promise
    double most = 1;        ///< nothing beyond is tried
    bool raster = true;     ///< asked of rasterizers
    bool path = true;       ///< asked of path tracers
    /// `scene` must come from canonical_scene(); its images may be elsewhere meanwhile. Nothing where the scene has
    /// nothing that could change.
    std::optional<Variant> (*apply)(const Scene& scene, double size);
};

std::span<const Relation> relations();

/// The scene of pose(scene, settings) with what the pose chose written down: one root, its camera as the first camera,
/// in a node; its environment explicit. Pose it with canonical_view().
Scene canonical_scene(const PosedScene& posed, const PoseSettings& settings);
PoseSettings canonical_view(const PosedScene& posed, const PoseSettings& settings);

}  // namespace etalon
