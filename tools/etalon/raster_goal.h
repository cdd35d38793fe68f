#pragma once
#include <optional>
#include <string>
#include <vector>

#include "engine/scene/pose.h"
#include "engine/scene/settings.h"
#include "tools/etalon/renderers.h"

namespace etalon::cli {

/// --max-error and --max-time of the rasterizer: the settings that the profile of this scene, which `tradeoff` has left
/// in the user's cache, says are good and fast enough: the fastest within `error` (relative root mean square), or the
/// most accurate within `seconds`, or of both. Says in `notes` what was chosen, and what the best is where neither can
/// be had. Knobs that the profile does not know stay as they are. Error(input) without a profile of this scene, device
/// and build.
RenderSettings choose_raster_settings(const PosedScene& posed, const RenderSettings& settings,
                                      std::optional<double> error, std::optional<double> seconds, Renderers& renderers,
                                      std::vector<std::string>& notes);

}  // namespace etalon::cli
