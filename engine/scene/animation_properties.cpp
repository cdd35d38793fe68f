#include <algorithm>
#include <charconv>
#include <limits>

#include "engine/base/error.h"
#include "engine/scene/animation.h"

namespace etalon {

namespace {

using Values = std::span<const double>;
using Table = std::vector<AnimatedProperty>;

constexpr double kAny = std::numeric_limits<double>::infinity();
constexpr double kTiny = 1e-9;  // where 0 has no meaning: angles of view, extents, distances

dvec3 triple(Values v)
{
    return dvec3(v[0], v[1], v[2]);
}

Trs& trs_of(const Scene& scene, Index node, Motion& motion)
{
    return motion.nodes.try_emplace(node, scene.nodes.at(node).trs.value_or(Trs{})).first->second;
}
Material& material_of(const Scene& scene, Index index, Motion& motion)
{
    return motion.materials.try_emplace(index, scene.materials.at(index)).first->second;
}
MaterialLayers& layers_of(const Scene& scene, Index index, Motion& motion)
{
    Material& material = material_of(scene, index, motion);
    return material.layers ? *material.layers : material.layers.emplace();
}

void add_nodes(Table& table)
{
    table.push_back({"/nodes/{}/translation", 3, false, -kAny, kAny,
                     [](const Scene& s, Index i, Values v, Motion& m) { trs_of(s, i, m).translation = triple(v); }});
    table.push_back({"/nodes/{}/rotation", 4, true, -kAny, kAny, [](const Scene& s, Index i, Values v, Motion& m) {
                         trs_of(s, i, m).rotation = dquat(v[3], v[0], v[1], v[2]);
                     }});
    table.push_back({"/nodes/{}/scale", 3, false, -kAny, kAny,
                     [](const Scene& s, Index i, Values v, Motion& m) { trs_of(s, i, m).scale = triple(v); }});
    table.push_back({"/nodes/{}/weights", 0, false, -kAny, kAny,
                     [](const Scene&, Index i, Values v, Motion& m) { m.weights[i].assign(v.begin(), v.end()); }});
    table.push_back({"/meshes/{}/weights", 0, false, -kAny, kAny,
                     [](const Scene&, Index i, Values v, Motion& m) { m.mesh_weights[i].assign(v.begin(), v.end()); }});
    table.push_back({"/nodes/{}/extensions/KHR_node_visibility/visible", 1, false, -kAny, kAny,
                     [](const Scene&, Index i, Values v, Motion& m) { m.visible[i] = v[0] != 0; }});
}

struct Row {
    const char* pointer;
    double low, high;
};

void add(Table& table, const Row& row, double Material::*member)
{
    table.push_back({std::string("/materials/{}") + row.pointer, 1, false, row.low, row.high,
                     [member](const Scene& s, Index i, Values v, Motion& m) { material_of(s, i, m).*member = v[0]; }});
}
void add(Table& table, const Row& row, double MaterialLayers::*member)
{
    table.push_back({std::string("/materials/{}/extensions/KHR_materials_") + row.pointer, 1, false, row.low, row.high,
                     [member](const Scene& s, Index i, Values v, Motion& m) { layers_of(s, i, m).*member = v[0]; }});
}
void add(Table& table, const Row& row, dvec3 MaterialLayers::*member)
{
    table.push_back(
        {std::string("/materials/{}/extensions/KHR_materials_") + row.pointer, 3, false, row.low, row.high,
         [member](const Scene& s, Index i, Values v, Motion& m) { layers_of(s, i, m).*member = triple(v); }});
}

void add_materials(Table& table)
{
    table.push_back({"/materials/{}/pbrMetallicRoughness/baseColorFactor", 4, false, 0, 1,
                     [](const Scene& s, Index i, Values v, Motion& m) {
                         material_of(s, i, m).base_color = dvec4(v[0], v[1], v[2], v[3]);
                     }});
    // Radiance: the importer multiplies keys by the strength.
    table.push_back({"/materials/{}/emissiveFactor", 3, false, 0, kAny,
                     [](const Scene& s, Index i, Values v, Motion& m) { material_of(s, i, m).emission = triple(v); }});
    add(table, {"/pbrMetallicRoughness/metallicFactor", 0, 1}, &Material::metallic);
    add(table, {"/pbrMetallicRoughness/roughnessFactor", 0, 1}, &Material::roughness);
    add(table, {"/alphaCutoff", 0, kAny}, &Material::alpha_cutoff);
    add(table, {"/normalTexture/scale", -kAny, kAny}, &Material::normal_scale);
    add(table, {"/occlusionTexture/strength", 0, 1}, &Material::occlusion_strength);
}

void add_layers(Table& table)
{
    using L = MaterialLayers;
    add(table, {"ior/ior", 0, kAny}, &L::ior);
    add(table, {"dispersion/dispersion", 0, kAny}, &L::dispersion);
    add(table, {"specular/specularFactor", 0, 1}, &L::specular);
    add(table, {"specular/specularColorFactor", 0, kAny}, &L::specular_color);
    add(table, {"clearcoat/clearcoatFactor", 0, 1}, &L::clearcoat);
    add(table, {"clearcoat/clearcoatRoughnessFactor", 0, 1}, &L::clearcoat_roughness);
    add(table, {"clearcoat/clearcoatNormalTexture/scale", -kAny, kAny}, &L::clearcoat_normal_scale);
    add(table, {"sheen/sheenColorFactor", 0, 1}, &L::sheen_color);
    add(table, {"sheen/sheenRoughnessFactor", 0, 1}, &L::sheen_roughness);
    add(table, {"transmission/transmissionFactor", 0, 1}, &L::transmission);
    add(table, {"volume/thicknessFactor", 0, kAny}, &L::thickness);
    add(table, {"volume/attenuationDistance", kTiny, kAny}, &L::attenuation_distance);
    add(table, {"volume/attenuationColor", 0, 1}, &L::attenuation_color);
    add(table, {"iridescence/iridescenceFactor", 0, 1}, &L::iridescence);
    add(table, {"iridescence/iridescenceIor", 1, kAny}, &L::iridescence_ior);
    add(table, {"iridescence/iridescenceThicknessMinimum", 0, kAny}, &L::iridescence_thickness_min);
    add(table, {"iridescence/iridescenceThicknessMaximum", 0, kAny}, &L::iridescence_thickness_max);
    add(table, {"anisotropy/anisotropyStrength", 0, 1}, &L::anisotropy);
    add(table, {"anisotropy/anisotropyRotation", -kAny, kAny}, &L::anisotropy_rotation);
    add(table, {"diffuse_transmission/diffuseTransmissionFactor", 0, 1}, &L::diffuse_transmission);
    add(table, {"diffuse_transmission/diffuseTransmissionColorFactor", 0, 1}, &L::diffuse_transmission_color);
}

// What a texture transform is made of: T(offset) · R(rotation) · S(scale), see gltf_texture.cpp for the signs. Taken
// apart from the matrix, so a scale that is negative or 0 at rest comes back as a turn, or without one.
struct UvTransform {
    dvec2 offset{0};
    double rotation = 0;
    dvec2 scale{1};

    explicit UvTransform(const dmat3& m) : offset(m[2]), scale(length(dvec3(m[0])), length(dvec3(m[1])))
    {
        rotation = scale.x > 0 ? std::atan2(-m[0].y, m[0].x) : std::atan2(m[1].x, m[1].y);
        if (m[0].x * m[1].y - m[0].y * m[1].x < 0) scale.y = -scale.y;
    }
    dmat3 matrix() const
    {
        const double c = std::cos(rotation);
        const double s = std::sin(rotation);
        return dmat3(dvec3(c * scale.x, -s * scale.x, 0), dvec3(s * scale.y, c * scale.y, 0), dvec3(offset, 1));
    }
};

template <typename Slot>
void add_texture(Table& table, const std::string& pointer, const Slot& slot)
{
    const std::string at = "/materials/{}" + pointer + "/extensions/KHR_texture_transform/";
    const auto row = [&](const char* name, std::size_t width, const auto& change) {
        table.push_back(
            {at + name, width, false, -kAny, kAny, [slot, change](const Scene& s, Index i, Values v, Motion& m) {
                 TextureUse& use = slot(s, i, m);
                 UvTransform transform(use.transform);
                 change(transform, v);
                 use.transform = transform.matrix();
             }});
    };
    row("offset", 2, [](UvTransform& t, Values v) { t.offset = dvec2(v[0], v[1]); });
    row("rotation", 1, [](UvTransform& t, Values v) { t.rotation = v[0]; });
    row("scale", 2, [](UvTransform& t, Values v) { t.scale = dvec2(v[0], v[1]); });
}

void add_textures(Table& table)
{
    using M = Material;
    using L = MaterialLayers;
    const auto base = [&](const char* pointer, TextureUse M::*member) {
        add_texture(table, pointer, [member](const Scene& s, Index i, Motion& m) -> TextureUse& {
            return material_of(s, i, m).*member;
        });
    };
    const auto layer = [&](const char* pointer, TextureUse L::*member) {
        add_texture(table, std::string("/extensions/KHR_materials_") + pointer,
                    [member](const Scene& s, Index i, Motion& m) -> TextureUse& { return layers_of(s, i, m).*member; });
    };
    base("/pbrMetallicRoughness/baseColorTexture", &M::base_color_texture);
    base("/pbrMetallicRoughness/metallicRoughnessTexture", &M::metallic_roughness_texture);
    base("/normalTexture", &M::normal_texture);
    base("/occlusionTexture", &M::occlusion_texture);
    base("/emissiveTexture", &M::emissive_texture);
    layer("specular/specularTexture", &L::specular_texture);
    layer("specular/specularColorTexture", &L::specular_color_texture);
    layer("clearcoat/clearcoatTexture", &L::clearcoat_texture);
    layer("clearcoat/clearcoatRoughnessTexture", &L::clearcoat_roughness_texture);
    layer("clearcoat/clearcoatNormalTexture", &L::clearcoat_normal_texture);
    layer("sheen/sheenColorTexture", &L::sheen_color_texture);
    layer("sheen/sheenRoughnessTexture", &L::sheen_roughness_texture);
    layer("transmission/transmissionTexture", &L::transmission_texture);
    layer("volume/thicknessTexture", &L::thickness_texture);
    layer("iridescence/iridescenceTexture", &L::iridescence_texture);
    layer("iridescence/iridescenceThicknessTexture", &L::iridescence_thickness_texture);
    layer("anisotropy/anisotropyTexture", &L::anisotropy_texture);
    layer("diffuse_transmission/diffuseTransmissionTexture", &L::diffuse_transmission_texture);
    layer("diffuse_transmission/diffuseTransmissionColorTexture", &L::diffuse_transmission_color_texture);
}

void add_lights_and_cameras(Table& table)
{
    const auto light = [&](const char* name, double low, double high, double Light::*member) {
        table.push_back({std::string("/extensions/KHR_lights_punctual/lights/{}/") + name, 1, false, low, high,
                         [member](const Scene& s, Index i, Values v, Motion& m) {
                             m.lights.try_emplace(i, s.lights.at(i)).first->second.*member = v[0];
                         }});
    };
    table.push_back({"/extensions/KHR_lights_punctual/lights/{}/color", 3, false, 0, kAny,
                     [](const Scene& s, Index i, Values v, Motion& m) {
                         m.lights.try_emplace(i, s.lights.at(i)).first->second.color = triple(v);
                     }});
    light("intensity", 0, kAny, &Light::intensity);
    light("range", kTiny, kAny, &Light::range);
    light("spot/innerConeAngle", 0, kPi / 2, &Light::inner_cone);
    light("spot/outerConeAngle", kTiny, kPi / 2, &Light::outer_cone);
    const auto camera = [&](const char* name, double high, double Camera::*member) {
        table.push_back({std::string("/cameras/{}/") + name, 1, false, kTiny, high,
                         [member](const Scene& s, Index i, Values v, Motion& m) {
                             m.cameras.try_emplace(i, s.cameras.at(i)).first->second.*member = v[0];
                         }});
    };
    camera("perspective/yfov", kPi - kTiny, &Camera::yfov);
    camera("perspective/znear", kAny, &Camera::znear);
    camera("orthographic/xmag", kAny, &Camera::xmag);
    camera("orthographic/ymag", kAny, &Camera::ymag);
    camera("orthographic/znear", kAny, &Camera::znear);
}

}  // namespace

std::span<const AnimatedProperty> animated_properties()
{
    static const Table table = [] {
        Table rows;
        add_nodes(rows);
        add_materials(rows);
        add_layers(rows);
        add_textures(rows);
        add_lights_and_cameras(rows);
        return rows;
    }();
    return table;
}

std::optional<PropertyPlace> find_property(std::string_view pointer)
{
    constexpr std::string_view kHole = "{}";
    Index row = 0;
    for (const AnimatedProperty& property : animated_properties()) {
        const std::string_view pattern = property.pointer;
        const std::size_t hole = pattern.find(kHole);
        const std::string_view before = pattern.substr(0, hole);
        const std::string_view after = pattern.substr(hole + kHole.size());
        if (pointer.size() > before.size() + after.size() && pointer.starts_with(before) && pointer.ends_with(after)) {
            const std::string_view digits =
                pointer.substr(before.size(), pointer.size() - before.size() - after.size());
            Index object = 0;
            const auto [end, failure] = std::from_chars(digits.data(), digits.data() + digits.size(), object);
            if (failure == std::errc() && end == digits.data() + digits.size()) return PropertyPlace{row, object};
        }
        ++row;
    }
    return std::nullopt;
}

}  // namespace etalon
