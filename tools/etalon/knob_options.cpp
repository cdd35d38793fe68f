#include "tools/etalon/knob_options.h"

#include <fmt/format.h>

#include "engine/base/error.h"
#include "engine/scene/knobs.h"

namespace etalon::cli {
namespace {

std::vector<std::string> choices(const Knob& knob)
{
    if (std::holds_alternative<Switch>(knob.type)) return {"on", "off"};
    std::vector<std::string> all;
    if (const auto* const choice = std::get_if<NameChoice>(&knob.type))
        all.assign(choice->values.begin(), choice->values.begin() + choice->count);
    if (const auto* const choice = std::get_if<CountChoice>(&knob.type))
        for (std::size_t i = 0; i < choice->count; ++i) all.push_back(fmt::format("{}", choice->values[i]));
    return all;
}

std::string argument(const Knob& knob)
{
    if (std::holds_alternative<Switch>(knob.type)) return "on|off";
    return std::holds_alternative<NameChoice>(knob.type) ? "NAME" : "N";
}

std::string sentence(const Knob& knob)
{
    const std::string range = choices(knob).empty() ? fmt::format(", {}", range_of(knob)) : "";
    std::string text = fmt::format("{}{} (buys: {}; costs: {})", knob.what, range, knob.buys, knob.costs);
    text.front() = static_cast<char>(std::toupper(static_cast<unsigned char>(text.front())));
    return text;
}

}  // namespace

std::vector<Option> knob_rows()
{
    std::vector<Option> rows;
    for (const Knob& knob : knobs())
        rows.push_back({.name = std::string(knob.name),
                        .argument = argument(knob),
                        .help = sentence(knob),
                        .standard = knob_value(RenderSettings{}, knob.name),
                        .choices = choices(knob),
                        .heading = "Speed and accuracy"});
    return rows;
}

void apply_knobs(const Arguments& arguments, RenderSettings& settings)
{
    for (const Knob& knob : knobs()) {
        const std::vector<std::string> given = arguments.all(knob.name);
        if (!given.empty()) set_knob(settings, knob.name, given.back());
    }
}

}  // namespace etalon::cli
