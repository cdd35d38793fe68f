#include "tools/etalon/scene_info.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "engine/scene/inventory.h"
#include "tools/etalon/json.h"
#include "tools/etalon/scenes.h"
#include "tools/etalon/terminal.h"

namespace etalon::cli {
namespace {

std::string mebibytes(std::uint64_t bytes)
{
    return fmt::format("{:.1f} MiB", static_cast<double>(bytes) / (1 << 20));
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

std::string as_text(const Inventory& scene)
{
    std::string text = fmt::format(
        "nodes {}, meshes {}, primitives {}, vertices {}, triangles {}, lines {}, points {}, spheres {}, instances {}\n"
        "memory: about {} (geometry {}, textures {})\n",
        scene.nodes, scene.meshes, scene.primitives, scene.vertices, scene.triangles, scene.lines, scene.points,
        scene.spheres, scene.instances, mebibytes(scene.total_bytes()), mebibytes(scene.geometry_bytes),
        mebibytes(scene.texture_bytes));
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

Json as_json(const Inventory& scene, const std::string& name)
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
    const Json bytes = Json::object(
        {{"geometry", scene.geometry_bytes}, {"textures", scene.texture_bytes}, {"total", scene.total_bytes()}});
    return Json::object({{"schema", "etalon-scene/1"},
                         {"scene", name},
                         {"counts", counts},
                         {"predicted_bytes", bytes},
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
    const Inventory scene = describe(open_scene(name, arguments));
    put(arguments.has("json") ? as_json(scene, name).text() + "\n" : as_text(scene));
    return 0;
}

}  // namespace etalon::cli
