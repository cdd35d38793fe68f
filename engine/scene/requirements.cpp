#include "engine/scene/requirements.h"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <optional>

#include "engine/base/error.h"
#include "engine/scene/simplify.h"

namespace etalon {

namespace {

constexpr std::array<std::string_view, kFeatureCount> kNames = {"triangles",
                                                                "lines",
                                                                "points",
                                                                "spheres",
                                                                "normals",
                                                                "tangents",
                                                                "uv0",
                                                                "uv1",
                                                                "vertex_colors",
                                                                "base_color_texture",
                                                                "metallic_roughness_texture",
                                                                "normal_texture",
                                                                "occlusion_texture",
                                                                "emissive_texture",
                                                                "texture_transform",
                                                                "mipmaps",
                                                                "alpha_mask",
                                                                "alpha_blend",
                                                                "double_sided",
                                                                "metallic_roughness",
                                                                "unlit",
                                                                "lambert",
                                                                "mirror",
                                                                "rough_conductor",
                                                                "dielectric",
                                                                "rough_dielectric",
                                                                "specular_glossiness",
                                                                "specular",
                                                                "clearcoat",
                                                                "sheen",
                                                                "transmission",
                                                                "volume",
                                                                "iridescence",
                                                                "anisotropy",
                                                                "dispersion",
                                                                "diffuse_transmission",
                                                                "layer_textures",
                                                                "blinn_phong",
                                                                "emission",
                                                                "punctual_lights",
                                                                "environment_constant",
                                                                "environment_map",
                                                                "visible_background",
                                                                "thin_lens",
                                                                "orthographic",
                                                                "equirectangular",
                                                                "msaa",
                                                                "aovs"};
static_assert(!kNames.back().empty());

// Does this model read the base colour (factor, texture, vertex colour), for its light or for its coverage?
bool reads_base_color(const Material& material)
{
    return material.alpha_mode != AlphaMode::opaque || material.model == BsdfModel::metallic_roughness ||
           material.model == BsdfModel::specular_glossiness || material.model == BsdfModel::unlit ||
           material.model == BsdfModel::lambert || material.model == BsdfModel::mirror;
}

// What vertex colours may leave out; both are true where there are none.
struct VertexColors {
    bool white = true;  // and solid
    bool solid = true;  // alpha 1
};

VertexColors describe_colors(const Primitive& primitive)
{
    const auto& colors = primitive.colors;
    return {.white = std::all_of(colors.begin(), colors.end(), [](const vec4& c) { return c == vec4(1); }),
            .solid = std::all_of(colors.begin(), colors.end(), [](const vec4& c) { return c.w == 1; })};
}

bool needs_tangents(const Material& material)
{
    const std::optional<MaterialLayers>& layers = material.layers;
    return material.normal_texture.present() ||
           (layers &&
            (layers->anisotropy != 0 || (layers->clearcoat > 0 && layers->clearcoat_normal_texture.present())));
}

std::string label(std::string_view kind, std::size_t index, const std::string& name)
{
    return name.empty() ? fmt::format("{} {}", kind, index) : fmt::format("{} {} ({})", kind, index, name);
}

class Survey {
 public:
    Survey(const PosedScene& posed, const RenderSettings& settings, std::optional<Feature> without)
        : posed_(posed),
          scene_(*posed.scene),
          settings_(settings),
          without_(without),
          rasterizes_(settings.renderer == Renderer::raster || settings.renderer == Renderer::reference_raster),
          environment_shines_(!posed.environment.is_black())
    {
        out_.texture_used.resize(scene_.textures.size());
        out_.material_used.resize(posed_.materials().size());
        colors_are_solid_.assign(posed_.materials().size(), true);
        for (const Draw& draw : posed_.draws) colors(posed_.primitive(draw));
        for (const Draw& draw : posed_.draws) geometry(draw);
        for (const PosedSphere& sphere : posed_.spheres) {
            set(Feature::spheres, label("node", sphere.node, scene_.nodes[sphere.node].name));
            material(sphere.material);
        }
        light();
        view();
    }

    Requirements result() && { return std::move(out_); }

 private:
    void set(Feature feature, std::string because)
    {
        if (feature != without_) out_.set(feature, std::move(because));
    }

    // Once for each primitive, however often it is drawn.
    void colors(const Primitive& primitive)
    {
        const auto [known, is_new] = colors_.try_emplace(&primitive);
        if (!is_new) return;
        known->second = describe_colors(primitive);
        if (!known->second.solid) colors_are_solid_[primitive.material] = false;
    }

    // Is the surface there at every point, whatever its alpha mode? Path tracers then draw it as an opaque one, to the
    // bit; rasterizers draw the modes in an order of their own (SH-32).
    bool is_solid(Index index)
    {
        const Material& m = posed_.materials()[index];
        if (!colors_are_solid_[index] || m.base_color.w != 1) return false;
        if (m.alpha_mode == AlphaMode::mask && m.alpha_cutoff > 1) return false;
        if (!m.base_color_texture.present()) return true;
        const Index image = scene_.textures[m.base_color_texture.texture].image;
        return image == kNone || constant_channel(scene_.images[image], 3) == 1.0;
    }

    void geometry(const Draw& draw)
    {
        const Primitive& primitive = posed_.primitive(draw);
        // Lines and points have no area: path tracers do not see them (SH-7).
        if (!rasterizes_ && primitive.topology != Topology::triangles) return;
        const std::string who =
            fmt::format("{} primitive {}", label("mesh", draw.mesh, scene_.meshes[draw.mesh].name), draw.primitive);
        switch (primitive.topology) {
            case Topology::points:
                set(Feature::points, who);
                break;
            case Topology::lines:
                set(Feature::lines, who);
                break;
            case Topology::triangles:
                set(Feature::triangles, who);
                break;
        }
        const Material& surface = posed_.materials()[primitive.material];
        const bool lit = surface.model != BsdfModel::unlit;
        if (primitive.has_normals && (lit || settings_.aovs)) set(Feature::normals, who);
        // A rasterizer's interpolated white is white but for rounding.
        const bool white = rasterizes_ ? primitive.colors.empty() : colors_.at(&primitive).white;
        if (!white && reads_base_color(surface)) set(Feature::vertex_colors, who);
        if (!primitive.tangents.empty() && lit && needs_tangents(surface)) set(Feature::tangents, who);
        if (settings_.aovs && !primitive.uv[0].empty()) set(Feature::uv0, who);
        material(primitive.material);
    }

    void material(Index index)
    {
        if (out_.material_used[index]) return;
        out_.material_used[index] = true;
        const Material& m = posed_.materials()[index];
        const std::string who = label("material", index, m.name);
        const bool lit = m.model != BsdfModel::unlit;
        set(feature_of(m.model), who);
        if (lit) any_lit_ = true;
        if (lit && rasterizes_ && settings_.shading == Shading::blinn_phong)
            set(Feature::blinn_phong, "settings: blinn-phong shading");
        if (m.alpha_mode != AlphaMode::opaque && (rasterizes_ || !is_solid(index)))
            set(m.alpha_mode == AlphaMode::mask ? Feature::alpha_mask : Feature::alpha_blend, who);
        if (m.double_sided) set(Feature::double_sided, who);
        const bool emits = m.emission != dvec3(0);
        if (emits) set(Feature::emission, who);

        if (reads_base_color(m)) texture(m.base_color_texture, Feature::base_color_texture, who);
        if (m.model == BsdfModel::metallic_roughness || m.model == BsdfModel::specular_glossiness)
            texture(m.metallic_roughness_texture, Feature::metallic_roughness_texture, who);
        if (lit) texture(m.normal_texture, Feature::normal_texture, who);
        // Occlusion dims the environment's light in rasterizers and nothing else (SH-36).
        if (lit && rasterizes_ && environment_shines_ && m.occlusion_strength != 0)
            texture(m.occlusion_texture, Feature::occlusion_texture, who);
        if (emits) texture(m.emissive_texture, Feature::emissive_texture, who);
        if (m.layers) layers(*m.layers, who);
    }

    void layers(const MaterialLayers& m, const std::string& who)
    {
        const auto need = [&](bool present, Feature feature, std::initializer_list<const TextureUse*> textures) {
            if (!present || feature == without_) return;
            set(feature, who);
            for (const TextureUse* use : textures) texture(*use, Feature::layer_textures, who);
        };
        const bool textured = m.specular_texture.present() || m.specular_color_texture.present();
        need(m.ior != 1.5 || m.specular != 1 || m.specular_color != dvec3(1) || textured, Feature::specular,
             {&m.specular_texture, &m.specular_color_texture});
        need(m.clearcoat > 0, Feature::clearcoat,
             {&m.clearcoat_texture, &m.clearcoat_roughness_texture, &m.clearcoat_normal_texture});
        need(m.sheen_color != dvec3(0), Feature::sheen, {&m.sheen_color_texture, &m.sheen_roughness_texture});
        need(m.transmission > 0, Feature::transmission, {&m.transmission_texture});
        need(m.volumetric(), Feature::volume, {});
        // Path tracers measure the way through a body; the thickness is for those that cannot.
        if (m.volumetric() && rasterizes_) texture(m.thickness_texture, Feature::layer_textures, who);
        need(m.volumetric() && m.dispersion > 0, Feature::dispersion, {});
        need(m.iridescence > 0, Feature::iridescence, {&m.iridescence_texture, &m.iridescence_thickness_texture});
        need(m.anisotropy != 0, Feature::anisotropy, {&m.anisotropy_texture});
        need(m.diffuse_transmission > 0, Feature::diffuse_transmission,
             {&m.diffuse_transmission_texture, &m.diffuse_transmission_color_texture});
    }

    void texture(const TextureUse& use, Feature feature, const std::string& who)
    {
        if (!use.present() || feature == without_) return;
        set(feature, who);
        set(use.uv_set == 0 ? Feature::uv0 : Feature::uv1, who);
        if (use.transform != dmat3(1)) set(Feature::texture_transform, who);
        const bool levels = scene_.textures[use.texture].sampler.mipmapped;
        if (rasterizes_ && settings_.mipmaps && (levels || settings_.texture_filter != TextureFilter::file))
            set(Feature::mipmaps, label("texture", use.texture, scene_.textures[use.texture].name));
        out_.texture_used[use.texture] = true;
    }

    void light()
    {
        for (std::size_t i = 0; any_lit_ && i < posed_.lights.size(); ++i) {
            const Light& light = posed_.lights[i].light;
            if (light.intensity != 0 && light.color != dvec3(0))
                set(Feature::punctual_lights, label("light", i, light.name));
        }
        if (!environment_shines_) return;
        const bool seen = settings_.background == Background::environment;
        if (seen) set(Feature::visible_background, "settings: the environment as background");
        if (seen || any_lit_)
            set(posed_.environment.map ? Feature::environment_map : Feature::environment_constant, "environment");
    }

    void view()
    {
        const Camera& camera = posed_.view.camera;
        const std::string who = camera.name.empty() ? "camera" : fmt::format("camera ({})", camera.name);
        if (camera.equirectangular && rasterizes_)
            throw Error(Blame::input, fmt::format("{} sees all around, which no rasterizer can draw", who),
                        "choose a path tracer (--renderer path), or another projection");
        if (camera.equirectangular) set(Feature::equirectangular, who);
        if (camera.orthographic) set(Feature::orthographic, who);
        if (!rasterizes_ && camera.lens && camera.lens->aperture_radius > 0) set(Feature::thin_lens, who);
        if (rasterizes_ && settings_.msaa > 1) set(Feature::msaa, fmt::format("settings: msaa {}", settings_.msaa));
        if (settings_.aovs) set(Feature::aovs, "settings: aovs");
    }

    const PosedScene& posed_;
    const Scene& scene_;
    const RenderSettings& settings_;
    const std::optional<Feature> without_;
    const bool rasterizes_;
    const bool environment_shines_;
    std::map<const Primitive*, VertexColors> colors_;
    std::vector<bool> colors_are_solid_;  // of each material: no vertex colour of it has an alpha but 1
    bool any_lit_ = false;
    Requirements out_;
};

}  // namespace

std::string_view name(Feature feature)
{
    assume(feature < Feature::count);
    return kNames[static_cast<std::size_t>(feature)];
}

Feature feature_of(BsdfModel model)
{
    switch (model) {
        case BsdfModel::metallic_roughness:
            return Feature::metallic_roughness;
        case BsdfModel::unlit:
            return Feature::unlit;
        case BsdfModel::lambert:
            return Feature::lambert;
        case BsdfModel::mirror:
            return Feature::mirror;
        case BsdfModel::rough_conductor:
            return Feature::rough_conductor;
        case BsdfModel::dielectric:
            return Feature::dielectric;
        case BsdfModel::rough_dielectric:
            return Feature::rough_dielectric;
        case BsdfModel::specular_glossiness:
            return Feature::specular_glossiness;
    }
    assume(false);
    return Feature::count;
}

void Requirements::set(Feature feature, std::string because)
{
    const auto i = static_cast<std::size_t>(feature);
    if (bits[i]) return;
    bits[i] = true;
    cause[i] = std::move(because);
}

Requirements require(const PosedScene& posed, const RenderSettings& settings)
{
    return Survey(posed, settings, std::nullopt).result();
}

Requirements require_without(const PosedScene& posed, const RenderSettings& settings, Feature feature)
{
    return Survey(posed, settings, feature).result();
}

}  // namespace etalon
