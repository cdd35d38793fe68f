#pragma once
#include <optional>
#include <string>
#include <vector>

#include "engine/scene/pose.h"
#include "tools/etalon/arguments.h"

namespace etalon::cli {

/// One picture of a scene.
struct Frame {
    std::optional<std::int64_t> number;  ///< of --frames; nothing: the only one
    std::optional<double> time;          ///< seconds
};

/// The pictures that --frames A:B and --fps ask for, frame n at n/fps seconds; without it one, at --time.
std::vector<Frame> frames(const Arguments& arguments);

/// `pattern` with its last run of # replaced by the number, padded with zeros to as many digits: "f.####.png" is
/// "f.0012.png". Without a number it stays as it is. Throws Error(input) where there is a number but no #.
std::string with_number(const std::string& pattern, const Frame& frame);

/// Bounds of the scene over all frames (over sixteen of them, evenly, where there are more), so that a view that is
/// framed for the user stands still while things move.
std::pair<dvec3, dvec3> bounds_over(const Scene& scene, PoseSettings settings, const std::vector<Frame>& frames);

}  // namespace etalon::cli
