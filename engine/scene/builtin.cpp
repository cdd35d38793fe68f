#include <fmt/format.h>

#include <array>

#include "engine/base/error.h"
#include "engine/scene/builtin_scenes.h"
#include "engine/scene/load.h"

namespace etalon {

namespace {

struct Row {
    BuiltinScene scene;
    Scene (*make)();
};

constexpr std::array kRows = {
    Row{{"cornell", "the Cornell box: one-sided area light, two white blocks, red and green walls"}, builtin::cornell},
    Row{{"spheres", "a grid of smooth spheres, metallic by roughness, in the studio environment"}, builtin::spheres},
    Row{{"texture-plane", "a checkered plane to the horizon: minification and mipmaps"}, builtin::texture_plane},
    Row{{"furnace", "exact spheres that reflect all light, in constant light 1: nothing may exceed 1"},
        builtin::furnace},
    Row{{"furnace-lambert", "an exact sphere of albedo 0.5 in constant light 1: 0.5 exactly"},
        builtin::furnace_lambert},
    Row{{"lights", "a point, a spot and a directional light on matt surfaces"}, builtin::lights},
    Row{{"alpha", "masked, blended and double-sided leaves before a wall"}, builtin::alpha},
    Row{{"normals", "a normal-mapped floor and sphere under a directional light"}, builtin::normals},
    Row{{"maps", "metallic-roughness, occlusion and emissive textures, a second uv set, a texture transform"},
        builtin::maps},
    Row{{"instances", "1,000 instanced boxes under sun and sky"}, builtin::instances},
    Row{{"blinn-phong", "glossy spheres under a directional and a point light, for highlights"}, builtin::blinn_phong},
    Row{{"glass", "mirror, glass, rough glass and rough gold: the exact BSDFs"}, builtin::glass},
    Row{{"triangle", "one triangle with a colour at each corner"}, builtin::triangle},
    Row{{"wires", "lines and points beside triangles"}, builtin::wires},
    Row{{"orthographic", "boxes through an orthographic camera"}, builtin::orthographic},
    Row{{"thin-lens", "boxes through a lens that has one plane in focus"}, builtin::thin_lens},
    Row{{"siemens-star", "72 white spokes: what a renderer leaves of detail finer than a pixel"},
        builtin::siemens_star},
    Row{{"specular", "other indices of refraction, specular strength and colour"}, builtin::specular},
    Row{{"clearcoat", "varnish, in places, and with a normal map of its own"}, builtin::clearcoat},
    Row{{"sheen", "satin and velvet"}, builtin::sheen},
    Row{{"transmission", "thin panes, tinted, frosted and in stripes"}, builtin::transmission},
    Row{{"volume", "bodies that refract and absorb"}, builtin::volume},
    Row{{"iridescence", "thin films on plastic and metal"}, builtin::iridescence},
    Row{{"anisotropy", "brushed metal, along, across and in circles"}, builtin::anisotropy},
    Row{{"dispersion", "flint glass that parts colours"}, builtin::dispersion},
    Row{{"diffuse-transmission", "a leaf, paper and stained paper before the sun"}, builtin::diffuse_transmission},
    Row{{"specular-glossiness", "the older material model: plastic, gold, and maps"}, builtin::specular_glossiness},
};

constexpr auto kScenes = [] {
    std::array<BuiltinScene, kRows.size()> out;
    for (std::size_t i = 0; i < kRows.size(); ++i) out[i] = kRows[i].scene;
    return out;
}();

}  // namespace

std::span<const BuiltinScene> builtin_scenes()
{
    return kScenes;
}

Scene make_builtin(std::string_view name)
{
    std::string names;
    for (const Row& row : kRows) {
        if (row.scene.name == name) return row.make();
        names += fmt::format("{}{}", names.empty() ? "" : ", ", row.scene.name);
    }
    throw Error(Blame::input, fmt::format("no built-in scene \"{}\"", name), "choose one of: " + names);
}

}  // namespace etalon
