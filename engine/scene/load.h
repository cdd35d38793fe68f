#pragma once
#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "engine/base/limits.h"
#include "engine/scene/scene.h"

namespace etalon {

struct LoadOptions {
    bool strict = false;  ///< warnings become errors
    Limits limits{};
    std::optional<std::string> variant;  ///< of KHR_materials_variants, by name; nothing: the file's own materials
};

/// Loads a .gltf or .glb file, or a built-in scene by name ("builtin:cornell"). External buffers and images are read
/// from beneath the file's folder only. Throws Error(input) with file, JSON pointer and mend. Normals are filled (flat)
/// and tangents computed (MikkTSpace) where a material needs them.
Scene load_scene(const std::string& path_or_name, const LoadOptions& options = {});

/// Loads glTF from memory (`.gltf` text or `.glb`, told apart by the magic); external URIs are resolved beneath
/// `folder`.
Scene parse_gltf(std::span<const std::byte> bytes, const std::filesystem::path& folder, const std::string& name,
                 const LoadOptions& options = {});

struct BuiltinScene {
    std::string_view name;     ///< "cornell"
    std::string_view summary;  ///< one line
};
/// The procedural scenes: cornell, spheres, texture-plane, furnace, …
std::span<const BuiltinScene> builtin_scenes();
Scene make_builtin(std::string_view name);

}  // namespace etalon
