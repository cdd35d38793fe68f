#include "engine/scene/inventory.h"

#include <algorithm>
#include <array>

#include "engine/base/error.h"

namespace etalon {

namespace {

std::string name_of(BsdfModel model)
{
    constexpr std::array kNames = {"metallic-roughness", "unlit",      "lambert",          "mirror",
                                   "rough-conductor",    "dielectric", "rough-dielectric", "specular-glossiness"};
    return kNames[static_cast<std::size_t>(model)];
}

std::string name_of(AlphaMode mode)
{
    constexpr std::array kNames = {"opaque", "mask", "blend"};
    return kNames[static_cast<std::size_t>(mode)];
}

std::string name_of(LightType type)
{
    constexpr std::array kNames = {"point", "spot", "directional"};
    return kNames[static_cast<std::size_t>(type)];
}

std::size_t nodes_below(const Scene& scene, const SceneRoot& root)
{
    std::vector<bool> seen(scene.nodes.size());
    std::vector<Index> pending = root.nodes;
    std::size_t count = 0;
    while (!pending.empty()) {
        const Index index = pending.back();
        pending.pop_back();
        assume(index < scene.nodes.size());
        if (seen[index]) continue;
        seen[index] = true;
        ++count;
        const auto& children = scene.nodes[index].children;
        pending.insert(pending.end(), children.begin(), children.end());
    }
    return count;
}

void add_geometry(const Scene& scene, Inventory& out)
{
    const auto bytes = [](const auto& attribute) { return attribute.size() * sizeof(attribute[0]); };
    out.meshes = scene.meshes.size();
    for (const Mesh& mesh : scene.meshes)
        for (const Primitive& p : mesh.primitives) {
            ++out.primitives;
            out.vertices += p.positions.size();
            switch (p.topology) {
                case Topology::triangles:
                    out.triangles += p.indices.size() / 3;
                    break;
                case Topology::lines:
                    out.lines += p.indices.size() / 2;
                    break;
                case Topology::points:
                    out.points += p.indices.size();
                    break;
            }
            out.geometry_bytes += bytes(p.positions) + bytes(p.normals) + bytes(p.tangents) + bytes(p.uv[0]) +
                                  bytes(p.uv[1]) + bytes(p.colors) + bytes(p.indices) + bytes(p.influences);
            out.morph_targets += p.targets.size();
            for (const MorphTarget& target : p.targets)
                out.geometry_bytes += bytes(target.positions) + bytes(target.normals) + bytes(target.tangents);
        }
}

std::vector<std::string> names_of(const MaterialLayers& layers)
{
    std::vector<std::string> out;
    const auto add = [&](bool present, const char* name) {
        if (present) out.emplace_back(name);
    };
    add(layers.ior != 1.5, "ior");
    add(layers.specular != 1 || layers.specular_color != dvec3(1) || layers.specular_texture.present() ||
            layers.specular_color_texture.present(),
        "specular");
    add(layers.clearcoat > 0, "clearcoat");
    add(layers.sheen_color != dvec3(0), "sheen");
    add(layers.transmission > 0, "transmission");
    add(layers.volumetric(), "volume");
    add(layers.volumetric() && layers.dispersion > 0, "dispersion");
    add(layers.iridescence > 0, "iridescence");
    add(layers.anisotropy > 0, "anisotropy");
    add(layers.diffuse_transmission > 0, "diffuse-transmission");
    return out;
}

int textures_of(const Material& m)
{
    int count = 0;
    for (const TextureUse* use : {&m.base_color_texture, &m.metallic_roughness_texture, &m.normal_texture,
                                  &m.occlusion_texture, &m.emissive_texture})
        count += use->present();
    if (!m.layers) return count;
    const MaterialLayers& l = *m.layers;
    for (const TextureUse* use :
         {&l.specular_texture, &l.specular_color_texture, &l.clearcoat_texture, &l.clearcoat_roughness_texture,
          &l.clearcoat_normal_texture, &l.sheen_color_texture, &l.sheen_roughness_texture, &l.transmission_texture,
          &l.thickness_texture, &l.iridescence_texture, &l.iridescence_thickness_texture, &l.anisotropy_texture,
          &l.diffuse_transmission_texture, &l.diffuse_transmission_color_texture})
        count += use->present();
    return count;
}

void add_materials(const Scene& scene, Inventory& out)
{
    for (const Material& m : scene.materials)
        out.materials.push_back({.name = m.name,
                                 .model = name_of(m.model),
                                 .alpha = name_of(m.alpha_mode),
                                 .textures = textures_of(m),
                                 .emits = m.emission != dvec3(0),
                                 .double_sided = m.double_sided,
                                 .layers = m.layers ? names_of(*m.layers) : std::vector<std::string>{}});
    for (std::size_t i = 0; i < scene.images.size(); ++i) {
        const Texels& image = scene.images[i];
        const auto user =
            std::find_if(scene.textures.begin(), scene.textures.end(), [&](const Texture& t) { return t.image == i; });
        out.images.push_back({.name = user == scene.textures.end() ? "" : user->name,
                              .width = image.width,
                              .height = image.height,
                              .bits = image.is_8_bit ? 8 : 16});
        const std::uint64_t texels = std::uint64_t(image.width) * std::uint64_t(image.height);
        out.texture_bytes += texels * (image.is_8_bit ? 4 : 16) * 4 / 3;
    }
}

}  // namespace

Inventory describe(const Scene& scene)
{
    Inventory out;
    for (std::size_t i = 0; i < scene.roots.size(); ++i)
        out.roots.push_back({scene.roots[i].name, nodes_below(scene, scene.roots[i]), i == scene.default_root});
    for (Index i = 0; i < scene.cameras.size(); ++i) {
        const Camera& camera = scene.cameras[i];
        const auto node =
            std::find_if(scene.nodes.begin(), scene.nodes.end(), [&](const Node& n) { return n.camera == i; });
        out.cameras.push_back({.name = !camera.name.empty() || node == scene.nodes.end() ? camera.name : node->name,
                               .orthographic = camera.orthographic,
                               .yfov = camera.yfov * 180 / kPi,
                               .ymag = camera.ymag,
                               .has_lens = camera.lens.has_value()});
    }
    for (const Light& light : scene.lights) out.lights.push_back({light.name, name_of(light.type), light.intensity});
    add_materials(scene, out);
    add_geometry(scene, out);
    out.nodes = scene.nodes.size();
    for (const Node& node : scene.nodes) {
        out.spheres += node.sphere.has_value();
        out.instances += node.instances.size();
    }
    out.variants = scene.variants;
    out.metadata = scene.metadata;
    for (const Animation& a : scene.animations) {
        std::size_t keys = 0;
        for (const AnimationSampler& sampler : a.samplers) keys += sampler.times.size();
        out.animations.push_back({a.name, a.duration, a.channels.size(), keys});
    }
    for (const Skin& skin : scene.skins) out.skins.push_back({skin.name, skin.joints.size()});
    out.warnings = scene.warnings;
    out.broken_rules = scene.broken_rules;
    return out;
}

}  // namespace etalon
