#pragma once
#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "engine/base/progress.h"
#include "engine/measure/compare.h"
#include "engine/measure/relations.h"
#include "engine/measure/report.h"
#include "engine/scene/settings.h"

namespace etalon {

struct StabilitySettings {
    RenderSettings render;
    std::vector<Renderer> renderers = {Renderer::raster, Renderer::path};
    double budget_seconds = 60;  ///< what is being drawn is finished; what does not fit is said to be left out
    int bisections = 4;          ///< steps in the logarithm of the size, once a break is known
    double false_alarm = 1e-3;   ///< of the whole table: that a scene which holds is said to break
};

/// One size of a relation, drawn and judged.
struct Probe {
    double size = 0;
    bool holds = false;
    std::string why;  ///< the first reason of the comparison, or the error that was thrown
};

enum class Holding { holds, breaks, not_reached };

/// What became of a relation with one renderer.
struct StabilityRow {
    std::string id;
    std::string name;
    std::string unit;
    Renderer renderer = Renderer::path;
    double promised = 1;
    std::vector<Probe> probes;               ///< in the order they were tried
    Holding promise = Holding::not_reached;  ///< up to `promised`

    /// The largest size that held below every one that broke; 0 when none did.
    double holds_to() const;
    /// The smallest size that broke; nothing when none did.
    std::optional<double> breaks_at() const;
};

struct Stability {
    std::string scene;
    std::string command;
    NamedValues settings;
    NamedValues versions;
    std::vector<std::string> notes;  ///< what was left out, and why
    std::vector<StabilityRow> rows;
    bool interrupted = false;
};

/// False when a promised range was tried and broke: exit code 1.
bool passed(const Stability& stability);

/// How a relation is tried: draw, and tell whether a rasterized picture is that of the unchanged scene.
struct StabilityCalls {
    std::function<Film(const PosedScene&, const RenderSettings&, const Progress&)> render;
    /// The rasterized `film` against the reference rasterizer's picture of `unchanged`.
    std::function<Comparison(const PosedScene& unchanged, const RenderSettings&, const Film& film)> judge_raster;
};

/// Tries every relation (engine/measure/relations.h) that the scene has something for: at the end of its promised
/// range, beyond it, and by bisection in between, so that the table says where it holds and where it breaks. A
/// path-traced picture is compared with that of the unchanged scene by Welch's test, each with its own random numbers;
/// a rasterized one by the derived budget of rasterizers (docs/raster_budget.md). NaN and Inf break. Errors thrown
/// while a variant is drawn break too, with their text as the reason.
Stability measure_stability(Stability out, const PosedScene& posed, const PoseSettings& view,
                            const StabilitySettings& settings, const StabilityCalls& calls, const Progress& progress);

std::string stability_table(const Stability& stability);
/// schema "etalon-stability/1".
std::string stability_json(const Stability& stability);
std::string stability_html(const Stability& stability);
/// Writes stability.{json,html} into `folder`. Returns their paths, the page first.
std::vector<std::filesystem::path> write_stability(const Stability& stability, const std::filesystem::path& folder);

}  // namespace etalon
