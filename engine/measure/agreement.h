#pragma once
#include <functional>
#include <span>
#include <string>

#include "engine/base/progress.h"
#include "engine/measure/compare.h"
#include "engine/measure/report.h"

namespace etalon {

/// A renderer with its scene and settings already in it. `render` fills film, device and stages of the run.
/// Give every path-traced one its own seed: with a shared one the samples correlate and the test has no meaning.
struct Contender {
    std::string name;   ///< "path"
    std::string label;  ///< "Vulkan path tracer"
    std::function<RendererRun(const Progress&)> render;
};

/// Renders with each contender in turn, compares every pair and adds runs and comparisons to `report`. When `progress`
/// says stop, what is done so far is compared and `interrupted` is set.
Report measure_agreement(Report report, std::span<const Contender> contenders, const CompareSettings& settings,
                         const Progress& progress);

}  // namespace etalon
