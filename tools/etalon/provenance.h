#pragma once
#include <string>

#include "engine/measure/report.h"
#include "engine/scene/pose.h"
#include "engine/scene/settings.h"
#include "tools/etalon/arguments.h"

namespace etalon::cli {

// How a report came about, so that it can be made again.

/// What the user typed, in the table's order of options.
std::string command_line(const Arguments& arguments);
/// Size, seed and every knob.
NamedValues describe(const PosedScene& posed, const RenderSettings& settings);
/// Of etalon, the compiler and Vulkan.
NamedValues versions();

}  // namespace etalon::cli
