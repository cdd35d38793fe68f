#include "engine/scene/load.h"

#include <fmt/format.h>

#include <filesystem>

#include "engine/base/error.h"
#include "engine/base/files.h"
#include "engine/scene/extensions.h"
#include "engine/scene/gltf_import.h"

namespace etalon {

namespace {

constexpr std::string_view kBuiltinPrefix = "builtin:";

void list_variants(const gltf::Model& model, Scene& scene)
{
    const gltf::Value* extension = gltf::member(model.extensions, "KHR_materials_variants");
    const gltf::Value* variants = extension == nullptr ? nullptr : gltf::member(*extension, "variants");
    for (std::size_t i = 0; variants != nullptr && i < variants->ArrayLen(); ++i) {
        const gltf::Value* name = gltf::member(variants->Get(static_cast<int>(i)), "name");
        scene.variants.push_back(name != nullptr && name->IsString() ? name->Get<std::string>()
                                                                     : fmt::format("variant {}", i));
    }
}

void refuse_warnings(const Scene& scene)
{
    if (scene.warnings.empty()) return;
    throw Error(Blame::input,
                scene.warnings.front() +
                    (scene.warnings.size() == 1 ? "" : fmt::format(" (and {} more)", scene.warnings.size() - 1)),
                "leave out --strict to go on with warnings");
}

}  // namespace

Scene parse_gltf(std::span<const std::byte> bytes, const std::filesystem::path& folder, const std::string& name,
                 const LoadOptions& options)
{
    const CheckedGltf checked = preflight(bytes, folder, options.limits);
    const gltf::Model model = gltf::parse_model(checked.json);
    const gltf::Source source{model, checked, folder};
    Scene scene;
    scene.name = name;
    scene.warnings = warnings_for_extensions(model.extensionsUsed);
    gltf::import_materials(source, scene);
    gltf::import_meshes(source, scene);
    gltf::import_nodes(source, scene);
    gltf::import_skins(source, scene);
    gltf::import_animations(source, scene);
    list_variants(model, scene);
    if (options.strict) refuse_warnings(scene);
    return scene;
}

Scene load_scene(const std::string& path_or_name, const LoadOptions& options)
{
    if (path_or_name.starts_with(kBuiltinPrefix))
        return make_builtin(std::string_view(path_or_name).substr(kBuiltinPrefix.size()));
    const std::filesystem::path path = path_or_name;
    const std::vector<std::byte> bytes = read_file(path);
    try {
        return parse_gltf(bytes, path.parent_path(), path.filename().string(), options);
    } catch (Error& error) {
        throw error.at(path_or_name);
    }
}

}  // namespace etalon
