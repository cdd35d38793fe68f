#include "tools/etalon/settings.h"

#include <fmt/format.h>

#include <charconv>
#include <cmath>

#include "engine/base/error.h"
#include "engine/scene/environment.h"
#include "engine/scene/footprint.h"
#include "tools/etalon/checkpoints.h"
#include "tools/etalon/knob_options.h"

namespace etalon::cli {
namespace {

/// "800M" as bytes: a number and a letter for its power of 1024, "iB" or "B" after it as one likes.
std::optional<std::uint64_t> parse_bytes(std::string_view text)
{
    for (const std::string_view tail : {"iB", "B"})
        if (text.ends_with(tail)) {
            text.remove_suffix(tail.size());
            break;
        }
    constexpr std::string_view kLetters = "KMGT";
    const std::size_t letter = text.empty() ? std::string_view::npos : kLetters.find(text.back());
    if (letter != std::string_view::npos) text.remove_suffix(1);
    const std::optional<double> number = parse_number(text);
    if (!number) return std::nullopt;
    const double bytes = *number * std::pow(1024.0, letter == std::string_view::npos ? 0.0 : double(letter + 1));
    if (!(bytes >= 1 && bytes < 1e18)) return std::nullopt;
    return static_cast<std::uint64_t>(bytes);
}

std::optional<ivec2> parse_size(const Arguments& arguments)
{
    const std::optional<std::string> value = arguments.text("size");
    if (!value) return std::nullopt;
    const std::vector<std::string> parts = split(*value, 'x');
    const auto width = parts.size() == 2 ? parse_count(parts[0]) : std::nullopt;
    const auto height = parts.size() == 2 ? parse_count(parts[1]) : std::nullopt;
    if (!width || !height) refuse("size", *value, "WxH", "for example --size 1280x720");
    const std::uint64_t most = limits(arguments).picture_side;
    if (*width < 1 || *height < 1 || *width > most || *height > most)
        refuse("size", *value, fmt::format("a width and a height from 1 to {} pixels", most));
    return ivec2(static_cast<int>(*width), static_cast<int>(*height));
}

std::optional<Orbit> parse_orbit(const Arguments& arguments)
{
    const std::optional<std::string> value = arguments.text("orbit");
    if (!value) return std::nullopt;
    const std::vector<std::string> parts = split(*value, ',');
    std::vector<double> numbers;
    for (const std::string& part : parts)
        if (const auto number = parse_number(part)) numbers.push_back(*number);
    const bool complete = numbers.size() == parts.size() && (parts.size() == 2 || parts.size() == 3);
    if (!complete) refuse("orbit", *value, "AZ,EL or AZ,EL,DIST", "degrees, degrees, metres: --orbit 30,20,2.5");
    if (std::abs(numbers[1]) > 90) refuse("orbit", *value, "an elevation from -90 to 90 degrees");
    Orbit orbit{.azimuth = numbers[0], .elevation = numbers[1]};
    if (numbers.size() == 3) {
        if (!(numbers[2] > 0)) refuse("orbit", *value, "a distance above 0 metres");
        orbit.distance = numbers[2];
    }
    return orbit;
}

std::optional<LensSettings> parse_lens(const Arguments& arguments)
{
    const std::optional<std::string> value = arguments.text("lens");
    if (!value) return std::nullopt;
    const std::vector<std::string> parts = split(*value, ',');
    std::vector<double> numbers;
    for (const std::string& part : parts)
        if (const auto number = parse_number(part)) numbers.push_back(*number);
    if (numbers.size() != parts.size() || numbers.size() > 3)
        refuse("lens", *value, "F-STOP[,FOCUS[,BLADES]]", "for example --lens 2.8,1.5,6");
    if (!(numbers[0] > 0)) refuse("lens", *value, "an f-stop above 0");
    LensSettings lens{.f_stop = numbers[0], .focus = {}};
    if (numbers.size() > 1 && !(numbers[1] > 0)) refuse("lens", *value, "a focus above 0 metres");
    if (numbers.size() > 1) lens.focus = numbers[1];
    if (numbers.size() < 3) return lens;
    lens.blades = static_cast<int>(numbers[2]);
    if (numbers[2] != std::floor(numbers[2]) || numbers[2] < 3 || numbers[2] > 64)
        refuse("lens", *value, "3 to 64 blades", "leave them out for a round aperture");
    return lens;
}

void read_environment(const Arguments& arguments, PoseSettings& settings)
{
    const std::optional<std::string> value = arguments.text("environment");
    if (value == "none")
        settings.no_environment = true;
    else if (value)
        settings.environment = etalon::read_environment(*value);
    settings.environment_rotation = arguments.number("environment-rotation", -1e6, 1e6).value_or(0);
    settings.environment_intensity = arguments.number("environment-intensity", 0, 1e9).value_or(1);
}

void read_background(const Arguments& arguments, RenderSettings& settings)
{
    const std::string value = arguments.text("background").value_or("environment");
    if (value == "environment")
        settings.background = Background::environment;
    else if (value == "transparent")
        settings.background = Background::transparent;
    else if (const auto colour = parse_colour(value)) {
        settings.background = Background::colour;
        settings.background_color = *colour;
    } else
        refuse("background", value, "transparent, environment, #rrggbb or r,g,b");
}

}  // namespace

std::optional<dvec3> parse_colour(std::string_view text)
{
    if (text.starts_with('#')) {
        unsigned code = 0;
        const auto [end, fault] = std::from_chars(text.data() + 1, text.data() + text.size(), code, 16);
        if (text.size() != 7 || fault != std::errc() || end != text.data() + text.size()) return std::nullopt;
        const auto channel = [&](unsigned shift) { return linear_from_srgb((code >> shift & 0xffu) / 255.0); };
        return dvec3(channel(16), channel(8), channel(0));
    }
    const std::vector<std::string> parts = split(text, ',');
    dvec3 colour{0};
    if (parts.size() != 3) return std::nullopt;
    for (int i = 0; i < 3; ++i) {
        const auto number = parse_number(parts[static_cast<std::size_t>(i)]);
        if (!number || *number < 0 || *number > 1e30) return std::nullopt;
        colour[i] = *number;
    }
    return colour;
}

PoseSettings pose_settings(const Arguments& arguments)
{
    PoseSettings settings;
    if (const auto root = arguments.count("scene", 0, kNone - 1)) settings.root = static_cast<Index>(*root);
    settings.camera = arguments.text("camera");
    settings.orbit = parse_orbit(arguments);
    if (settings.camera && settings.orbit)
        throw Error(Blame::input, "--camera and --orbit exclude each other", "give one of them");
    settings.lens = parse_lens(arguments);
    constexpr Projection kProjections[] = {Projection::camera, Projection::orthographic, Projection::equirectangular};
    settings.projection = kProjections[arguments.choice("projection")];
    settings.size = parse_size(arguments);
    settings.time = arguments.number("time", -1e9, 1e9);
    settings.animation = arguments.text("animation");
    settings.limits = limits(arguments);
    read_environment(arguments, settings);
    return settings;
}

RenderSettings render_settings(const Arguments& arguments)
{
    RenderSettings settings;
    constexpr Shading kShadings[] = {Shading::automatic, Shading::blinn_phong, Shading::pbr};
    settings.shading = kShadings[arguments.choice("shading")];
    if (find_option(arguments.command(), "renderer") != nullptr) {
        constexpr Renderer kRenderers[] = {Renderer::raster, Renderer::path, Renderer::reference,
                                           Renderer::reference_raster};
        settings.renderer = kRenderers[arguments.choice("renderer")];
    }
    settings.seed = arguments.count("seed", 0, ~std::uint64_t{0}).value_or(0);
    settings.aovs = arguments.has("aovs");
    read_background(arguments, settings);
    if (find_option(arguments.command(), "shard") != nullptr) settings.shard = shard(arguments);
    apply_knobs(arguments, settings);
    return settings;
}

DevelopSettings develop_settings(const Arguments& arguments)
{
    constexpr Tone kTones[] = {Tone::none, Tone::aces, Tone::neutral, Tone::reinhard, Tone::agx};
    return {.exposure = arguments.number("exposure", -100, 100).value_or(0), .tone = kTones[arguments.choice("tone")]};
}

gpu::DeviceOptions device_options(const Arguments& arguments)
{
    gpu::DeviceOptions options;
    if (arguments.choice("backend") == 2) options.backend = gpu::Backend::opengl;
    options.device = arguments.text("device").value_or("");
    if (arguments.has("require-device"))
        options.kind = arguments.choice("require-device") == 0 ? gpu::DeviceKind::cpu : gpu::DeviceKind::gpu;
    options.validate = arguments.has("validate");
    if (arguments.text("memory")) options.memory_budget = limits(arguments).memory;
    return options;
}

Limits limits(const Arguments& arguments)
{
    constexpr LimitLevel kLevels[] = {LimitLevel::none, LimitLevel::standard, LimitLevel::strict};
    const bool has = find_option(arguments.command(), "limits") != nullptr;
    Limits limits(has ? kLevels[arguments.choice("limits")] : LimitLevel::standard);
    if (const auto text = arguments.text("memory")) {
        const auto bytes = parse_bytes(*text);
        if (!bytes) refuse("memory", *text, "a number of bytes", "for example --memory 4G");
        limits.memory = *bytes;
    }
    return limits;
}

void check_picture(const Arguments& arguments)
{
    if (find_option(arguments.command(), "spp") == nullptr) return;  // a command that draws nothing
    if (find_option(arguments.command(), "degrade") != nullptr && arguments.has("degrade")) return;
    if (const auto size = parse_size(arguments))
        check_memory(predict(*size, render_settings(arguments)), limits(arguments).memory);
}

}  // namespace etalon::cli
