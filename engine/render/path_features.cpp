#include "engine/render/path_features.h"

#include <fmt/format.h>

#include <algorithm>

#include "engine/base/error.h"
#include "shaders/shared/path.h"

namespace etalon {
namespace {

void check_model(const PosedScene& posed, const Requirements& required, Index material)
{
    const Material& m = posed.materials()[material];
    if (required.has(feature_of(m.model))) return;
    throw Error(Blame::input,
                fmt::format("material {} ({}) needs {}, which the requirements lack", material, m.name,
                            name(feature_of(m.model))),
                "derive the requirements from the scene that is rendered");
}

}  // namespace

PathFeatures path_features(const PosedScene& posed, const Requirements& required, const RenderSettings& settings)
{
    for (const Draw& draw : posed.draws)
        if (posed.primitive(draw).topology == Topology::triangles)
            check_model(posed, required, posed.primitive(draw).material);
    for (const PosedSphere& sphere : posed.spheres) check_model(posed, required, sphere.material);
    return path_features_unchecked(posed, required, settings);
}

PathFeatures path_features_unchecked(const PosedScene& posed, const Requirements& required,
                                     const RenderSettings& settings)
{
    const auto has = [&](Feature feature) { return required.has(feature); };
    PathFeatures out;
    out.triangles = has(Feature::triangles);
    out.spheres = has(Feature::spheres);
    out.normals = has(Feature::normals);
    out.uv = has(Feature::uv0) || has(Feature::uv1);
    out.tangents =
        has(Feature::tangents) && (has(Feature::normal_texture) || has(Feature::clearcoat) || has(Feature::anisotropy));
    out.colors = has(Feature::vertex_colors);
    out.base_color_texture = has(Feature::base_color_texture);
    out.metallic_roughness_texture = has(Feature::metallic_roughness_texture);
    out.normal_texture = has(Feature::normal_texture);
    out.emissive_texture = has(Feature::emissive_texture);
    out.texture_transform = has(Feature::texture_transform);
    out.alpha = has(Feature::alpha_mask) || has(Feature::alpha_blend);
    out.metallic_roughness = has(Feature::metallic_roughness);
    out.unlit = has(Feature::unlit);
    out.lambert = has(Feature::lambert);
    out.mirror = has(Feature::mirror);
    out.rough_conductor = has(Feature::rough_conductor);
    out.dielectric = has(Feature::dielectric);
    out.rough_dielectric = has(Feature::rough_dielectric);
    out.specular_glossiness = has(Feature::specular_glossiness);
    out.specular = has(Feature::specular);
    out.clearcoat = has(Feature::clearcoat);
    out.sheen = has(Feature::sheen);
    out.transmission = has(Feature::transmission);
    out.volume = has(Feature::volume) && out.transmission;
    out.iridescence = has(Feature::iridescence);
    out.anisotropy = has(Feature::anisotropy);
    out.dispersion = has(Feature::dispersion) && out.volume;
    out.diffuse_transmission = has(Feature::diffuse_transmission);
    out.layer_textures = has(Feature::layer_textures);
    out.emission = has(Feature::emission);
    out.punctual = has(Feature::punctual_lights);
    out.sky = has(Feature::environment_constant) || has(Feature::environment_map);
    // The rest is what the scene has: a bit too many must not change what its data mean.
    out.sky_map = has(Feature::environment_map) && posed.environment.map != nullptr;
    out.thin_lens = has(Feature::thin_lens) && posed.view.camera.lens.has_value();
    out.equirectangular = has(Feature::equirectangular) && posed.view.camera.equirectangular;
    out.orthographic = has(Feature::orthographic) && posed.view.camera.orthographic && !out.equirectangular;
    out.thin_lens = out.thin_lens && !out.equirectangular && !posed.view.camera.orthographic;
    out.sobol = settings.sampler == Sequence::sobol;
    out.glass_shadows = settings.glass_shadows && out.transmission;
    for (std::size_t i = 0; i < posed.scene->textures.size(); ++i) {
        const Index image = posed.scene->textures[i].image;
        if (required.texture_used[i] && image != kNone && !posed.scene->images[image].is_8_bit) out.wide_texels = true;
    }
    return out;
}

std::vector<gpu::Constant> path_constants(const PathFeatures& f)
{
    using namespace shared;
    return {{kSpecTriangles, f.triangles},
            {kSpecSpheres, f.spheres},
            {kSpecNormals, f.normals},
            {kSpecUv, f.uv},
            {kSpecTangents, f.tangents},
            {kSpecColors, f.colors},
            {kSpecBaseColorTexture, f.base_color_texture},
            {kSpecMetallicRoughnessTexture, f.metallic_roughness_texture},
            {kSpecNormalTexture, f.normal_texture},
            {kSpecEmissiveTexture, f.emissive_texture},
            {kSpecTextureTransform, f.texture_transform},
            {kSpecWideTexels, f.wide_texels},
            {kSpecAlpha, f.alpha},
            {kSpecMetallicRoughness, f.metallic_roughness},
            {kSpecUnlit, f.unlit},
            {kSpecLambert, f.lambert},
            {kSpecMirror, f.mirror},
            {kSpecRoughConductor, f.rough_conductor},
            {kSpecDielectric, f.dielectric},
            {kSpecRoughDielectric, f.rough_dielectric},
            {kSpecSpecularGlossiness, f.specular_glossiness},
            {kSpecSpecular, f.specular},
            {kSpecClearcoat, f.clearcoat},
            {kSpecSheen, f.sheen},
            {kSpecTransmission, f.transmission},
            {kSpecVolume, f.volume},
            {kSpecIridescence, f.iridescence},
            {kSpecAnisotropy, f.anisotropy},
            {kSpecDispersion, f.dispersion},
            {kSpecDiffuseTransmission, f.diffuse_transmission},
            {kSpecLayerTextures, f.layer_textures},
            {kSpecEmission, f.emission},
            {kSpecPunctual, f.punctual},
            {kSpecSky, f.sky},
            {kSpecSkyMap, f.sky_map},
            {kSpecThinLens, f.thin_lens},
            {kSpecOrthographic, f.orthographic},
            {kSpecEquirectangular, f.equirectangular},
            {kSpecSobol, f.sobol},
            {kSpecGlassShadows, f.glass_shadows},
            {kSpecChosenPixels, f.chosen_pixels}};
}

}  // namespace etalon
