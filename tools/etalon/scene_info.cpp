#include "tools/etalon/scene_info.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "engine/scene/footprint.h"
#include "engine/scene/inventory.h"
#include "engine/scene/pose.h"
#include "tools/etalon/json.h"
#include "tools/etalon/scenes.h"
#include "tools/etalon/settings.h"
#include "tools/etalon/terminal.h"

namespace etalon::cli {
namespace {

/// What rendering the scene as its file has it would take, by renderer.
struct Needs {
    ivec2 size{0};
    std::vector<std::pair<Renderer, Footprint>> rows;
};

Needs needs_of(const Scene& scene, const Arguments& arguments)
{
    PoseSettings settings;
    settings.no_environment = true;
    settings.limits = limits(arguments);
    const PosedScene posed = pose(scene, settings);
    Needs needs{.size = ivec2(posed.view.width, posed.view.height), .rows = {}};
    for (const Renderer renderer :
         {Renderer::raster, Renderer::path, Renderer::reference, Renderer::reference_raster}) {
        RenderSettings render;
        render.renderer = renderer;
        needs.rows.emplace_back(renderer, predict(posed, render));
    }
    return needs;
}

/// "cameras (2)" and a line for each; nothing where there is none.
template <typename Rows, typename Describe>
std::string section(std::string_view title, const Rows& rows, const Describe& describe)
{
    if (rows.empty()) return {};
    std::string text = fmt::format("{} ({})\n", title, rows.size());
    for (std::size_t i = 0; i < rows.size(); ++i) text += fmt::format("  {} {}\n", i, describe(rows[i]));
    return text;
}

std::string called(const std::string& name)
{
    return name.empty() ? "(no name)" : name;
}

std::string projection(const Inventory::CameraRow& camera)
{
    const std::string lens = camera.has_lens ? ", thin lens" : "";
    if (camera.orthographic) return fmt::format("orthographic, half height {:.4g} m{}", camera.ymag, lens);
    return fmt::format("perspective, {:.4g} degrees{}", camera.yfov, lens);
}

std::string as_text(const Inventory& scene, const Needs& needs)
{
    std::string text = fmt::format(
        "nodes {}, meshes {}, primitives {}, vertices {}, triangles {}, lines {}, points {}, spheres {}, instances {}\n"
        "holds: geometry {}, textures {}\n",
        scene.nodes, scene.meshes, scene.primitives, scene.vertices, scene.triangles, scene.lines, scene.points,
        scene.spheres, scene.instances, describe_bytes(scene.geometry_bytes), describe_bytes(scene.texture_bytes));
    text += fmt::format("memory to render it at {}x{}, predicted\n", needs.size.x, needs.size.y);
    for (const auto& [renderer, need] : needs.rows)
        text += fmt::format("  {} about {} ({})\n", name(renderer), describe_bytes(need.total()), describe(need));
    const auto as_is = [](const std::string& name) { return called(name); };
    text += section("scenes", scene.roots, [](const Inventory::RootRow& row) {
        return fmt::format("{}, {} nodes{}", called(row.name), row.nodes, row.is_default ? ", the default" : "");
    });
    text +=
        section("cameras", scene.cameras, [](const auto& row) { return called(row.name) + ", " + projection(row); });
    text += section("lights", scene.lights, [](const Inventory::LightRow& row) {
        return fmt::format("{}, {}, {:.4g} {}", called(row.name), row.type, row.intensity,
                           row.type == "directional" ? "lux" : "candela");
    });
    text += section("materials", scene.materials, [](const Inventory::MaterialRow& row) {
        return fmt::format("{}, {}, {}, {} textures{}{}", called(row.name), row.model, row.alpha, row.textures,
                           row.emits ? ", emits" : "", row.double_sided ? ", double sided" : "") +
               (row.layers.empty() ? "" : fmt::format(", {}", fmt::join(row.layers, " + ")));
    });
    text += section("images", scene.images, [](const Inventory::ImageRow& row) {
        return fmt::format("{}, {}x{}, {} bits", called(row.name), row.width, row.height, row.bits);
    });
    text += section("skins", scene.skins, [](const Inventory::SkinRow& row) {
        return fmt::format("{}, {} joints", called(row.name), row.joints);
    });
    if (scene.morph_targets > 0) text += fmt::format("morph targets of all primitives: {}\n", scene.morph_targets);
    text += section("animations", scene.animations, [](const Inventory::AnimationRow& row) {
        return fmt::format("{}, {:.4g} s, {} channels, {} keys", called(row.name), row.duration, row.channels,
                           row.keys);
    });
    text += section("variants", scene.variants, as_is);
    text += section("broken rules of glTF", scene.broken_rules, [](const std::string& rule) { return rule; });
    text += section("metadata", scene.metadata, [](const Metadata& row) { return row.name + ": " + row.value; });
    return text;
}

template <typename Rows, typename Convert>
Json list(const Rows& rows, const Convert& convert)
{
    std::vector<Json> values;
    for (const auto& row : rows) values.push_back(convert(row));
    return values;
}

Json as_json(const Footprint& need)
{
    return Json::object({{"program", need.program},
                         {"geometry", need.geometry},
                         {"textures", need.textures},
                         {"picture", need.picture},
                         {"total", need.total()}});
}

Json as_json(const Inventory& scene, const Needs& needs, const std::string& scene_name)
{
    const Json roots = list(scene.roots, [](const Inventory::RootRow& row) {
        return Json::object({{"name", row.name}, {"nodes", row.nodes}, {"default", row.is_default}});
    });
    const Json cameras = list(scene.cameras, [](const Inventory::CameraRow& row) {
        return Json::object({{"name", row.name},
                             {"orthographic", row.orthographic},
                             {"yfov_degrees", row.orthographic ? Json() : Json(row.yfov)},
                             {"ymag", row.orthographic ? Json(row.ymag) : Json()},
                             {"thin_lens", row.has_lens}});
    });
    const Json lights = list(scene.lights, [](const Inventory::LightRow& row) {
        return Json::object({{"name", row.name}, {"type", row.type}, {"intensity", row.intensity}});
    });
    const Json materials = list(scene.materials, [](const Inventory::MaterialRow& row) {
        return Json::object({{"name", row.name},
                             {"model", row.model},
                             {"alpha", row.alpha},
                             {"textures", row.textures},
                             {"emits", row.emits},
                             {"double_sided", row.double_sided},
                             {"layers", row.layers}});
    });
    const Json images = list(scene.images, [](const Inventory::ImageRow& row) {
        return Json::object({{"name", row.name}, {"width", row.width}, {"height", row.height}, {"bits", row.bits}});
    });
    const Json animations = list(scene.animations, [](const Inventory::AnimationRow& row) {
        return Json::object(
            {{"name", row.name}, {"duration_seconds", row.duration}, {"channels", row.channels}, {"keys", row.keys}});
    });
    const Json skins = list(scene.skins, [](const Inventory::SkinRow& row) {
        return Json::object({{"name", row.name}, {"joints", row.joints}});
    });
    const Json metadata = list(scene.metadata, [](const Metadata& row) {
        return Json::object({{"name", row.name}, {"value", row.value}});
    });
    const Json counts = Json::object({{"nodes", scene.nodes},
                                      {"meshes", scene.meshes},
                                      {"primitives", scene.primitives},
                                      {"vertices", scene.vertices},
                                      {"triangles", scene.triangles},
                                      {"lines", scene.lines},
                                      {"points", scene.points},
                                      {"spheres", scene.spheres},
                                      {"instances", scene.instances},
                                      {"morph_targets", scene.morph_targets}});
    const Json bytes = Json::object({{"geometry", scene.geometry_bytes}, {"textures", scene.texture_bytes}});
    std::vector<std::pair<std::string, Json>> predicted;
    for (const auto& [renderer, need] : needs.rows) predicted.emplace_back(name(renderer), as_json(need));
    return Json::object({{"schema", "etalon-scene/1"},
                         {"scene", scene_name},
                         {"counts", counts},
                         {"bytes", bytes},
                         {"picture", Json::object({{"width", needs.size.x}, {"height", needs.size.y}})},
                         {"predicted_bytes", Json::object(predicted)},
                         {"scenes", roots},
                         {"cameras", cameras},
                         {"lights", lights},
                         {"materials", materials},
                         {"images", images},
                         {"skins", skins},
                         {"animations", animations},
                         {"variants", scene.variants},
                         {"metadata", metadata},
                         {"warnings", scene.warnings},
                         {"broken_rules", scene.broken_rules}});
}

}  // namespace

int scene_info(const Arguments& arguments)
{
    const std::string& name = arguments.positional().front();
    const Scene scene = open_scene(name, arguments);
    const Inventory inventory = describe(scene);
    const Needs needs = needs_of(scene, arguments);
    put(arguments.has("json") ? as_json(inventory, needs, name).text() + "\n" : as_text(inventory, needs));
    return 0;
}

}  // namespace etalon::cli
