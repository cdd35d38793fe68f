#include "engine/scene/load.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <filesystem>

#include "engine/base/error.h"
#include "engine/base/files.h"
#include "engine/base/nearest.h"
#include "engine/scene/extensions.h"
#include "engine/scene/gltf_import.h"
#include "engine/scene/simplify.h"

namespace etalon {

namespace {

constexpr std::string_view kBuiltinPrefix = "builtin:";

// The index of the variant of this name.
Index variant_of(const Scene& scene, const std::string& name)
{
    const auto found = std::find(scene.variants.begin(), scene.variants.end(), name);
    if (found != scene.variants.end()) return static_cast<Index>(found - scene.variants.begin());
    std::string mend = "the file has no material variants";
    if (const std::string_view meant = nearest(name, scene.variants); !meant.empty())
        mend = fmt::format("did you mean \"{}\"?", meant);
    else if (!scene.variants.empty())
        mend = fmt::format("choose one of: {}", fmt::join(scene.variants, ", "));
    throw Error(Blame::input, fmt::format("no material variant \"{}\"", name), mend);
}

void refuse_warnings(const Scene& scene)
{
    const std::size_t count = scene.warnings.size() + scene.broken_rules.size();
    if (count == 0) return;
    throw Error(Blame::input,
                (scene.warnings.empty() ? scene.broken_rules : scene.warnings).front() +
                    (count == 1 ? "" : fmt::format(" (and {} more)", count - 1)),
                "leave out --strict to go on with warnings");
}

}  // namespace

Scene parse_gltf(std::span<const std::byte> bytes, const std::filesystem::path& folder, const std::string& name,
                 const LoadOptions& options)
{
    const CheckedGltf checked = preflight(bytes, folder, options.limits);
    const gltf::Model model = gltf::parse_model(checked.json);
    Scene scene;
    scene.name = name;
    gltf::list_variants(model, scene);
    gltf::list_metadata(model, scene);
    const gltf::Decoded decoded = gltf::decode_compressed(model, checked, options.limits);
    const gltf::Source source{
        model, checked, decoded, folder, options.variant ? variant_of(scene, *options.variant) : kNone, options.limits};
    scene.warnings = checked.warnings;
    scene.broken_rules = checked.broken_rules;
    for (std::string& warning : warnings_for_extensions(model.extensionsUsed))
        scene.warnings.push_back(std::move(warning));
    gltf::import_materials(source, scene);
    share_equal_images(scene);
    gltf::import_meshes(source, scene);
    gltf::import_nodes(source, scene);
    gltf::import_skins(source, scene);
    gltf::import_animations(source, scene);
    if (options.strict) refuse_warnings(scene);
    return scene;
}

Scene load_scene(const std::string& path_or_name, const LoadOptions& options)
{
    if (path_or_name.starts_with(kBuiltinPrefix)) {
        Scene scene = make_builtin(std::string_view(path_or_name).substr(kBuiltinPrefix.size()));
        if (options.variant) variant_of(scene, *options.variant);
        return scene;
    }
    const std::filesystem::path path = path_or_name;
    const std::vector<std::byte> bytes = read_file(path);
    try {
        return parse_gltf(bytes, path.parent_path(), path.filename().string(), options);
    } catch (Error& error) {
        throw error.at(path_or_name);
    }
}

}  // namespace etalon
