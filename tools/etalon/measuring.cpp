#include "tools/etalon/measuring.h"

#include <fmt/format.h>

#include <algorithm>

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

}  // namespace etalon::cli
