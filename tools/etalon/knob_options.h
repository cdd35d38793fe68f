#pragma once
#include "engine/scene/settings.h"
#include "tools/etalon/arguments.h"
#include "tools/etalon/options.h"

namespace etalon::cli {

/// The rows of the knob table (engine/scene/knobs.h) as options.
std::vector<Option> knob_rows();

/// Sets every knob that was given.
void apply_knobs(const Arguments& arguments, RenderSettings& settings);

}  // namespace etalon::cli
