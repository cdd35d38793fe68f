#include "engine/image/post.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <limits>

#include "engine/base/error.h"
#include "engine/base/nearest.h"

namespace etalon {
namespace {

constexpr double kInf = std::numeric_limits<double>::infinity();

constexpr std::size_t kMostStages = 64;

constexpr std::string_view kAuto[] = {"auto"};
constexpr std::string_view kMethods[] = {"exact", "separable", "grid"};
constexpr std::string_view kCurves[] = {"clamp", "aces", "neutral", "reinhard", "agx"};  // of Tone

// NaN stands for "auto".
constexpr double kAutomatic = std::numeric_limits<double>::quiet_NaN();

constexpr PostParameter kExposure[] = {
    {.name = "ev",
     .standard = kAutomatic,
     .least = -100,
     .most = 100,
     .words = kAuto,
     .unit = "EV",
     .what = "Radiance is multiplied by 2^ev; auto brings the middle of the histogram of luminance to 18% grey"},
};
constexpr PostParameter kVignette[] = {
    {.name = "strength",
     .standard = 0.4,
     .least = 0,
     .most = 100,
     .what = "Square of the tangent of the angle of view at the corners: light falls off as the cosine's fourth power"},
};
constexpr PostParameter kGaussian[] = {
    {.name = "sigma",
     .standard = 2,
     .least = 0,
     .most = 1000,
     .unit = "pixels",
     .what = "Standard deviation; below 0.1 nothing changes"},
};
constexpr PostParameter kMedian[] = {
    {.name = "radius",
     .standard = 1,
     .least = 0,
     .most = 5,
     .whole = true,
     .unit = "pixels",
     .what = "The window has 2 radius + 1 pixels a side; each channel by itself"},
};
constexpr PostParameter kBilateral[] = {
    {.name = "sigma_s",
     .standard = 3,
     .least = 0,
     .most = 30,
     .unit = "pixels",
     .what = "Standard deviation in space; below 0.1 nothing changes"},
    {.name = "sigma_r",
     .standard = 0.1,
     .least = 0,
     .most = kInf,
     .unit = "nit",
     .what = "Standard deviation in colour; 0 changes nothing, inf is the Gaussian"},
    {.name = "method",
     .standard = 0,
     .words = kMethods,
     .what = "exact: the whole window; separable: rows, then columns; grid: the bilateral grid over luminance"},
};
constexpr PostParameter kAtrous[] = {
    {.name = "levels",
     .standard = 5,
     .least = 0,
     .most = 10,
     .whole = true,
     .what = "Steps of the wavelet: each doubles the reach, which is 2^(levels + 1) - 2 pixels"},
    {.name = "sigma_c",
     .standard = 4,
     .least = 0,
     .most = kInf,
     .what = "Width in luminance: in standard deviations where the film has variance, else in nit, halved each step"},
    {.name = "sigma_n", .standard = 0.3, .least = 0, .most = kInf, .what = "Width in the difference of unit normals"},
    {.name = "sigma_z",
     .standard = 0.02,
     .least = 0,
     .most = kInf,
     .what = "Width in relative difference of depth per pixel of distance"},
    {.name = "sigma_a", .standard = 0.1, .least = 0, .most = kInf, .what = "Width in the difference of base colours"},
};
constexpr PostParameter kBloom[] = {
    {.name = "strength", .standard = 0.1, .least = 0, .most = 1, .what = "Share of the light that is scattered"},
    {.name = "sigma",
     .standard = 4,
     .least = 0,
     .most = 250,
     .unit = "pixels",
     .what = "Standard deviation of the narrowest of the Gaussians that are scattered by"},
    {.name = "levels",
     .standard = 3,
     .least = 1,
     .most = 8,
     .whole = true,
     .what = "Gaussians, each twice as wide as the one before and with an equal share; none wider than 1000 pixels"},
    {.name = "threshold",
     .standard = 0,
     .least = 0,
     .most = kInf,
     .unit = "nit",
     .what = "Only luminance above it is scattered"},
};
constexpr PostParameter kSobel[] = {
    {.name = "gain", .standard = 1, .least = 0, .most = 1e6, .what = "The gradient is multiplied by it"},
};
constexpr PostParameter kOutline[] = {
    {.name = "depth",
     .standard = 0.1,
     .least = 0,
     .most = kInf,
     .what = "Relative change of inverse depth a pixel that draws a full line; inf ignores depth"},
    {.name = "normal",
     .standard = 0.5,
     .least = 0,
     .most = kInf,
     .what = "Change of the unit normal a pixel that draws a full line; inf ignores normals"},
    {.name = "strength", .standard = 1, .least = 0, .most = 1, .what = "How dark lines are; 1 is black"},
};
constexpr PostParameter kFxaa[] = {
    {.name = "threshold",
     .standard = 0.125,
     .least = 0,
     .most = 1,
     .what = "Contrast relative to the brightest neighbour from which an edge is smoothed"},
    {.name = "floor", .standard = 0.0312, .least = 0, .most = 1, .what = "Contrast below which nothing is smoothed"},
    {.name = "subpixel", .standard = 0.75, .least = 0, .most = 1, .what = "How much lone pixels are softened"},
    {.name = "reach",
     .standard = 16,
     .least = 1,
     .most = 128,
     .whole = true,
     .unit = "pixels",
     .what = "How far the ends of an edge are looked for"},
};
constexpr PostParameter kTone[] = {
    {.name = "curve",
     .standard = 2,
     .words = kCurves,
     .what = "Curve from radiance to the display's linear [0, 1], as --tone"},
};

constexpr PostPass kPasses[] = {
    {PostKind::exposure, "exposure", "Multiplies radiance by 2^ev", kExposure, PostError::scaled},
    {PostKind::vignette, "vignette", "Darkens towards the corners as a lens does", kVignette, PostError::scaled},
    {PostKind::gaussian, "gaussian", "Blurs", kGaussian},
    {PostKind::median, "median", "Takes the median of a window: lone bright pixels go, edges stay", kMedian},
    {PostKind::bilateral, "bilateral", "Smooths what is alike and keeps edges", kBilateral},
    {PostKind::atrous, "atrous", "Removes noise along surfaces, guided by AOVs and by the film's variance", kAtrous,
     PostError::lost, true},
    {PostKind::bloom, "bloom", "Scatters light around what is bright; the picture's energy stays", kBloom},
    {PostKind::sobel, "sobel", "Shows the gradient of luminance, nit per pixel", kSobel},
    {PostKind::outline, "outline", "Draws lines where depth or normal jump", kOutline, PostError::lost, true},
    {PostKind::fxaa, "fxaa", "Smooths the stairs of edges", kFxaa},
    {PostKind::tone, "tone", "Brings radiance to the display; what follows sees display values", kTone},
};

template <class Rows>
std::string nearest_name(const Rows& rows, std::string_view word)
{
    std::vector<std::string> names;
    for (const auto& row : rows) names.emplace_back(row.name);
    return std::string(nearest(word, names));
}

template <class Rows>
std::string list_of(const Rows& rows)
{
    std::vector<std::string_view> names;
    for (const auto& row : rows) names.push_back(row.name);
    return fmt::format("{}", fmt::join(names, ", "));
}

[[noreturn]] void refuse(std::string what, const std::string& meant, std::string otherwise)
{
    throw Error(Blame::input, "--post: " + std::move(what),
                meant.empty() ? std::move(otherwise) : fmt::format("did you mean {}?", meant));
}

double parse_value(const PostPass& pass, const PostParameter& parameter, std::string_view text)
{
    const bool enumerated = parameter.most == 0 && parameter.least == 0 && !parameter.words.empty();
    for (std::size_t i = 0; i < parameter.words.size(); ++i)
        if (parameter.words[i] == text) return enumerated ? double(i) : kAutomatic;
    double value = 0;
    const auto [end, fault] = std::from_chars(text.data(), text.data() + text.size(), value);
    const bool is_number = fault == std::errc() && end == text.data() + text.size() && !std::isnan(value);
    if (enumerated || !is_number || value < parameter.least || value > parameter.most ||
        (parameter.whole && value != std::trunc(value)))
        refuse(fmt::format("{} of {} is '{}', not {}", parameter.name, pass.name, text, range_of(parameter)), "",
               fmt::format("{} when left out", value_text(parameter, parameter.standard)));
    return value;
}

void set_parameter(PostStage& stage, std::string_view assignment)
{
    const PostPass& pass = stage.pass();
    const std::size_t equals = assignment.find('=');
    const std::string_view name = assignment.substr(0, equals);
    const auto row = std::find_if(pass.parameters.begin(), pass.parameters.end(),
                                  [&](const PostParameter& parameter) { return parameter.name == name; });
    if (row == pass.parameters.end())
        refuse(fmt::format("{} has no parameter {}", pass.name, name), nearest_name(pass.parameters, name),
               fmt::format("it takes {}", list_of(pass.parameters)));
    if (equals == std::string_view::npos)
        refuse(fmt::format("{} of {} has no value", name, pass.name), "",
               fmt::format("write {}=VALUE: {}", name, range_of(*row)));
    stage.values[std::size_t(row - pass.parameters.begin())] = parse_value(pass, *row, assignment.substr(equals + 1));
}

PostStage make_stage(std::string_view name)
{
    for (const PostPass& pass : kPasses) {
        if (pass.name != name) continue;
        PostStage stage{.kind = pass.kind, .values = {}};
        for (const PostParameter& parameter : pass.parameters) stage.values.push_back(parameter.standard);
        return stage;
    }
    refuse(name.empty() ? "a pass without a name" : fmt::format("there is no pass {}", name),
           nearest_name(kPasses, name), fmt::format("there are {}", list_of(kPasses)));
}

}  // namespace

std::span<const PostPass> post_passes()
{
    return kPasses;
}

const PostPass& post_pass(PostKind kind)
{
    return *std::find_if(std::begin(kPasses), std::end(kPasses), [&](const PostPass& p) { return p.kind == kind; });
}

double PostStage::operator[](std::string_view parameter) const
{
    const std::span<const PostParameter> rows = pass().parameters;
    for (std::size_t i = 0; i < rows.size(); ++i)
        if (rows[i].name == parameter) return values[i];
    assume(false);
    return 0;
}

bool PostStage::is(std::string_view parameter, std::string_view word) const
{
    const double value = (*this)[parameter];
    for (const PostParameter& row : pass().parameters)
        if (row.name == parameter) return value_text(row, value) == word;
    return false;
}

PostChain parse_post(std::string_view text)
{
    PostChain chain;
    for (std::size_t at = 0; at <= text.size();) {
        const std::size_t end = std::min(text.find(',', at), text.size());
        std::string_view item = text.substr(at, end - at);
        at = end + 1;
        const std::size_t colon = item.find(':');
        if (colon == std::string_view::npos && item.find('=') != std::string_view::npos) {
            if (chain.empty()) refuse(fmt::format("{} belongs to no pass", item), "", "write PASS:PARAMETER=VALUE");
            set_parameter(chain.back(), item);
            continue;
        }
        if (chain.size() == kMostStages)
            refuse(fmt::format("more than {} passes", kMostStages), "", "apply some, and the rest to their result");
        chain.push_back(make_stage(item.substr(0, colon)));
        if (colon != std::string_view::npos) set_parameter(chain.back(), item.substr(colon + 1));
    }
    return chain;
}

std::string describe(const PostChain& chain)
{
    std::vector<std::string> stages;
    for (const PostStage& stage : chain) {
        std::vector<std::string> values;
        for (std::size_t i = 0; i < stage.values.size(); ++i) {
            const PostParameter& parameter = stage.pass().parameters[i];
            values.push_back(fmt::format("{}={}", parameter.name, value_text(parameter, stage.values[i])));
        }
        stages.push_back(fmt::format("{}:{}", stage.pass().name, fmt::join(values, ",")));
    }
    return fmt::format("{}", fmt::join(stages, ","));
}

bool needs_aovs(const PostChain& chain)
{
    return std::any_of(chain.begin(), chain.end(), [](const PostStage& stage) { return stage.pass().aovs; });
}

std::string range_of(const PostParameter& parameter)
{
    if (parameter.least == 0 && parameter.most == 0) {
        std::string text;
        for (std::size_t i = 0; i < parameter.words.size(); ++i)
            text += fmt::format("{}{}",
                                i == 0                            ? ""
                                : i + 1 == parameter.words.size() ? " or "
                                                                  : ", ",
                                parameter.words[i]);
        return text;
    }
    std::string text =
        fmt::format("{}{:g} to {:g}", parameter.whole ? "a whole number from " : "", parameter.least, parameter.most);
    if (!parameter.unit.empty()) text += fmt::format(" {}", parameter.unit);
    for (const std::string_view word : parameter.words) text += fmt::format(" or {}", word);
    return text;
}

std::string value_text(const PostParameter& parameter, double value)
{
    if (std::isnan(value)) return std::string(parameter.words.front());
    const bool enumerated = parameter.least == 0 && parameter.most == 0;
    if (enumerated) return std::string(parameter.words[std::size_t(value)]);
    return fmt::format("{}", value);
}

}  // namespace etalon
