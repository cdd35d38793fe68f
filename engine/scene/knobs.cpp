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
    Knob{.name = "sampler",
         .type = NameChoice{{"pcg", "sobol"}, 2},
         .field = &RenderSettings::sampler,
         .unit = "",
         .scope = KnobScope::path,
         .what = "random numbers of paths: independent ones, or Owen-scrambled Sobol points, which fill their squares "
                 "evenly",
         .buys = "pcg: a pixel's variance is known from all its samples, not from two replicates of them",
         .costs = "pcg: more error of the same samples, the more the smoother the picture",
         .metric = KnobMetric::relmse},
    Knob{.name = "glass-shadows",
         .type = Switch{},
         .field = &RenderSettings::glass_shadows,
         .unit = "",
         .scope = KnobScope::path,
         .what = "look for lights through smooth thin glass (window panes, bulbs) instead of finding them by chance",
         .buys = "on: far less noise where lamps are behind glass",
         .costs = "on: glass blurs nothing, not even by its least roughness; a little time",
         .metric = KnobMetric::relmse},
    Knob{.name = "light-selection",
         .type = NameChoice{{"tree", "power"}, 2},
         .field = &RenderSettings::light_selection,
         .unit = "",
         .scope = KnobScope::path,
         .what = "how emitters are chosen: by a tree that knows what each may send to the point, or by power alone",
         .buys = "power: the walk down the tree at every surface",
         .costs = "power: variance where many lights are spread over the scene",
         .metric = KnobMetric::relmse},
    Knob{.name = "msaa",
         .type = CountChoice{{1, 2, 4, 8, 16}, 5},
         .field = &RenderSettings::msaa,
         .unit = "samples/pixel",
         .scope = KnobScope::raster,
         .what = "coverage samples per drawn pixel of the rasterizers, of the counts that the device has",
         .buys = "memory and fill time of the other samples",
         .costs = "stairs along edges",
         .metric = KnobMetric::relmse,
         .tried = {"1", "4"}},  // the counts that every Vulkan device has
    Knob{.name = "ssaa",
         .type = CountRange{1, 64},
         .field = &RenderSettings::ssaa,
         .unit = "drawn pixels along each side of a pixel",
         .scope = KnobScope::raster,
         .what = "draw N x N pixels for each of the picture, and filter them (--filter)",
         .buys = "time and memory are quadratic in it",
         .costs = "aliasing of shading, highlights and edges",
         .metric = KnobMetric::relmse,
         .tried = {"1", "2", "4"}},
    Knob{.name = "filter",
         .type = NameChoice{{"box", "tent", "gaussian", "blackman-harris"}, 4},
         .field = &RenderSettings::pixel_filter,
         .unit = "",
         .scope = KnobScope::raster,
         .what = "how drawn pixels are weighed into one",
         .buys = "little: a wider filter reads more",
         .costs = "box: aliasing above the pixels' frequency; the others: sharpness below it",
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
    Knob{
        .name = "texture-filter",
        .type = NameChoice{{"file", "nearest", "bilinear", "trilinear"}, 4},
        .field = &RenderSettings::texture_filter,
        .unit = "",
        .scope = KnobScope::raster,
        .what = "filter of textures: each as the file says, or all alike (nearest and bilinear take the nearest level)",
        .buys = "reads of other texels and levels",
        .costs = "blocks, or seams between levels; another look than the file's",
        .metric = KnobMetric::relmse},
    Knob{.name = "anisotropy",
         .type = CountChoice{{1, 2, 4, 8, 16}, 5},
         .field = &RenderSettings::anisotropy,
         .unit = "probes",
         .scope = KnobScope::raster,
         .what = "most probes along a pixel's footprint in a texture",
         .buys = "time of textures seen at a slant is linear in it",
         .costs = "they blur along the short side",
         .metric = KnobMetric::relmse},
    Knob{.name = "point-size",
         .type = CountRange{1, 64},
         .field = &RenderSettings::point_size,
         .unit = "pixels",
         .scope = KnobScope::raster,
         .what = "side of the squares that points are drawn as",
         .buys = "nothing: a matter of look",
         .costs = "nothing",
         .metric = KnobMetric::relmse,
         .tried = {"1"}},
    Knob{.name = "line-width",
         .type = CountRange{1, 64},
         .field = &RenderSettings::line_width,
         .unit = "pixels",
         .scope = KnobScope::raster,
         .what = "width of lines",
         .buys = "nothing: a matter of look",
         .costs = "nothing",
         .metric = KnobMetric::relmse,
         .tried = {"1"}},
    Knob{.name = "depth",
         .type = NameChoice{{"reversed-32", "forward-32", "forward-24", "forward-16"}, 4},
         .field = &RenderSettings::depth,
         .unit = "",
         .scope = KnobScope::raster,
         .what =
             "how distances are compared: reversed in 32-bit float with infinite far, or forward in 32, 24 or 16 bits",
         .buys = "half the memory of depth, in 16 bits",
         .costs = "surfaces that lie near one another fight where they are far away",
         .metric = KnobMetric::relmse},
    Knob{.name = "shadows",
         .type = NameChoice{{"none", "map", "ray"}, 3},
         .field = &RenderSettings::shadows,
         .unit = "",
         .scope = KnobScope::raster,
         .what = "shadows of point, spot and directional lights in rasterizers: none, by shadow maps, or by a ray from "
                 "each pixel (the reference rasterizer: by rays)",
         .buys =
             "map: one more drawing of the scene for each light, six for a point light; ray: a BVH of the scene, and "
             "a ray a pixel and light",
         .costs = "none: lights shine through everything; map: blurred edges, no details under a texel",
         .metric = KnobMetric::relmse},
    Knob{.name = "ambient-rays",
         .type = CountRange{0, 4096},
         .field = &RenderSettings::ambient_rays,
         .unit = "paths/drawn pixel",
         .scope = KnobScope::raster,
         .what =
             "paths from each pixel's surface that find what the scene itself hides of the environment and reflects "
             "instead, of at most --max-depth segments; 0 is none",
         .buys = "a BVH of the scene, and time that is linear in it",
         .costs =
             "0: the environment shines through everything, nothing lights anything else; few: noise where something "
             "is in the way",
         .metric = KnobMetric::relmse,
         .tried = {"0", "16", "64"}},
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
                                 [&](const NameChoice& choice) { return value < choice.count; },
                                 [&](const Switch&) { return value <= 1; }},
                      knob.type);
}

template <class Choice>
std::string listed(const Choice& choice)
{
    std::string values;
    for (std::size_t i = 0; i < choice.count; ++i) {
        const char* const between = i == 0 ? "" : i + 1 == choice.count ? " or " : ", ";
        values += fmt::format("{}{}", between, choice.values[i]);
    }
    return values;
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
    if (const auto* const choice = std::get_if<NameChoice>(&knob.type)) {
        const auto end = choice->values.begin() + choice->count;
        const auto found = std::find(choice->values.begin(), end, text);
        if (found == end) return std::nullopt;
        return static_cast<std::uint64_t>(found - choice->values.begin());
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
                   [&](const CountChoice& choice) { return listed(choice) + unit; },
                   [](const NameChoice& choice) { return listed(choice); },
                   [](const Switch&) { return std::string("on or off"); }},
        knob.type);
}

std::string knob_value(const RenderSettings& settings, std::string_view name)
{
    const Knob& row = knob(name);
    const std::uint64_t value = read(settings, row);
    if (std::holds_alternative<Switch>(row.type)) return value ? "on" : "off";
    if (const auto* const choice = std::get_if<NameChoice>(&row.type))
        return std::string(value < choice->count ? choice->values[value] : "none of its values");
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
