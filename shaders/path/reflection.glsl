// The BSDF of a surface from its material's record, textures and layers (docs/shading.md §2, §2b).
#ifndef ETALON_PATH_REFLECTION_GLSL
#define ETALON_PATH_REFLECTION_GLSL
#include "shaders/lib/absorption.glsl"
#include "shaders/path/surface.glsl"

vec4 albedo_cell(int index) { return uintBitsToFloat(imageLoad(albedo_cells, index)); }
#include "shaders/lib/bsdf.glsl"

// The frame in which the BSDF is evaluated; x is where anisotropic highlights are drawn out (SH-52).
Frame shading_frame(Surface s)
{
    Frame local = make_frame(s.n);
    if (kAnisotropy) {
        uint layers = layers_of(s.material);
        vec2 turn = vec2(load_record(layers, 6u).w, load_record(layers, 7u).x);
        vec2 towards = vec2(1.0, 0.0);
        if (kLayerTextures) {
            vec2 texel = 2.0 * sample_record_slot(layers, kAnisotropySlot, s.uvs, false, vec4(1.0, 0.5, 1.0, 1.0)).xy - 1.0;
            float size = sqrt(dot(texel, texel));
            towards = size > 0.0 ? texel / size : towards;
        }
        towards = vec2(turn.x * towards.x - turn.y * towards.y, turn.y * towards.x + turn.x * towards.y);
        vec3 given = robust_normalize(s.tangent.xyz);
        vec3 t = robust_normalize(given - dot(s.n, given) * s.n);
        vec3 b = cross(s.front ? s.n : -s.n, t) * (s.tangent.w < 0.0 ? -1.0 : 1.0);
        bool turned = load_record(layers, 6u).z != 0.0;
        vec3 x = towards.x * (t == vec3(0.0) ? local.x : t) + towards.y * (t == vec3(0.0) ? local.y : b);
        local.x = turned ? x : local.x;
        local.y = turned ? cross(s.n, x) : local.y;
    }
    return local;
}

void add_film(uint layers, vec4 uvs, inout Glossy g)
{
    vec4 factors = load_record(layers, 5u);
    vec2 range = load_record(layers, 6u).xy;
    float thick = sample_layer(layers, kIridescenceThicknessSlot, uvs, false).y;
    g.film_nanometres = range.x + (range.y - range.x) * thick;
    g.film = g.film_nanometres > 0.0 ? factors.z * sample_layer(layers, kIridescenceSlot, uvs, false).x : 0.0;
    g.film_ior = factors.w;
}

void add_transmission(uint layers, Surface s, vec3 base, float metallic, inout Glossy g)
{
    vec4 colour = load_record(layers, 3u);
    vec4 factors = load_record(layers, 5u);
    float through = 0.0;
    float spread = 0.0;
    if (kTransmission) through = factors.y * sample_layer(layers, kTransmissionSlot, s.uvs, false).x;
    if (kDiffuseTransmission) {
        spread = colour.w * sample_layer(layers, kDiffuseTransmissionSlot, s.uvs, false).w;
        vec3 tint = colour.xyz * sample_layer(layers, kDiffuseTransmissionColorSlot, s.uvs, true).xyz;
        g.diffuse_through = (1.0 - through) * spread * tint * (1.0 - metallic);
    }
    g.through = through * g.diffuse;
    g.diffuse *= (1.0 - through) * (1.0 - spread);
    if (kVolume) {
        vec2 indices = load_record(layers, 4u).xy;
        float thickness = load_record(layers, 2u).w;
        g.body = thickness > 0.0 && factors.y > 0.0;
        // ior 0 is a mirror (SH-58).
        if (g.body && indices.x == 0.0) g.through = vec3(0.0);
        float ior = indices.x == 0.0 ? 1.0 : indices.x;
        float spread_of_ior = 0.0;
        if (kDispersion) spread_of_ior = (ior - 1.0) * 0.025 * indices.y;
        vec3 excess = vec3(ior - 1.0) + spread_of_ior * vec3(-1.0, 0.0, 1.0);
        g.excess = s.front ? excess : -excess / (1.0 + excess);
        g.inner = g.body && !s.front ? ior : 0.0;
    }
}

void add_sheen(uint layers, vec4 uvs, float cos_o, inout Glossy g)
{
    vec4 factors = load_record(layers, 1u);
    g.sheen = factors.xyz * sample_layer(layers, kSheenColorSlot, uvs, true).xyz;
    g.sheen_roughness = max(factors.w * sample_layer(layers, kSheenRoughnessSlot, uvs, false).w, 0.07);
    g.sheen_seen = sheen_albedo(cos_o, g.sheen_roughness);
}

void add_coat(uint layers, Surface s, Frame local, vec3 wo, inout Glossy g)
{
    float roughness = load_record(layers, 4u).w * sample_layer(layers, kClearcoatRoughnessSlot, s.uvs, false).y;
    g.coat = coat_reflectance(s.material, s.uvs, dot(s.coat_n, wo));
    g.coat_alpha = max(roughness * roughness, 1e-3);
    g.coat_n = robust_normalize(to_local(local, s.coat_n));
    g.ng = to_local(local, s.ng);
}

// (SH-14, SH-50 … SH-62)
Glossy make_glossy(Surface s, vec3 base, bool specular_glossiness, Frame local, vec3 wo, float cos_o)
{
    float metallic = load_material(s.material, 1u).w;
    float roughness = load_material(s.material, 2u).w;
    vec3 dielectric = vec3(0.04);
    vec4 texel = vec4(1.0);
    if (kMetallicRoughnessTexture)
        texel = sample_slot(s.material, kMetallicRoughnessSlot, s.uvs, kSpecularGlossiness && specular_glossiness, vec4(1.0));
    uint layers = 0u;
    if (kAnyLayer) layers = layers_of(s.material);
    float f90 = 1.0;
    if (kSpecular) add_specular(layers, s.uvs, dielectric, f90);
    if (kSpecularGlossiness && specular_glossiness) {
        dielectric = load_material(s.material, 3u).xyz * texel.xyz;
        f90 = 1.0;
        metallic = 0.0;
        roughness = 1.0 - (1.0 - roughness) * texel.w;
        base *= 1.0 - max_component(dielectric);
    } else if (kMetallicRoughnessTexture) {
        metallic *= texel.z;
        roughness *= texel.y;
    }
    precise vec3 f0 = dielectric + metallic * (base - dielectric);  // to the bit with layers and without
    Glossy g = plain_glossy(base * (1.0 - metallic), f0, max(roughness * roughness, 1e-3));
    if (kSpecular || kSpecularGlossiness) {
        vec3 most = vec3(max_component(dielectric));
        precise vec3 hat0 = most + metallic * (base - most);
        g.hat0 = hat0;
        g.f90 = f90 + metallic * (1.0 - f90);
    }
    if (kAnisotropy) {
        float strength = load_record(layers, 6u).z * sample_layer(layers, kAnisotropySlot, s.uvs, false).z;
        g.alphas = vec2(g.alpha + strength * strength * (1.0 - g.alpha), g.alpha);
        g.alpha = strength != 0.0 ? sqrt(g.alphas.x * g.alphas.y) : g.alpha;
    }
    if (kIridescence) {
        add_film(layers, s.uvs, g);
        g.film_base = dielectric;
        g.film_specular = f90;
        g.film_metal = base;
        g.metallic = metallic;
    }
    // (SH-53)
    float seen = ggx_albedo(cos_o, g.alpha);
    vec3 normal_incidence;
    vec3 hat;
    glossy_reflectance(g, 1.0, normal_incidence, hat);
    g.boost = 1.0 + normal_incidence * ((1.0 - seen) / seen);

    if (kThroughLobes) add_transmission(layers, s, base, metallic, g);
    if (kGlassShadows && (s.flags & kPrimitiveGlass) != 0u)
        g.glass = passed_by_glass(s.material, s.uvs, s.color, abs(dot(s.ng, wo)));
    if (kSheen) add_sheen(layers, s.uvs, cos_o, g);
    if (kClearcoat) add_coat(layers, s, local, wo, g);
    return g;
}

// `base` is base colour or reflectance.
Bsdf make_bsdf(Surface s, vec3 base, Frame local, vec3 wo, float cos_o)
{
    vec4 eta_roughness = load_material(s.material, 2u);
    vec4 scalars = load_material(s.material, 4u);  // normal scale, occlusion strength, GGX alpha, model
    Bsdf bsdf;
    bsdf.model = floatBitsToUint(scalars.w);
    bsdf.diffuse = base;
    bsdf.alpha = max(scalars.z, 1e-4);
    bsdf.eta = eta_roughness.xyz;
    bsdf.k = load_material(s.material, 3u).xyz;
    bsdf.excess = s.front ? eta_roughness.x - 1.0 : (1.0 - eta_roughness.x) / eta_roughness.x;
    bool specular_glossiness = kSpecularGlossiness && bsdf.model == kModelSpecularGlossiness;
    if (specular_glossiness) bsdf.model = kModelMetallicRoughness;
    if (kGlossy) bsdf.glossy = make_glossy(s, base, specular_glossiness, local, wo, cos_o);
    return bsdf;
}

// (SH-70)
bool is_glass(Surface s) { return kGlassShadows && (s.flags & kPrimitiveGlass) != 0u; }

// May a sample reflect where the base's normal says that it transmits?
bool has_coat(Bsdf bsdf) { return kClearcoat && bsdf.model == kModelMetallicRoughness && bsdf.glossy.coat > 0.0; }

// (SH-59) The body that a path is in after it leaves s along `direction`.
uint medium_towards(Surface s, vec3 direction, uint medium)
{
    uint layers = layers_of(s.material);
    bool body = load_record(layers, 2u).w > 0.0 && load_record(layers, 5u).y > 0.0;
    bool crosses = body && dot(s.ng, direction) < 0.0;
    return crosses ? (s.front ? s.material : kNoMedium) : medium;
}

// (SH-59) What is left of light after `distance` in it.
vec3 passed_by_medium(uint medium, float distance)
{
    bool inside = medium != kNoMedium;
    vec3 absorption = load_record(layers_of(inside ? medium : 0u), 2u).xyz;
    return inside ? absorbed(absorption, distance) : vec3(1.0);
}

#endif
