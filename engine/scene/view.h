#pragma once
#include <span>
#include <string>
#include <vector>

#include "engine/scene/pose.h"

namespace etalon {

/// A camera where a node of the chosen root puts it.
struct PlacedCamera {
    Index camera = 0;
    Index node = 0;
    dmat4 world_from_node{1};
    Camera state{};  ///< the camera at this instant
};

/// What there is to look at: a sphere about it.
struct Subject {
    dvec3 center{0};
    double radius = 1;  ///< > 0
};

/// The picture's size: the settings', else the scene's hint, else 1280x720. Error(input) outside 1 … 16384 a side or
/// over 2^28 pixels (the largest image that every back end takes).
ivec2 picture_size(const PoseSettings& settings, const FilmHints& hints);

/// Settings' orbit, else the named camera, else the first one placed, else a framed three-quarter view (said in
/// `notes`).
View choose_view(const Scene& scene, std::span<const PlacedCamera> cameras, const Subject& subject, ivec2 size,
                 const PoseSettings& settings, std::vector<std::string>& notes);

}  // namespace etalon
