#include <fmt/format.h>

#include <algorithm>
#include <optional>

#include "engine/base/error.h"
#include "engine/measure/text.h"
#include "engine/render/costs.h"
#include "engine/render/render.h"
#include "engine/scene/requirements.h"
#include "tools/etalon/arguments.h"
#include "tools/etalon/json.h"
#include "tools/etalon/renderers.h"
#include "tools/etalon/scenes.h"
#include "tools/etalon/settings.h"
#include "tools/etalon/stopwatch.h"
#include "tools/etalon/terminal.h"

namespace etalon::cli {
namespace {

std::size_t count(const std::vector<bool>& used)
{
    return static_cast<std::size_t>(std::count(used.begin(), used.end(), true));
}

/// --measure: the picture as the scene requires it, and with everything on.
struct Measured {
    double first = 0, again = 0;            ///< seconds: with scene and pipelines, and the best of three more
    double first_uber = 0, again_uber = 0;  ///< the same with every requirement set
    bool identical = false;                 ///< to the bit
};

Measured measure(const PosedScene& posed, const Requirements& required, const RenderSettings& settings,
                 const gpu::DeviceOptions& options)
{
    const auto draw = [&](gpu::Device& device, const Requirements& how) {
        return settings.renderer == Renderer::path ? render_path(device, posed, how, settings, {})
                                                   : render_raster(device, posed, how, settings, {});
    };
    // A device of its own for each: what one has compiled must not serve the other.
    const auto timed = [&](const Requirements& how, double& first, double& again) {
        gpu::Device device(options);
        Stopwatch stopwatch;
        Film film = draw(device, how);
        first = stopwatch.lap();
        for (int i = 0; i < 3; ++i) {
            draw(device, how);
            const double seconds = stopwatch.lap();
            again = i == 0 ? seconds : std::min(again, seconds);
        }
        return film;
    };
    Measured out;
    const Film special = timed(required, out.first, out.again);
    const Film uber = timed(everything(required), out.first_uber, out.again_uber);
    out.identical = special.mean == uber.mean && special.alpha == uber.alpha;
    return out;
}

std::string costs_text(const SceneCosts& costs, const Requirements& required, const std::optional<Measured>& measured)
{
    std::vector<TableRow> rows = {{"shader", "instructions, all", "for this scene", "", "variants"}};
    for (const ShaderCost& shader : costs.shaders)
        rows.push_back({shader.shader, fmt::format("{}", shader.written), fmt::format("{}", shader.special),
                        fmt::format("{:.0f}%", 100.0 * double(shader.special) / double(shader.written)),
                        fmt::format("{}", shader.variants)});
    std::string text = "\n" + aligned(rows);
    text +=
        fmt::format("attributes of a triangle: {} of {} bytes; textures: {:.1f} of {:.1f} MB\n", costs.vertex_bytes,
                    costs.vertex_bytes_uber, double(costs.texture_bytes) / 1e6, double(costs.texture_bytes_uber) / 1e6);
    text += fmt::format("models {} of {} features: {:.0f}% of the instructions", required.bits.count(), kFeatureCount,
                        100.0 * double(costs.special()) / double(std::max<std::size_t>(costs.written(), 1)));
    if (measured)
        text += fmt::format(
            ", {:.2f} × the time ({:.3g} of {:.3g} s a picture with its scene, the first {:.3g} of {:.3g} s); pixels "
            "{}",
            measured->again / measured->again_uber, measured->again, measured->again_uber, measured->first,
            measured->first_uber, measured->identical ? "identical" : "DIFFER");
    return text + "\n";
}

Json costs_json(const SceneCosts& costs, const std::optional<Measured>& measured)
{
    std::vector<Json> shaders;
    for (const ShaderCost& shader : costs.shaders)
        shaders.push_back(Json::object({{"shader", shader.shader},
                                        {"instructions", shader.written},
                                        {"instructions_specialised", shader.special},
                                        {"variants", shader.variants}}));
    Json times;
    if (measured)
        times = Json::object({{"seconds", measured->again},
                              {"seconds_uber", measured->again_uber},
                              {"first_seconds", measured->first},
                              {"first_seconds_uber", measured->first_uber},
                              {"identical", measured->identical}});
    return Json::object({{"shaders", shaders},
                         {"attribute_bytes", costs.vertex_bytes},
                         {"attribute_bytes_uber", costs.vertex_bytes_uber},
                         {"texture_bytes", costs.texture_bytes},
                         {"texture_bytes_uber", costs.texture_bytes_uber},
                         {"measured", times}});
}

std::string as_text(const Requirements& required, const Scene& scene)
{
    std::string text;
    for (std::size_t i = 0; i < kFeatureCount; ++i)
        if (required.bits[i]) text += fmt::format("{:<28}{}\n", name(static_cast<Feature>(i)), required.cause[i]);
    return text + fmt::format("{} of {} features; {} of {} textures, {} of {} materials\n", required.bits.count(),
                              kFeatureCount, count(required.texture_used), scene.textures.size(),
                              count(required.material_used), scene.materials.size());
}

std::string as_json(const Requirements& required, const Scene& scene, Renderer renderer, const Json& costs)
{
    std::vector<Json> features;
    std::vector<std::string> absent;
    for (std::size_t i = 0; i < kFeatureCount; ++i) {
        const std::string_view feature = name(static_cast<Feature>(i));
        if (required.bits[i])
            features.push_back(Json::object({{"name", feature}, {"cause", required.cause[i]}}));
        else
            absent.emplace_back(feature);
    }
    const auto used = [](std::size_t n, std::size_t of) { return Json::object({{"used", n}, {"of", of}}); };
    return Json::object({{"schema", "etalon-explain/1"},
                         {"scene", scene.name},
                         {"renderer", name(renderer)},
                         {"required", features},
                         {"not_required", absent},
                         {"textures", used(count(required.texture_used), scene.textures.size())},
                         {"materials", used(count(required.material_used), scene.materials.size())},
                         {"costs", costs}})
               .text() +
           "\n";
}

}  // namespace

int explain(const Arguments& arguments)
{
    const RenderSettings settings = render_settings(arguments);
    const PoseSettings view = pose_settings(arguments);
    const Scene scene = open_scene(arguments.positional().front(), arguments);
    const PosedScene posed = pose(scene, view);
    const Requirements required = require(posed, settings);
    const bool on_device = settings.renderer == Renderer::raster || settings.renderer == Renderer::path;
    if (arguments.has("measure") && !on_device)
        throw Error(Blame::input, "--measure is of pipelines, which the references do not have",
                    "leave it out, or use --renderer path");
    std::optional<SceneCosts> costs;
    if (on_device) costs = scene_costs(posed, required, settings);
    std::optional<Measured> measured;
    if (arguments.has("measure")) measured = measure(posed, required, settings, device_options(arguments));
    if (arguments.has("json"))
        put(as_json(required, scene, settings.renderer, costs ? costs_json(*costs, measured) : Json()));
    else
        put(as_text(required, scene) + (costs ? costs_text(*costs, required, measured) : ""));
    return !measured || measured->identical ? 0 : 1;
}

}  // namespace etalon::cli
