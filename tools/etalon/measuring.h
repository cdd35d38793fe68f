#pragma once
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "engine/scene/pose.h"
#include "engine/scene/settings.h"
#include "tools/etalon/arguments.h"
#include "tools/etalon/options.h"

namespace etalon::cli {

// What the commands share that draw a scene many times within a budget: tradeoff and stability.

/// Options -o (out/NAME-`command` when absent), --budget, --quick and --renderer.
std::vector<Option> measuring_rows(const std::string& command, const std::string& budget, const std::string& quick,
                                   const std::string& renderer);

/// Seconds of --budget, at most a quarter of a minute with --quick.
double budget_seconds(const Arguments& arguments);
/// Of --renderer: the rasterizer, the path tracer, or both.
std::vector<Renderer> measured_renderers(const Arguments& arguments);
/// Of -o.
std::filesystem::path measuring_folder(const Arguments& arguments);
/// Of the view options; `standard` where none says a size.
PoseSettings measured_view(const Arguments& arguments, ivec2 standard);

/// Where things that can be made again are kept, by the XDG Base Directory Specification: …/etalon/`kind`. Nothing
/// where the user has no home.
std::optional<std::filesystem::path> cache_folder(const char* kind);
/// Tells this build of the program from others.
std::string build_key();
/// Everything that decides what settings of the rasterizer cost and give but the size of the picture: scene, view and
/// light by their content, device and build. For ProfileStore.
std::string profile_key(const PosedScene& posed, const RenderSettings& settings, const std::string& device);

}  // namespace etalon::cli
