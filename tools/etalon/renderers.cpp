#include "tools/etalon/renderers.h"

#include <fmt/format.h>

#include "engine/base/error.h"
#include "engine/reference/reference.h"
#include "engine/render/render.h"
#include "engine/scene/footprint.h"
#include "engine/scene/knobs.h"
#include "engine/scene/requirements.h"
#include "etalon_version.h"
#include "tools/etalon/settings.h"

namespace etalon::cli {
namespace {

bool needs_device(Renderer renderer)
{
    return renderer == Renderer::raster || renderer == Renderer::path;
}

std::string describe(const dmat4& m)
{
    std::string text;
    for (int column = 0; column < 4; ++column)
        for (int row = 0; row < 4; ++row) text += fmt::format("{}{}", text.empty() ? "" : " ", m[column][row]);
    return text;
}

/// Renderers say their times as "milliseconds.<stage>" in the metadata, where they would make every file different.
std::vector<StageTime> take_stages(Film& film)
{
    constexpr std::string_view kPrefix = "milliseconds.";
    std::vector<StageTime> stages;
    for (auto row = film.metadata.begin(); row != film.metadata.end();) {
        const auto milliseconds = row->first.starts_with(kPrefix) ? parse_number(row->second) : std::nullopt;
        if (milliseconds) stages.push_back({row->first.substr(kPrefix.size()), *milliseconds / 1000});
        row = milliseconds ? film.metadata.erase(row) : std::next(row);
    }
    return stages;
}

/// Everything needed to make the same film again.
void describe(Film& film, const PosedScene& posed, const RenderSettings& settings)
{
    constexpr std::string_view kBackgrounds[] = {"environment", "transparent", "colour"};
    constexpr std::string_view kShadings[] = {"auto", "blinn-phong", "pbr"};
    auto& data = film.metadata;
    data["scene"] = posed.scene->name;
    data["renderer"] = name(settings.renderer);
    data["version"] = kVersionFull;
    data["compiler"] = kCompiler;
    data["seed"] = fmt::format("{}", settings.seed);
    data["samples"] = fmt::format("{}", film.samples);
    const dvec3 b = settings.background_color;
    std::string& text = data["settings"];
    text = fmt::format("size={}x{} seed={} shading={} background={} background-color={},{},{}", posed.view.width,
                       posed.view.height, settings.seed, kShadings[static_cast<int>(settings.shading)],
                       kBackgrounds[static_cast<int>(settings.background)], b.x, b.y, b.z);
    for (const Knob& knob : knobs())
        if (knob.metric != KnobMetric::none) text += fmt::format(" {}={}", knob.name, knob_value(settings, knob.name));
    data["world_from_camera"] = describe(posed.view.world_from_camera);
    data["error"] = describe_error(film, settings.renderer);
}

}  // namespace

Renderers::Renderers(const Arguments& arguments)
    : options_(device_options(arguments)), memory_(limits(arguments).memory)
{}

gpu::Device& Renderers::device()
{
    if (!device_) device_.emplace(options_);
    return *device_;
}

Drawn Renderers::draw(const std::string& scene_name, const PosedScene& posed, const RenderSettings& settings,
                      const Progress& progress, const Checkpoints& checkpoints)
{
    const Requirements required = require(posed, settings);
    Film film;
    try {
        check_memory(predict(posed, settings), memory_);
        switch (settings.renderer) {
            case Renderer::raster:
                film = render_raster(device(), posed, required, settings, progress);
                break;
            case Renderer::path:
                film = render_path(device(), posed, required, settings, progress, checkpoints);
                break;
            case Renderer::reference:
                film = reference::render_path(posed, required, settings, progress, checkpoints);
                break;
            case Renderer::reference_raster:
                film = reference::render_raster(posed, required, settings, progress);
                break;
        }
    } catch (Error& error) {
        error.at(fmt::format("{}, {}", scene_name, label(settings.renderer)));
        throw;
    }
    Drawn drawn{.film = {}, .stages = take_stages(film)};
    describe(film, posed, settings);
    film.metadata["device"] = device_of(settings.renderer);
    check_validation();
    drawn.film = std::move(film);
    return drawn;
}

std::string Renderers::device_of(Renderer renderer)
{
    return needs_device(renderer) ? device().description() : "CPU, double precision";
}

RasterPrecision Renderers::raster_precision()
{
    const gpu::DeviceLimits& limits = device().limits();
    return {.subtexel_bits = limits.subtexel_bits, .mip_bits = limits.mip_bits};
}

void Renderers::check_validation() const
{
    if (!device_ || !device_->validating()) return;
    const std::vector<std::string> messages = device_->validation_messages();
    if (messages.empty()) return;
    throw Error(
        Blame::machine,
        fmt::format("the Vulkan validation layers found {} faults; the first: {}", messages.size(), messages.front()),
        "this is a fault of etalon or of the driver: please report it with the output of `etalon info`");
}

std::string describe_error(const Film& film, Renderer renderer)
{
    const std::optional<ErrorEstimate> error = estimate_error(film);
    const bool traced = renderer == Renderer::path || renderer == Renderer::reference;
    if (!error) return traced ? "not known from one sample per pixel" : "not measured";
    return fmt::format("{:.3g}% (95% interval {:.3g}% to {:.3g}%)", error->relative * 100, error->low * 100,
                       error->high * 100);
}

}  // namespace etalon::cli
