#pragma once
#include <filesystem>
#include <string>
#include <vector>

#include "engine/scene/pose.h"

namespace etalon {

/// The light from infinity that a posed scene has: the settings' own, else the scene's, else the studio where nothing
/// shines
/// (`has_light` false), else black; then turned and scaled by the settings. A choice made for the user goes to `notes`.
Environment resolve_environment(const SceneRoot& root, const PoseSettings& settings, bool has_light,
                                std::vector<std::string>& notes);

/// An equirectangular picture (EXR, HDR, PNG, JPEG, WebP) as an environment: alpha dropped, values that are not finite
/// replaced (replace_nonfinite), negative ones 0. Error(input) as read_image.
Environment read_environment(const std::filesystem::path& path);

}  // namespace etalon
