#include "tools/etalon/renderers.h"

#include <fmt/format.h>

#include <algorithm>

#include "engine/base/error.h"
#include "engine/image/ahead.h"
#include "engine/reference/post.h"
#include "engine/reference/reference.h"
#include "engine/render/post.h"
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

std::optional<AdaptiveGoal> adaptive_goal(const Arguments& arguments)
{
    if (find_option(arguments.command(), "adaptive") == nullptr || arguments.choice("adaptive") == 0)
        return std::nullopt;
    return arguments.choice("adaptive") == 1 ? AdaptiveGoal::error : AdaptiveGoal::relmse;
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
    const Camera& camera = posed.view.camera;
    if (camera.lens)
        data["lens"] = fmt::format("radius={} focus={} blades={}", camera.lens->aperture_radius,
                                   camera.lens->focus_distance, camera.lens->blades);
    if (camera.equirectangular || camera.orthographic)
        data["projection"] = camera.equirectangular ? "equirectangular" : fmt::format("orthographic {}", camera.ymag);
    data["error"] = describe_error(film, settings.renderer);
}

}  // namespace

Renderers::Renderers(const Arguments& arguments)
    : options_(device_options(arguments)),
      may_fall_back_(arguments.choice("backend") == 0 && options_.device.empty()),
      memory_(limits(arguments).memory),
      profile_(find_option(arguments.command(), "profile") != nullptr && arguments.has("profile")),
      adaptive_(adaptive_goal(arguments))
{}

gpu::Device& Renderers::device(Renderer renderer)
{
    if (renderer == Renderer::path && options_.backend == gpu::Backend::opengl)
        throw Error(Blame::input, "the path tracer draws by Vulkan alone, not by OpenGL",
                    "leave out --backend opengl, or use --renderer reference");
    if (device_ && !(renderer == Renderer::path && device_->backend() == gpu::Backend::opengl)) return *device_;
    prepared_.reset();  // it lives on the device that goes
    try {
        device_.emplace(options_);
    } catch (Error& vulkan) {
        // The machine's lack is met here, because only here is it known what else may draw.
        if (!may_fall_back_ || renderer != Renderer::raster || vulkan.blame() != Blame::machine) throw;
        gpu::DeviceOptions other = options_;
        other.backend = gpu::Backend::opengl;
        try {
            device_.emplace(other);
        } catch (const Error& opengl) {
            throw vulkan.at(fmt::format("--backend auto; OpenGL would not do either: {}", opengl.what()));
        }
    }
    return *device_;
}

Drawn Renderers::draw(const std::string& scene_name, const PosedScene& posed, const RenderSettings& settings,
                      const Progress& progress, const Checkpoints& checkpoints)
{
    const Requirements required = require(posed, settings);
    Film film;
    try {
        check_memory(predict(posed, settings), memory_);
        if (!pictures_ahead_.joinable()) pictures_ahead_ = load_pictures_ahead();
        switch (settings.renderer) {
            case Renderer::raster:
                film = render_raster(device(settings.renderer), posed, required, settings, progress);
                break;
            case Renderer::path:
                film = adaptive_
                           ? render_path_adaptively(device(settings.renderer), posed, required, settings, *adaptive_,
                                                    progress)
                           : render_path(device(settings.renderer), posed, required, settings, progress, checkpoints,
                                         profile_ ? KernelTimes::measured : KernelTimes::unknown);
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
    if (needs_device(settings.renderer)) film.metadata["backend"] = gpu::name(device(settings.renderer).backend());
    check_validation();
    drawn.film = std::move(film);
    return drawn;
}

Film Renderers::draw_again(const std::string& scene_name, const PosedScene& posed, const RenderSettings& settings,
                           const Progress& progress)
{
    if (!needs_device(settings.renderer)) return draw(scene_name, posed, settings, progress).film;
    const Footprint need = predict(posed, settings);
    check_memory(need, memory_);
    try {
        // Half of the memory may hold scenes that wait for their next picture.
        constexpr std::uint64_t kMostKept = 64;
        const std::uint64_t each = std::max<std::uint64_t>(need.geometry + need.textures + need.picture, 1);
        if (!prepared_)
            prepared_.emplace(device(settings.renderer), posed,
                              std::clamp<std::uint64_t>(memory_ / 2 / each, 1, kMostKept));
        Film film = prepared_->draw(settings, progress);
        check_validation();
        return film;
    } catch (Error& error) {
        error.at(fmt::format("{}, {}", scene_name, label(settings.renderer)));
        throw;
    }
}

Film Renderers::post(Film film, const PostChain& chain, Renderer renderer, std::vector<StageTime>& stages)
{
    if (chain.empty()) return film;
    film = needs_device(renderer) ? apply_post(device(Renderer::raster), std::move(film), chain)
                                  : reference::apply_post(std::move(film), chain);
    for (StageTime& stage : take_stages(film)) stages.push_back(std::move(stage));
    check_validation();
    film.metadata["error"] = describe_error(film, renderer);
    return film;
}

std::string Renderers::device_of(Renderer renderer)
{
    return needs_device(renderer) ? device(renderer).description() : "CPU, double precision";
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
    throw Error(Blame::machine,
                fmt::format("{} found {} faults; the first: {}",
                            device_->backend() == gpu::Backend::vulkan ? "the Vulkan validation layers" : "OpenGL",
                            messages.size(), messages.front()),
                "this is a fault of etalon or of the driver: please report it with the output of `etalon info`");
}

std::string describe_error(const Film& film, Renderer renderer)
{
    const std::optional<ErrorEstimate> error = estimate_error(film);
    const bool traced = renderer == Renderer::path || renderer == Renderer::reference;
    const std::string bias = film.metadata.contains("degraded") ? ", without the bias of --degrade, not measured" : "";
    if (!error && film.metadata.contains("post")) return "not measured after post passes";
    if (!error) return (traced ? "not known from one sample per pixel" : "not measured") + bias;
    return fmt::format("{:.3g}% (95% interval {:.3g}% to {:.3g}%){}", error->relative * 100, error->low * 100,
                       error->high * 100, bias);
}

}  // namespace etalon::cli
