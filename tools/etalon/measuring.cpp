#include "tools/etalon/measuring.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstdlib>

#include "engine/scene/digest.h"
#include "etalon_version.h"
#include "tools/etalon/scenes.h"
#include "tools/etalon/settings.h"

namespace etalon::cli {

std::vector<Option> measuring_rows(const std::string& command, const std::string& budget, const std::string& quick,
                                   const std::string& renderer)
{
    return {{.name = "output",
             .letter = 'o',
             .argument = "FOLDER",
             .help = fmt::format("Where the report goes; out/NAME-{} when absent", command),
             .completes = Completes::folder,
             .heading = "Output"},
            {.name = "budget", .argument = "SECONDS", .help = budget, .standard = "60", .heading = "Measuring"},
            {.name = "quick", .help = quick, .heading = "Measuring"},
            {.name = "renderer",
             .letter = 'r',
             .argument = "NAME",
             .help = renderer,
             .standard = "both",
             .choices = {"both", "raster", "path"},
             .heading = "Measuring"}};
}

double budget_seconds(const Arguments& arguments)
{
    const double seconds = arguments.number("budget", 1, 1e6).value_or(60);
    return arguments.has("quick") ? std::min(seconds, 15.0) : seconds;
}

std::vector<Renderer> measured_renderers(const Arguments& arguments)
{
    const std::string only = arguments.text("renderer").value_or("both");
    if (only == "raster") return {Renderer::raster};
    if (only == "path") return {Renderer::path};
    return {Renderer::raster, Renderer::path};
}

std::filesystem::path measuring_folder(const Arguments& arguments)
{
    return arguments.text("output").value_or(
        fmt::format("out/{}-{}", short_name(arguments.positional().front()), arguments.command().name));
}

PoseSettings measured_view(const Arguments& arguments, ivec2 standard)
{
    PoseSettings view = pose_settings(arguments);
    if (!view.size) view.size = standard;
    return view;
}

std::optional<std::filesystem::path> cache_folder(const char* kind)
{
    const auto variable = [](const char* name) {
        const char* const value = std::getenv(name);
        return std::filesystem::path(value != nullptr ? value : "");
    };
    // A relative path in it is to be ignored.
    if (const auto cache = variable("XDG_CACHE_HOME"); cache.is_absolute()) return cache / "etalon" / kind;
    if (const auto home = variable("HOME"); home.is_absolute()) return home / ".cache" / "etalon" / kind;
    return std::nullopt;
}

std::string build_key()
{
    std::error_code none;
    const auto built = std::filesystem::last_write_time(std::filesystem::read_symlink("/proc/self/exe", none), none);
    return fmt::format("{} {}", kVersionFull, built.time_since_epoch().count());
}

std::string profile_key(const PosedScene& posed, const RenderSettings& settings, const std::string& device)
{
    PosedScene any_size = posed;
    any_size.view.width = any_size.view.height = 0;
    const dvec3 b = settings.background_color;
    return fmt::format("{} {} {} {} {} {},{},{}", digest(any_size).text(), build_key(), device,
                       static_cast<int>(settings.shading), static_cast<int>(settings.background), b.x, b.y, b.z);
}

}  // namespace etalon::cli
