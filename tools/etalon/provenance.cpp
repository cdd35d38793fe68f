#include "tools/etalon/provenance.h"

#include <fmt/format.h>

#include "engine/gpu/device.h"
#include "engine/scene/knobs.h"
#include "etalon_version.h"

namespace etalon::cli {

std::string command_line(const Arguments& arguments)
{
    std::string line = fmt::format("etalon {} {}", arguments.command().name, arguments.positional().front());
    for (const Option& option : arguments.command().options) {
        if (!arguments.has(option.name) || option.name == "progress") continue;
        line += " --" + option.name;
        if (!option.argument.empty()) line += " " + *arguments.text(option.name);
    }
    return line;
}

NamedValues describe(const PosedScene& posed, const RenderSettings& settings)
{
    NamedValues values = {{"size", fmt::format("{}x{}", posed.view.width, posed.view.height)},
                          {"seed", fmt::format("{}", settings.seed)}};
    for (const Knob& knob : knobs()) values.emplace_back(knob.name, knob_value(settings, knob.name));
    return values;
}

NamedValues versions()
{
    NamedValues values = {{"etalon", std::string(kVersionFull)}, {"compiler", std::string(kCompiler)}};
    for (const std::string& line : gpu::vulkan_versions()) {
        const std::size_t space = line.rfind(' ');
        values.emplace_back(line.substr(0, space), space == std::string::npos ? "" : line.substr(space + 1));
    }
    return values;
}

}  // namespace etalon::cli
