// The BSDFs of docs/shading.md §2 in the local frame of the shading normal: wo.z > 0. The includer defines, as constants,
// which models and layers can occur (kMetallicRoughness … kDiffuseTransmission); the others are compiled away.
#ifndef ETALON_LIB_BSDF_GLSL
#define ETALON_LIB_BSDF_GLSL
#include "shaders/lib/fresnel.glsl"
#include "shaders/lib/ggx.glsl"
#include "shaders/lib/glossy.glsl"
#include "shaders/lib/sampling.glsl"
#include "shaders/shared/material.h"

const bool kGlossy = kMetallicRoughness || kSpecularGlossiness;

struct Bsdf {
    uint model;
    vec3 diffuse;  // reflectance of lambert and mirror
    float alpha;
    vec3 eta;      // rough_conductor
    vec3 k;
    float excess;  // dielectrics: index of the far side over that of wo's side, minus 1
    Glossy glossy;  // metallic_roughness, and specular_glossiness in its terms
};

struct BsdfSample {
    vec3 wi;
    vec3 weight;  // f |n·wi| / pdf; zero: no sample
    float pdf;    // over solid angle; 0 for a delta lobe
};

const BsdfSample kNoBsdfSample = BsdfSample(vec3(0.0, 0.0, 1.0), vec3(0.0), 0.0);

bool is_delta(Bsdf bsdf)
{
    bool delta = kMirror && bsdf.model == kModelMirror;
    delta = delta || (kDielectric && bsdf.model == kModelDielectric);
    // Index 1 bends nothing: a rough boundary of it is no boundary (S29).
    return delta || (kRoughDielectric && bsdf.model == kModelRoughDielectric && bsdf.excess == 0.0);
}

// (SH-17) f n·wi
vec3 eval_rough_conductor(Bsdf bsdf, vec3 wo, vec3 wi, vec3 h, out float pdf)
{
    float seen = ggx_vndf_over_cos(wo, h, bsdf.alpha);
    pdf = 0.25 * seen;
    return conductor_fresnel(dot(wo, h), bsdf.eta, bsdf.k) * (0.25 * seen * ggx_g1(wi.z, bsdf.alpha));
}

// (SH-19) f |n·wi|; h is on wo's side and need not be rebuilt from wi when it was sampled (S29).
float eval_rough_dielectric(Bsdf bsdf, vec3 wo, vec3 wi, vec3 h, out float pdf)
{
    float oh = dot(wo, h);
    float ih = dot(wi, h);
    pdf = 0.0;
    bool reflects = wi.z > 0.0;
    if (oh <= 0.0 || h.z <= 0.0 || (reflects ? ih <= 0.0 : ih >= 0.0)) return 0.0;
    float cos_t;
    float fresnel = dielectric_fresnel(oh, bsdf.excess, cos_t);
    float seen = ggx_vndf_over_cos(wo, h, bsdf.alpha);
    float g1 = ggx_g1(wi.z, bsdf.alpha);
    float eta = 1.0 + bsdf.excess;
    float sum = oh + eta * ih;
    float through = (1.0 - fresnel) * seen * oh * abs(ih) / (sum * sum);
    pdf = reflects ? 0.25 * fresnel * seen : through * eta * eta;
    return (reflects ? 0.25 * fresnel * seen : through) * g1;
}

// The half vector of a pair of directions; for transmission that of wo + eta wi, turned to +n.
vec3 half_vector(Bsdf bsdf, vec3 wo, vec3 wi)
{
    vec3 h = wo + wi;
    if (kRoughDielectric && wi.z < 0.0) h = wo + (1.0 + bsdf.excess) * wi;
    h = robust_normalize(h);
    return h.z < 0.0 ? -h : h;
}

// f |n·wi| and the density with which sample_bsdf draws wi; zero for delta lobes.
vec3 eval_bsdf(Bsdf bsdf, vec3 wo, vec3 wi, out float pdf)
{
    vec3 value = vec3(0.0);
    pdf = 0.0;
    vec3 h = half_vector(bsdf, wo, wi);
    if (kGlossy && bsdf.model == kModelMetallicRoughness) {
        value = eval_glossy(bsdf.glossy, wo, wi, pdf);
    } else if (kRoughDielectric && bsdf.model == kModelRoughDielectric && bsdf.excess != 0.0) {
        value = vec3(eval_rough_dielectric(bsdf, wo, wi, h, pdf));
    } else if (wi.z > 0.0) {
        if (kLambert && bsdf.model == kModelLambert) {
            pdf = cosine_hemisphere_pdf(wi.z);
            value = bsdf.diffuse * pdf;
        } else if (kRoughConductor && bsdf.model == kModelRoughConductor) {
            value = eval_rough_conductor(bsdf, wo, wi, h, pdf);
        }
    }
    return value;
}

BsdfSample sample_dielectric(Bsdf bsdf, vec3 wo, float choice)
{
    float cos_t;
    float fresnel = dielectric_fresnel(wo.z, bsdf.excess, cos_t);
    float eta = 1.0 + bsdf.excess;
    if (choice < fresnel) return BsdfSample(vec3(-wo.xy, wo.z), vec3(1.0), 0.0);
    return BsdfSample(robust_normalize(vec3(-wo.xy / eta, -cos_t)), vec3(1.0 / (eta * eta)), 0.0);
}

BsdfSample sample_rough_dielectric(Bsdf bsdf, vec3 wo, vec3 h, float choice)
{
    float cos_t;
    float oh = dot(wo, h);
    float fresnel = dielectric_fresnel(oh, bsdf.excess, cos_t);
    float eta = 1.0 + bsdf.excess;
    bool reflects = choice < fresnel;
    vec3 wi = robust_normalize(reflects ? 2.0 * oh * h - wo : (oh / eta - cos_t) * h - wo / eta);
    float pdf;
    float value = reflects == (wi.z > 0.0) ? eval_rough_dielectric(bsdf, wo, wi, h, pdf) : 0.0;
    if (!(value > 0.0 && pdf > 0.0)) return kNoBsdfSample;
    // f |n·wi| / pdf is G1 and the radiance scaling alone; the quotient of the two would lose it near the peak (S16).
    float scale = reflects ? 1.0 : 1.0 / (eta * eta);
    return BsdfSample(wi, vec3(scale * ggx_g1(wi.z, bsdf.alpha)), pdf);
}

// Draws wi by u.xy, and which lobe by u.z.
BsdfSample sample_bsdf(Bsdf bsdf, vec3 wo, vec3 u)
{
    if (kMirror && bsdf.model == kModelMirror) return BsdfSample(vec3(-wo.xy, wo.z), bsdf.diffuse, 0.0);
    if (kDielectric && bsdf.model == kModelDielectric) return sample_dielectric(bsdf, wo, u.z);

    vec3 h = vec3(0.0, 0.0, 1.0);
    if (kRoughConductor || kRoughDielectric) h = sample_ggx_vndf(wo, bsdf.alpha, u.xy);
    if (kRoughDielectric && bsdf.model == kModelRoughDielectric) {
        if (bsdf.excess == 0.0) return BsdfSample(-wo, vec3(1.0), 0.0);
        return sample_rough_dielectric(bsdf, wo, h, u.z);
    }

    bool specular = kRoughConductor && bsdf.model == kModelRoughConductor;
    vec3 wi = specular ? 2.0 * dot(wo, h) * h - wo : sample_cosine_hemisphere(u.xy);
    if (kGlossy && bsdf.model == kModelMetallicRoughness) {
        GlossySample drawn = sample_glossy(bsdf.glossy, wo, u);
        if ((kVolume || kGlassShadows) && max_component(drawn.straight) > 0.0) return BsdfSample(drawn.wi, drawn.straight, 0.0);
        if (drawn.wi == vec3(0.0)) return kNoBsdfSample;
        wi = drawn.wi;
    }
    float pdf;
    vec3 value = eval_bsdf(bsdf, wo, wi, pdf);
    if (!(pdf > 0.0)) return kNoBsdfSample;
    return BsdfSample(wi, value / pdf, pdf);
}

#endif
