#include "tools/etalon/checkpoints.h"

#include <fmt/format.h>

#include <filesystem>

#include "engine/base/error.h"
#include "engine/base/files.h"
#include "engine/scene/digest.h"
#include "engine/scene/knobs.h"
#include "tools/etalon/output.h"
#include "tools/etalon/provenance.h"

namespace etalon::cli {
namespace {

constexpr std::uint64_t kMostShards = 1'000'000;

/// Everything that decides the bits of the picture but the number of its samples.
std::map<std::string, std::string> picture_of(const PosedScene& posed, const RenderSettings& settings,
                                              const std::string& device)
{
    std::map<std::string, std::string> of;
    for (const auto& [name, value] : versions())
        if (name == "etalon" || name == "compiler") of["the " + name] = value;
    for (const Knob& knob : knobs())
        if (knob.scope == KnobScope::path && knob.name != "spp")
            of[std::string(knob.name)] = knob_value(settings, knob.name);
    const dvec3 b = settings.background_color;
    of["renderer"] = name(settings.renderer);
    of["seed"] = fmt::format("{}", settings.seed);
    of["size"] = fmt::format("{}x{}", posed.view.width, posed.view.height);
    of["shard"] = fmt::format("{}/{}", settings.shard.number, settings.shard.count);
    of["shading"] = fmt::format("{}", static_cast<int>(settings.shading));
    of["background"] = fmt::format("{} {},{},{}", static_cast<int>(settings.background), b.x, b.y, b.z);
    of["the device"] = device;
    of["the scene's fingerprint"] = digest(posed).text();
    return of;
}

}  // namespace

Shard shard(const Arguments& arguments)
{
    const std::optional<std::string> text = arguments.text("shard");
    if (!text) return {};
    const std::vector<std::string> parts = split(*text, '/');
    const auto number = parts.size() == 2 ? parse_count(parts[0]) : std::nullopt;
    const auto count = parts.size() == 2 ? parse_count(parts[1]) : std::nullopt;
    if (!number || !count || *number < 1 || *number > *count || *count > kMostShards)
        refuse("shard", *text, fmt::format("I/N with 1 <= I <= N <= {}", kMostShards), "for example --shard 2/3");
    return {.number = static_cast<unsigned>(*number), .count = static_cast<unsigned>(*count)};
}

std::optional<Resume> resume(const Arguments& arguments, const RenderSettings& settings)
{
    const bool traced = settings.renderer == Renderer::path || settings.renderer == Renderer::reference;
    for (const char* option : {"shard", "resume"}) {
        if (!arguments.has(option)) continue;
        if (!traced)
            throw Error(Blame::input, fmt::format("--{} needs a renderer that adds up samples", option),
                        "add --renderer path");
        if (arguments.has("max-error"))
            throw Error(Blame::input, fmt::format("--{} and --max-error exclude each other", option),
                        "say the number of samples by --spp");
    }
    if (arguments.has("checkpoint") && !arguments.has("resume"))
        throw Error(Blame::input, "--checkpoint needs a file to write to", "add --resume FILE");
    const std::optional<std::string> pattern = arguments.text("resume");
    if (!pattern) return std::nullopt;
    return Resume{*pattern, arguments.number("checkpoint", 0, 1e9).value_or(60)};
}

StateFile::StateFile(std::string path, double seconds, const PosedScene& posed, const RenderSettings& settings,
                     const std::string& device)
    : path_(std::move(path)), seconds_(seconds), of_(picture_of(posed, settings, device))
{
    check_folder(std::filesystem::path(path_).parent_path());
    check_replaceable(path_);
    std::error_code fault;
    if (!std::filesystem::exists(path_, fault)) return;
    state_ = read_film_state(path_);
    const std::string other = difference(*state_, of_);
    if (!other.empty())
        throw Error(Blame::input, fmt::format("{} is of another picture: {}", path_, other),
                    "give the same scene and settings, or another file to begin anew");
}

Checkpoints StateFile::checkpoints()
{
    return {.from = state_ ? &*state_ : nullptr,
            .keep =
                [this](const FilmState& state) {
                    FilmState kept = state;
                    kept.of = of_;
                    write_film_state(kept, path_);
                },
            .seconds = seconds_};
}

}  // namespace etalon::cli
