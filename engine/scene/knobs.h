#pragma once
#include <array>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <variant>

#include "engine/scene/settings.h"

namespace etalon {

/// Renderers that a knob acts on.
enum class KnobScope { path, raster, cpu };

/// What its effect on a picture is measured in.
enum class KnobMetric {
    none,    ///< changes no pixel
    relmse,  ///< relative mean squared error against a converged picture
};

/// A whole number from `min` to `max`.
struct CountRange {
    std::uint64_t min = 0;
    std::uint64_t max = 0;
};
/// One of a few whole numbers.
struct CountChoice {
    std::array<std::uint64_t, 5> values{};
    std::size_t count = 0;
};
/// One of a few names; the value is the index.
struct NameChoice {
    std::array<std::string_view, 4> values{};
    std::size_t count = 0;
};
/// "on" or "off".
struct Switch {};

/// One speed/accuracy choice of RenderSettings. Flags, help, completion, range checks, sweeps and docs/tradeoffs.md
/// derive from its row; the standard value is that of a default RenderSettings.
struct Knob {
    std::string_view name;  ///< as on the command line, without dashes: "max-depth"
    std::variant<CountRange, CountChoice, NameChoice, Switch> type;
    std::variant<std::uint64_t RenderSettings::*, int RenderSettings::*, unsigned RenderSettings::*,
                 bool RenderSettings::*, PixelFilter RenderSettings::*, TextureFilter RenderSettings::*,
                 DepthKind RenderSettings::*, Shadows RenderSettings::*, LightSelection RenderSettings::*,
                 Sequence RenderSettings::*>
        field;
    std::string_view unit;  ///< "samples/pixel"; empty for a switch
    KnobScope scope = KnobScope::path;
    std::string_view what;   ///< one line of help
    std::string_view buys;   ///< what a cheaper value saves
    std::string_view costs;  ///< what error it brings
    KnobMetric metric = KnobMetric::none;
    std::array<std::string_view, 4> tried{};  ///< what sweeps try; all empty: as the type suggests
};

std::span<const Knob> knobs();
/// The row of that name, or nothing.
const Knob* find_knob(std::string_view name);
/// The row of that name. Error(input) listing the names when there is none.
const Knob& knob(std::string_view name);

/// Its possible values in words: "1 to 1073741824 samples/pixel", "1, 2 or 4 samples/pixel", "on or off".
std::string range_of(const Knob& knob);
/// The value of a knob as set_knob reads it.
std::string knob_value(const RenderSettings& settings, std::string_view name);
/// Sets a knob from text: a whole number, a name or on/off. Error(input) with the range when the text is not one of its
/// values.
void set_knob(RenderSettings& settings, std::string_view name, std::string_view text);
/// Every knob of `settings` in its range, whoever set it. Error(input) otherwise.
void check_knobs(const RenderSettings& settings);

}  // namespace etalon
