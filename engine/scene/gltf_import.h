#pragma once
#include <filesystem>
#include <string>
#include <vector>

#include "engine/base/error.h"
#include "engine/scene/compressed.h"
#include "engine/scene/gltf_model.h"
#include "engine/scene/preflight.h"
#include "engine/scene/scene.h"

// The steps from a checked glTF file to a Scene, in the order in which they run. Each throws Error(input) with a JSON
// pointer.
namespace etalon::gltf {

struct Source {
    const Model& model;
    const CheckedGltf& file;
    const Decoded& decoded;
    std::filesystem::path folder;
    Index variant = kNone;  ///< into Scene::variants: whose materials are shown
    Limits limits{};
};

/// Fills variants. gltf_metadata.cpp
void list_variants(const Model& model, Scene& scene);
/// Fills metadata: KHR_xmp_json_ld's packet of the asset, each property in a line. gltf_metadata.cpp
void list_metadata(const Model& model, Scene& scene);

/// Fills materials, textures and images (those that a material uses, decoded). gltf_material.cpp
void import_materials(const Source& source, Scene& scene);
/// Fills meshes; appends materials for primitives without one. After import_materials. gltf_mesh.cpp
void import_meshes(const Source& source, Scene& scene);
/// Fills cameras, lights, nodes and roots. gltf_node.cpp
void import_nodes(const Source& source, Scene& scene);
/// Fills skins, and checks that they fit the meshes that nodes show with them. After import_nodes. gltf_skin.cpp
void import_skins(const Source& source, Scene& scene);
/// Fills animations. After all others. gltf_animation.cpp
void import_animations(const Source& source, Scene& scene);

// extras.etalon: what glTF cannot say. gltf_extras.cpp

/// materials[].extras.etalon: the exact BSDF and one-sided emission override what glTF says.
void apply_material_extras(const Value& extras, const std::string& pointer, Material& material);
/// nodes[].extras.etalon: an exact sphere.
std::optional<SphereShape> sphere_extras(const Value& extras, const std::string& pointer, std::size_t materials);
/// cameras[].extras.etalon.thin_lens
std::optional<ThinLens> lens_extras(const Value& extras, const std::string& pointer);
/// scenes[].extras.etalon: film size, path depth, environment (a file is read from beneath `folder`).
void apply_scene_extras(const Value& extras, const std::string& pointer, const std::filesystem::path& folder,
                        SceneRoot& root);

// Values of extensions and extras

/// The member `key` of an object; null when absent or when `value` is no object.
const Value* member(const Value& value, const std::string& key);
const Value* member(const tinygltf::ExtensionMap& extensions, const std::string& key);
/// A finite number within [low, high], or `standard` when absent.
double number(const Value& value, const std::string& key, const std::string& pointer, double standard, double low,
              double high);
/// Three such numbers.
dvec3 triple(const Value& value, const std::string& key, const std::string& pointer, const dvec3& standard, double low,
             double high);

Error fault(const std::string& pointer, std::string what,
            std::string mend = "export again, or repair the file by hand");

}  // namespace etalon::gltf
