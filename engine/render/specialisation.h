#pragma once
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "engine/base/progress.h"
#include "engine/gpu/device.h"
#include "engine/scene/pose.h"
#include "engine/scene/requirements.h"
#include "engine/scene/settings.h"

namespace etalon {

/// What something took. The processors' time is of this whole process: a software device's work is in it, a GPU's is
/// not.
struct Spent {
    double wall = 0;  ///< seconds
    double cpu = 0;   ///< seconds of all processors together
};

/// What one way to draw a scene takes.
struct WayCost {
    Spent start;                  ///< before pictures come at their pace: data uploaded, shaders compiled
    std::vector<Spent> pictures;  ///< each of them after the first
    std::uint64_t memory = 0;     ///< bytes of the device in use by scene and picture
};

/// What a picture and its start take more than they would if nothing needed the feature. Means of what was measured in
/// turn, with half the range that they had.
struct RequirementTime {
    Feature feature = Feature::count;
    bool needed = false;  ///< without it the scene is refused
    Spent start;
    Spent picture;
    Spent scatter;  ///< of `picture`
};

struct Specialisation {
    std::string device;
    bool software = false;   ///< the device's work is in Spent::cpu
    WayCost special;         ///< as the scene requires it
    WayCost uber;            ///< all that the file has, and every requirement set
    bool identical = false;  ///< the pictures, to the bit
    std::vector<RequirementTime> requirements;
    std::size_t unmeasured = 0;  ///< requirements for which there was no time left

    /// Of the processors for a software device, which other processes disturb least, else by the wall.
    double seconds(const Spent& spent) const { return software ? spent.cpu : spent.wall; }
    double start(const WayCost& way) const { return seconds(way.start); }
    /// Median.
    double picture(const WayCost& way) const;
    /// The number of pictures from which on the special pipeline has taken less in all than the uber one; 0: from the
    /// start. Nothing where it never does.
    std::optional<std::uint64_t> break_even() const;
    /// The same against uber pipelines that are compiled already, say for another scene.
    std::optional<std::uint64_t> break_even_with_cache() const;
};

/// Draws a scene both ways in turn, and without each of its requirements, for about `budget` seconds. `whole`: the
/// scene as pose_whole() has it. For the rasterizer and the path tracer.
Specialisation measure_specialisation(const gpu::DeviceOptions& options, const PosedScene& whole,
                                      const PosedScene& posed, const RenderSettings& settings, double budget,
                                      const Progress& progress);

}  // namespace etalon
