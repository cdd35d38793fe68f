#include <fmt/format.h>

#include <algorithm>

#include "engine/scene/requirements.h"
#include "tools/etalon/arguments.h"
#include "tools/etalon/json.h"
#include "tools/etalon/renderers.h"
#include "tools/etalon/scenes.h"
#include "tools/etalon/settings.h"
#include "tools/etalon/terminal.h"

namespace etalon::cli {
namespace {

std::size_t count(const std::vector<bool>& used)
{
    return static_cast<std::size_t>(std::count(used.begin(), used.end(), true));
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

std::string as_json(const Requirements& required, const Scene& scene, Renderer renderer)
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
                         {"materials", used(count(required.material_used), scene.materials.size())}})
               .text() +
           "\n";
}

}  // namespace

int explain(const Arguments& arguments)
{
    const RenderSettings settings = render_settings(arguments);
    const PoseSettings view = pose_settings(arguments);
    const Scene scene = open_scene(arguments.positional().front(), arguments);
    const Requirements required = require(pose(scene, view), settings);
    put(arguments.has("json") ? as_json(required, scene, settings.renderer) : as_text(required, scene));
    return 0;
}

}  // namespace etalon::cli
