#include "engine/scene/digest.h"

#include <span>

namespace etalon {
namespace {

/// Adds values of the scene; every struct is taken apart here, member by member, since padding has no value.
class SceneDigest {
 public:
    template <typename... Values>
    void add(const Values&... values)
    {
        (one(values), ...);
    }
    template <typename T>
    void list(const std::vector<T>& values)  // of plain numbers, without padding
    {
        digest_.add(std::as_bytes(std::span(values)));
    }

    void primitive(const Primitive& p)
    {
        add(static_cast<int>(p.topology), p.material, p.has_normals);
        list(p.positions);
        list(p.normals);
        list(p.tangents);
        for (const auto& uv : p.uv) list(uv);
        list(p.colors);
        list(p.indices);
    }

    void material(const Material& m)
    {
        add(static_cast<int>(m.model), m.base_color, m.metallic, m.roughness, m.emission, m.eta, m.k, m.ggx_alpha);
        add(m.normal_scale, m.occlusion_strength, static_cast<int>(m.alpha_mode), m.alpha_cutoff, m.double_sided);
        add(m.emits_front_only, m.base_color_texture, m.metallic_roughness_texture, m.normal_texture);
        add(m.occlusion_texture, m.emissive_texture, m.layers.has_value());
        if (m.layers) layers(*m.layers);
    }

    void light(const PosedLight& posed)
    {
        const Light& l = posed.light;
        add(static_cast<int>(l.type), l.color, l.intensity, l.range, l.inner_cone, l.outer_cone);
        add(posed.position, posed.direction);
    }

    void environment(const Environment& e)
    {
        add(e.radiance, e.rotation, e.scale, e.map != nullptr);
        if (!e.map) return;
        add(e.map->width, e.map->height, e.map->channels);
        list(e.map->values);
    }

    void view(const View& v)
    {
        const Camera& c = v.camera;
        add(v.width, v.height, v.world_from_camera, c.orthographic, c.equirectangular, c.yfov, c.xmag, c.ymag, c.znear);
        add(c.lens.has_value());
        if (c.lens) add(c.lens->aperture_radius, c.lens->focus_distance, c.lens->blades);
    }

    void textures(const Scene& scene)
    {
        for (const Texture& t : scene.textures) {
            const Sampler& s = t.sampler;
            add(t.image, static_cast<int>(s.wrap_u), static_cast<int>(s.wrap_v), static_cast<int>(s.mag));
            add(static_cast<int>(s.min), static_cast<int>(s.mip), s.mipmapped);
        }
        for (const Texels& image : scene.images) {
            add(image.width, image.height, image.is_8_bit);
            list(image.bytes);
            list(image.wide);
        }
    }

    const Digest& result() const { return digest_; }

 private:
    void one(double value) { digest_.add(value); }
    template <std::integral T>
    void one(T value)
    {
        digest_.add(static_cast<std::uint64_t>(value));
    }
    template <glm::length_t size>
    void one(const glm::vec<size, double>& v)
    {
        for (glm::length_t i = 0; i < size; ++i) digest_.add(v[i]);
    }
    template <glm::length_t columns, glm::length_t rows>
    void one(const glm::mat<columns, rows, double>& m)
    {
        for (glm::length_t i = 0; i < columns; ++i) one(m[i]);
    }
    void one(const TextureUse& use) { add(use.texture, use.uv_set, use.transform); }

    void layers(const MaterialLayers& l)
    {
        add(l.ior, l.dispersion, l.specular, l.specular_color, l.specular_texture, l.specular_color_texture);
        add(l.clearcoat, l.clearcoat_roughness, l.clearcoat_normal_scale, l.clearcoat_texture);
        add(l.clearcoat_roughness_texture, l.clearcoat_normal_texture);
        add(l.sheen_color, l.sheen_roughness, l.sheen_color_texture, l.sheen_roughness_texture);
        add(l.transmission, l.transmission_texture, l.thickness, l.attenuation_distance, l.attenuation_color);
        add(l.thickness_texture, l.iridescence, l.iridescence_ior, l.iridescence_thickness_min);
        add(l.iridescence_thickness_max, l.iridescence_texture, l.iridescence_thickness_texture);
        add(l.anisotropy, l.anisotropy_rotation, l.anisotropy_texture, l.diffuse_transmission);
        add(l.diffuse_transmission_color, l.diffuse_transmission_texture, l.diffuse_transmission_color_texture);
    }

    Digest digest_;
};

}  // namespace

Digest digest(const Material& material)
{
    SceneDigest out;
    out.material(material);
    return out.result();
}

Digest digest(const PosedScene& posed)
{
    SceneDigest out;
    out.view(posed.view);
    out.add(posed.draws.size());
    // A mesh that is drawn in many places is read once for each: instances share what they are of.
    std::vector<bool> seen(posed.scene->meshes.size(), false);
    for (const Draw& draw : posed.draws) {
        out.add(draw.mesh, draw.primitive, draw.world_from_object, draw.deformed);
        if (draw.deformed != kNone) continue;
        if (seen[draw.mesh]) continue;
        seen[draw.mesh] = true;
        for (const Primitive& primitive : posed.scene->meshes[draw.mesh].primitives) out.primitive(primitive);
    }
    for (const Primitive& primitive : posed.deformed) out.primitive(primitive);
    for (const PosedSphere& sphere : posed.spheres) out.add(sphere.center, sphere.radius, sphere.material);
    for (const Material& material : posed.materials()) out.material(material);
    for (const PosedLight& light : posed.lights) out.light(light);
    out.environment(posed.environment);
    out.textures(*posed.scene);
    return out.result();
}

}  // namespace etalon
