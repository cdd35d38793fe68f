#pragma once
#include <filesystem>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "engine/image/develop.h"
#include "engine/image/film.h"
#include "engine/measure/compare.h"
#include "engine/measure/picture_error.h"

namespace etalon {

struct StageTime {
    std::string stage;  ///< "load", "build BVH", "path tracing"
    double seconds = 0;
};

/// What one renderer made of the scene.
struct RendererRun {
    std::string name;    ///< "path": also the stem of its files; [a-z0-9_-]
    std::string label;   ///< "Vulkan path tracer"
    std::string device;  ///< "llvmpipe (LLVM 15.0.6, 256 bits)", "CPU, double precision"
    Film film;
    std::vector<StageTime> stages;
    std::optional<PictureError> error{};  ///< of the picture, where single pixels were traced
};

/// The comparison of runs[a] with runs[b].
struct RunComparison {
    std::size_t a = 0;
    std::size_t b = 0;
    Comparison comparison;
};

using NamedValues = std::vector<std::pair<std::string, std::string>>;

/// Everything a run measured: what report.json, report.html and the table say.
struct Report {
    std::string scene;               ///< path or builtin name, as the user gave it
    std::string command;             ///< to make it again
    NamedValues settings;            ///< "size" "256x256", "spp" "64", "seed" "1" …
    NamedValues versions;            ///< "etalon", "compiler", "vulkan" …
    std::vector<StageTime> stages;   ///< before any renderer: load, pose
    std::vector<std::string> notes;  ///< warnings, choices made for the user
    std::vector<RendererRun> runs;
    std::vector<RunComparison> comparisons;
    DevelopSettings develop;  ///< how the pictures are shown
    bool interrupted = false;
};

/// True when no comparison failed and every film is finite: exit code 0, else 1.
bool passed(const Report& report);

/// "2 of 3 pairs tested: no fault found", or how many fail.
std::string summary(const Report& report);

/// schema "etalon-report/1": keys in a fixed order, null where a value does not exist, never NaN or Inf.
std::string report_json(const Report& report);
/// One page that needs no other file and no network: pictures, differences, table, p-value histograms, pixel read-out.
std::string report_html(const Report& report);
/// The table that a terminal prints; `width` columns at most, no colour codes, ends with a newline.
std::string report_table(const Report& report, int width = 100);

/// Writes report.json, report.html, NAME.png and NAME.exr of every run, A-B.png of every comparison (and A-B-z.png
/// where both have variance) into `folder`, which is made when absent; each file at once or not at all. Returns their
/// paths, report.html first. Throws Error.
std::vector<std::filesystem::path> write_report(const Report& report, const std::filesystem::path& folder);

}  // namespace etalon
