#pragma once
#include "engine/base/limits.h"
#include "engine/gpu/device.h"
#include "engine/image/develop.h"
#include "engine/scene/pose.h"
#include "engine/scene/settings.h"
#include "tools/etalon/arguments.h"

namespace etalon::cli {

// What the options say, as the values that the library takes. Each throws Error(input) on a value out of its range.

PoseSettings pose_settings(const Arguments& arguments);
RenderSettings render_settings(const Arguments& arguments);
DevelopSettings develop_settings(const Arguments& arguments);
gpu::DeviceOptions device_options(const Arguments& arguments);
/// --limits and --memory.
Limits limits(const Arguments& arguments);
/// Refuses a --size that no scene could be drawn at within --memory; asked before anything is read.
void check_picture(const Arguments& arguments);

/// A colour as --background has it: "#rrggbb" is sRGB, "r,g,b" linear nit.
std::optional<dvec3> parse_colour(std::string_view text);

}  // namespace etalon::cli
