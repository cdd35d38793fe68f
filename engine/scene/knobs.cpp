#include "engine/scene/knobs.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>

#include "engine/base/error.h"

namespace etalon {

namespace {

template <typename... Functions>
struct Overloaded : Functions... {
    using Functions::operator()...;
};
template <typename... Functions>
Overloaded(Functions...) -> Overloaded<Functions...>;

constexpr std::array kKnobs = {
    Knob{.name = "spp",
         .type = CountRange{1, std::uint64_t{1} << 30},
         .field = &RenderSettings::spp,
         .unit = "samples/pixel",
         .scope = KnobScope::path,
         .what = "samples per pixel of the path tracers",
         .buys = "time is linear in it",
         .costs = "standard error falls as its square root",
         .metric = KnobMetric::relmse},
    Knob{.name = "max-depth",
         .type = CountRange{1, 4096},
         .field = &RenderSettings::max_depth,
         .unit = "segments",
         .scope = KnobScope::path,
         .what = "most segments of a path from camera to light; 1 is emission alone",
         .buys = "time of the deep paths",
         .costs = "light of longer paths is missing: a bias that the film counts as truncated paths",
         .metric = KnobMetric::relmse},
    Knob{.name = "russian-roulette",
         .type = Switch{},
         .field = &RenderSettings::russian_roulette,
         .unit = "",
         .scope = KnobScope::path,
         .what = "end dim paths early, at random, without bias",
         .buys = "time of paths that carry little",
         .costs = "some variance",
         .metric = KnobMetric::relmse},
    Knob{.name = "msaa",
         .type = CountChoice{{1, 4}, 2},
         .field = &RenderSettings::msaa,
         .unit = "samples/pixel",
         .scope = KnobScope::raster,
         .what = "coverage samples per pixel of the rasterizers",
         .buys = "memory and fill time of the other samples",
         .costs = "stairs along edges",
         .metric = KnobMetric::relmse},
    Knob{.name = "mipmaps",
         .type = Switch{},
         .field = &RenderSettings::mipmaps,
         .unit = "",
         .scope = KnobScope::raster,
         .what = "read textures at the level that fits the pixel; off reads level 0",
         .buys = "a third of texture memory",
         .costs = "aliasing where textures are minified",
         .metric = KnobMetric::relmse},
    Knob{.name = "threads",
         .type = CountRange{0, 1024},
         .field = &RenderSettings::threads,
         .unit = "threads",
         .scope = KnobScope::cpu,
         .what = "threads of the CPU renderers; 0 is one per core",
         .buys = "time falls with it up to the cores",
         .costs = "nothing: every picture has the same bits",
         .metric = KnobMetric::none},
};

std::uint64_t read(const RenderSettings& settings, const Knob& knob)
{
    return std::visit(
        [&](auto field) {
            const auto value = settings.*field;
            // A negative count is outside every range: huge.
            return static_cast<std::uint64_t>(static_cast<std::int64_t>(value));
        },
        knob.field);
}

bool is_allowed(const Knob& knob, std::uint64_t value)
{
    return std::visit(Overloaded{[&](const CountRange& range) { return value >= range.min && value <= range.max; },
                                 [&](const CountChoice& choice) {
                                     return std::find(choice.values.begin(), choice.values.begin() + choice.count,
                                                      value) != choice.values.begin() + choice.count;
                                 },
                                 [&](const Switch&) { return value <= 1; }},
                      knob.type);
}

Error refused(const Knob& knob, std::string_view text)
{
    return Error(Blame::input, fmt::format("{}: \"{}\" is not {}", knob.name, text, range_of(knob)),
                 fmt::format("the standard is {}", knob_value(RenderSettings{}, knob.name)));
}

std::optional<std::uint64_t> parse(const Knob& knob, std::string_view text)
{
    if (std::holds_alternative<Switch>(knob.type)) {
        if (text == "on" || text == "true" || text == "1") return 1;
        if (text == "off" || text == "false" || text == "0") return 0;
        return std::nullopt;
    }
    std::uint64_t value = 0;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
    if (error != std::errc{} || end != text.data() + text.size()) return std::nullopt;
    return value;
}

}  // namespace

std::span<const Knob> knobs()
{
    return kKnobs;
}

const Knob* find_knob(std::string_view name)
{
    const auto found = std::find_if(kKnobs.begin(), kKnobs.end(), [&](const Knob& row) { return row.name == name; });
    return found == kKnobs.end() ? nullptr : &*found;
}

const Knob& knob(std::string_view name)
{
    if (const Knob* found = find_knob(name)) return *found;
    std::string names;
    for (const Knob& row : kKnobs) names += fmt::format("{}{}", names.empty() ? "" : ", ", row.name);
    throw Error(Blame::input, fmt::format("no setting \"{}\"", name), "choose one of: " + names);
}

std::string range_of(const Knob& knob)
{
    const std::string unit = knob.unit.empty() ? "" : fmt::format(" {}", knob.unit);
    return std::visit(
        Overloaded{[&](const CountRange& range) { return fmt::format("{} to {}{}", range.min, range.max, unit); },
                   [&](const CountChoice& choice) {
                       std::string values;
                       for (std::size_t i = 0; i < choice.count; ++i)
                           values += fmt::format("{}{}",
                                                 i == 0                  ? ""
                                                 : i + 1 == choice.count ? " or "
                                                                         : ", ",
                                                 choice.values[i]);
                       return values + unit;
                   },
                   [](const Switch&) { return std::string("on or off"); }},
        knob.type);
}

std::string knob_value(const RenderSettings& settings, std::string_view name)
{
    const Knob& row = knob(name);
    const std::uint64_t value = read(settings, row);
    if (std::holds_alternative<Switch>(row.type)) return value ? "on" : "off";
    return fmt::format("{}", static_cast<std::int64_t>(value));
}

void set_knob(RenderSettings& settings, std::string_view name, std::string_view text)
{
    const Knob& row = knob(name);
    const std::optional<std::uint64_t> value = parse(row, text);
    if (!value || !is_allowed(row, *value)) throw refused(row, text);
    std::visit(
        [&](auto field) {
            using Value = std::remove_reference_t<decltype(settings.*field)>;
            settings.*field = static_cast<Value>(*value);
        },
        row.field);
}

void check_knobs(const RenderSettings& settings)
{
    for (const Knob& row : kKnobs)
        if (!is_allowed(row, read(settings, row))) throw refused(row, knob_value(settings, row.name));
}

}  // namespace etalon
