// What a surface sends to the viewer of light from one direction: docs/shading.md §2, §2b.
#ifndef ETALON_SHADERS_RASTER_SCATTER_GLSL
#define ETALON_SHADERS_RASTER_SCATTER_GLSL
#include "shaders/raster/surface.glsl"

/// A surface as one viewer sees it: what does not depend on the light.
struct Seen {
    Surface s;
    vec3 wo;
    float n_v;         // n·wo, clamped (SH-32)
    vec3 f_ms;         // F(1), for M of (SH-53)
    vec3 boost;        // M
    float alpha_t;     // of (SH-52), along the tangent
    float sheen_seen;  // E_s(n·wo)
    float coat_v;      // n_c·wo, clamped
    float coat;        // K of (SH-62)
};

Seen seen_from(Surface s, vec3 wo)
{
    Seen v;
    v.s = s;
    v.wo = wo;
    v.n_v = max(dot(s.n, wo), 1e-4);
    v.alpha_t = kAnisotropy ? mix(s.reflectance.alpha, 1.0, s.layers.anisotropy * s.layers.anisotropy) : s.reflectance.alpha;
    v.f_ms = vec3(0.0);
    v.boost = vec3(1.0);
    if (kGltfModel && !kBlinnPhong) {
        v.f_ms = fresnel(s.reflectance, s.layers, 1.0).f;
        if (kPunctualLights || kEmitters) {
            const float e = ggx_albedo(v.n_v, kAnisotropy ? sqrt(v.alpha_t * s.reflectance.alpha) : s.reflectance.alpha);
            v.boost = 1.0 + v.f_ms * ((1.0 - e) / e);
        }
    }
    v.sheen_seen = kSheen ? sheen_albedo(v.n_v, max(s.layers.sheen_roughness, 0.07)) : 0.0;
    v.coat_v = kClearcoat ? max(dot(s.layers.coat_normal, wo), 1e-4) : 1.0;
    v.coat = kClearcoat ? s.layers.coat * (0.04 + 0.96 * schlick_weight(v.coat_v)) : 0.0;
    return v;
}

/// D V of (SH-11), (SH-12), or of (SH-52); h is unit.
float microfacets(Seen v, vec3 h, vec3 wi, float n_l)
{
    const float alpha = v.s.reflectance.alpha;
    if (!kAnisotropy) return ggx(v.s.n, h, alpha) * smith_visibility(n_l, v.n_v, alpha);
    const vec3 t = v.s.layers.tangent;
    const vec3 b = v.s.layers.bitangent;
    const vec3 scaled = vec3(dot(t, h) / v.alpha_t, dot(b, h) / alpha, dot(v.s.n, h));
    const float q = dot(scaled, scaled);
    const float shade_o = length(vec3(v.alpha_t * dot(t, v.wo), alpha * dot(b, v.wo), v.n_v));
    const float shade_i = length(vec3(v.alpha_t * dot(t, wi), alpha * dot(b, wi), n_l));
    return 0.5 / (kPi * v.alpha_t * alpha * q * q * (n_l * shade_o + v.n_v * shade_i));
}

/// What white sheen gives back of light between the viewer and n_l = |n·wi|; above 1 its lobe is divided by it (SH-61).
float sheen_share(Seen v, float n_l)
{
    return max(v.sheen_seen, sheen_albedo(n_l, max(v.s.layers.sheen_roughness, 0.07)));
}

/// What sheen leaves of the layers below it.
float below_sheen(Seen v, float share)
{
    return max(1.0 - max_component(v.s.layers.sheen_color) * min(share, 1.0), 0.0);
}

/// f n·wi of light from the viewer's side, below the coat; n_l = n·wi > 0.
vec3 reflected(Seen v, vec3 wi, float n_l)
{
    const Reflectance r = v.s.reflectance;
    const vec3 lambert = r.diffuse / kPi;
    if (kModel == kModelLambert) return lambert * n_l;
    const vec3 h = normalize(v.wo + wi);
    if (kBlinnPhong) return (lambert + r.f0 * blinn_phong_lobe(v.s.n, h, r.alpha)) * n_l;
    const Fresnel f = fresnel(r, v.s.layers, dot(v.wo, h));
    vec3 through = 1.0 - f.hat;
    if (kTransmission) through *= 1.0 - v.s.layers.transmission;
    if (kDiffuseTransmission) through *= 1.0 - v.s.layers.diffuse_transmission;
    vec3 sum = through * lambert + f.f * v.boost * microfacets(v, h, wi, n_l);
    if (kSheen) {
        const float alpha = sheen_alpha(v.s.layers.sheen_roughness);
        const vec3 sine = cross(v.s.n, h);
        const float share = sheen_share(v, n_l);
        const float lobe = sheen_d(dot(sine, sine), alpha) * sheen_v_cos(n_l, v.n_v, alpha) / max(share, 1.0);
        return below_sheen(v, share) * n_l * sum + lobe * v.s.layers.sheen_color;
    }
    return sum * n_l;
}

/// f |n·wi| of light from behind a thin surface (SH-56), (SH-57); n_l = -n·wi > 0.
vec3 transmitted(Seen v, vec3 wi, float n_l)
{
    const Layers l = v.s.layers;
    const vec3 mirrored = wi + 2.0 * n_l * v.s.n;
    const vec3 h = normalize(v.wo + mirrored);
    const vec3 through = 1.0 - fresnel(v.s.reflectance, l, dot(v.wo, h)).hat;
    vec3 sum = vec3(0.0);
    if (kDiffuseTransmission)
        sum += l.diffuse_transmission * (1.0 - l.transmission) * (1.0 - v.s.reflectance.metallic) *
               l.diffuse_transmission_color / kPi;
    if (kTransmission && !kVolume) sum += l.transmission * v.s.reflectance.diffuse * microfacets(v, h, mirrored, n_l);
    return (kSheen ? below_sheen(v, sheen_share(v, n_l)) : 1.0) * through * sum * n_l;
}

/// f |n·wi|: 0 unless light from wi reaches the viewer.
vec3 scattered(Seen v, vec3 wi)
{
    const float n_l = dot(v.s.n, wi);
    const float g_l = dot(v.s.ng, wi);
    vec3 sum = vec3(0.0);
    if (n_l > 0.0 && g_l > 0.0) sum = reflected(v, wi, n_l);
    if ((kTransmission || kDiffuseTransmission) && n_l < 0.0 && g_l < 0.0) sum = transmitted(v, wi, -n_l);
    if (kClearcoat) {
        sum *= 1.0 - v.coat;
        const float c_l = dot(v.s.layers.coat_normal, wi);
        if (c_l > 0.0 && g_l > 0.0) {
            const float alpha = max(v.s.layers.coat_roughness * v.s.layers.coat_roughness, 1e-3);
            sum += v.coat * ggx(v.s.layers.coat_normal, normalize(v.wo + wi), alpha) *
                   smith_visibility(c_l, v.coat_v, alpha) * c_l;
        }
    }
    return sum;
}

#endif
