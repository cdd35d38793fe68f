#pragma once
#include <functional>
#include <span>
#include <string>

#include "engine/base/progress.h"
#include "engine/measure/compare.h"
#include "engine/measure/report.h"
#include "engine/scene/settings.h"

namespace etalon {

/// A renderer with its scene and settings already in it. `render` fills film, device and stages of the run.
/// Give every path-traced one its own seed: with a shared one the samples correlate and the test has no meaning.
struct Contender {
    Renderer kind = Renderer::path;
    std::string name;   ///< "path"
    std::string label;  ///< "Vulkan path tracer"
    std::function<RendererRun(const Progress&)> render;
};

struct AgreementSettings {
    CompareSettings compare;
    /// Judges Renderer::raster (first) against Renderer::reference_raster by the budget of engine/measure/rasters.h,
    /// which has to know the scene and the device. Empty: metrics only.
    std::function<Comparison(const Film&, const Film&)> judge_rasters;
    /// Traces single pixels, by which the error of every picture is measured (engine/measure/picture_error.h). Empty:
    /// no error is.
    std::function<PixelProbe(const Progress&)> probe;
};

/// Renders with each contender in turn and adds runs and comparisons to `report`. What is compared: rasterizers with
/// each other, path tracers with each other (the two families compute different things), and one rasterizer with one
/// path tracer, which shows what rasterizing costs; every pair where there are but two. When `progress` says stop, what
/// is done so far is compared and `interrupted` is set.
Report measure_agreement(Report report, std::span<const Contender> contenders, const AgreementSettings& settings,
                         const Progress& progress);

}  // namespace etalon
