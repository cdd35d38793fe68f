// metallic_roughness with glTF's layers (docs/shading.md §2b) in the local frame of the shading normal, wo.z > 0. Lobes whose
// specialization constants are off are compiled away; materials that lack a layer have values at which it changes no bit.
#ifndef ETALON_LIB_GLOSSY_GLSL
#define ETALON_LIB_GLOSSY_GLSL
#include "shaders/lib/albedo.glsl"
#include "shaders/lib/fresnel.glsl"
#include "shaders/lib/ggx.glsl"
#include "shaders/lib/iridescence.glsl"
#include "shaders/lib/onb.glsl"
#include "shaders/lib/sampling.glsl"
#include "shaders/lib/sheen.glsl"

const bool kThroughLobes = kTransmission || kDiffuseTransmission;

struct Glossy {
    vec3 diffuse;  // b (1 - m), times (1 - transmission)(1 - diffuse transmission)
    vec3 f0;       // of F and of F̂ (SH-50), F90 of both
    vec3 hat0;
    float f90;
    vec3 boost;  // M (SH-53)
    float alpha;
    vec2 alphas;  // along and across the frame's x, where they differ (SH-52)
    // (SH-51): film 0: none
    float film;
    float film_ior;
    float film_nanometres;
    vec3 film_base;       // F0_d and F90_d of the dielectric, b and m of the metal
    float film_specular;
    vec3 film_metal;
    float metallic;
    // (SH-56, SH-57)
    vec3 diffuse_through;  // (1 - transmission) g colour (1 - m)
    vec3 through;          // transmission b (1 - m)
    // (SH-58, SH-60): index of wi's side over that of wo's side, less one, for transmission; per channel
    bool body;
    vec3 excess;
    float inner;  // the index of the body where wo is inside, else 0
    // (SH-61): black: none
    vec3 sheen;
    float sheen_roughness;
    float sheen_seen;  // E_s(n·wo)
    // (SH-62): 0: none
    float coat;  // K, seen from wo
    float coat_alpha;
    vec3 coat_n;  // local
    vec3 ng;      // local
    vec3 glass;   // (SH-70) what goes straight through, in the place of (SH-57); black: none
};

// What has no layer but M.
Glossy plain_glossy(vec3 diffuse, vec3 f0, float alpha)
{
    Glossy g;
    g.diffuse = diffuse;
    g.f0 = f0;
    g.hat0 = f0;
    g.f90 = 1.0;
    g.boost = vec3(1.0);
    g.alpha = alpha;
    g.alphas = vec2(alpha);
    g.film = 0.0;
    g.film_ior = 1.3;
    g.film_nanometres = 0.0;
    g.film_base = vec3(0.0);
    g.film_specular = 1.0;
    g.film_metal = vec3(0.0);
    g.metallic = 0.0;
    g.diffuse_through = vec3(0.0);
    g.through = vec3(0.0);
    g.body = false;
    g.excess = vec3(0.0);
    g.inner = 0.0;
    g.sheen = vec3(0.0);
    g.sheen_roughness = 1.0;
    g.sheen_seen = 0.0;
    g.coat = 0.0;
    g.coat_alpha = 1.0;
    g.coat_n = vec3(0.0, 0.0, 1.0);
    g.ng = vec3(0.0, 0.0, 1.0);
    g.glass = vec3(0.0);
    return g;
}

float schlick_weight(float cosine)
{
    float x = clamp(1.0 - cosine, 0.0, 1.0);
    float x2 = x * x;
    return x2 * x2 * x;
}

// F and F̂ (SH-50, SH-51) at the cosine on the outer side.
void glossy_reflectance(Glossy g, float cosine, out vec3 f, out vec3 hat)
{
    float weight = schlick_weight(cosine);
    // precise: the same to the bit whether or not F90 and F̂ of their own are compiled in.
    precise vec3 reflected = g.f0 + (g.f90 - g.f0) * weight;
    precise vec3 lost = reflected;
    if (kSpecular || kSpecularGlossiness) lost = g.hat0 + (g.f90 - g.hat0) * weight;
    f = reflected;
    hat = lost;
    if (kIridescence) {
        ThinFilm film = make_film(cosine, g.film_ior, g.film_nanometres);
        vec3 plain = g.film_base + (g.film_specular - g.film_base) * weight;
        vec3 metal = g.film_metal + (1.0 - g.film_metal) * weight;
        plain = mix(plain, film_reflectance(film, g.film_base), g.film);
        metal = mix(metal, film_reflectance(film, g.film_metal), g.film);
        bool filmed = g.film > 0.0;
        f = filmed ? mix(plain, metal, g.metallic) : f;
        hat = filmed ? mix(vec3(max_component(plain)), metal, g.metallic) : hat;
    }
}

// The same for wo at cosine |wo·h| on its own side: inside a body the cosine is that of the outer side, and where there is
// none the reflection is total (SH-58).
void seen_reflectance(Glossy g, float cosine, out vec3 f, out vec3 hat)
{
    float outer = cosine;
    bool total = false;
    if (kVolume) {
        float square = 1.0 - g.inner * g.inner * max(1.0 - cosine * cosine, 0.0);
        total = g.inner > 0.0 && square < 0.0;
        outer = g.inner > 0.0 ? sqrt(max(square, 0.0)) : cosine;
    }
    glossy_reflectance(g, outer, f, hat);
    if (kVolume && total) {
        f = vec3(g.f90);
        hat = f;
    }
}

float glossy_d(Glossy g, vec3 h)
{
    float value = ggx_d(h, g.alpha);
    if (kAnisotropy) value = g.alphas.x != g.alphas.y ? ggx_d(h, g.alphas) : value;
    return value;
}

float glossy_v(Glossy g, vec3 wi, vec3 wo)
{
    float value = ggx_v_correlated(abs(wi.z), wo.z, g.alpha);
    if (kAnisotropy) value = g.alphas.x != g.alphas.y ? ggx_v_correlated(wi, wo, g.alphas) : value;
    return value;
}

// Density of visible normals h over |wo·h|.
float glossy_vndf_over_cos(Glossy g, vec3 wo, float d)
{
    float over = ggx_g1_over_2cos(wo.z, g.alpha);
    if (kAnisotropy) over = g.alphas.x != g.alphas.y ? 1.0 / (wo.z + ggx_stretched_length(wo, g.alphas)) : over;
    return 2.0 * over * d;
}

vec3 glossy_normal(Glossy g, vec3 wo, vec2 u)
{
    if (kAnisotropy) return sample_ggx_vndf(wo, g.alphas, u);
    return sample_ggx_vndf(wo, g.alpha, u);
}

// (SH-61) What white sheen reflects of light between wo and a direction of cosine |n·wi|; above 1 the sheen is dimmed to 1.
float sheen_reflectance(Glossy g, float cos_i)
{
    return max(g.sheen_seen, sheen_albedo(cos_i, g.sheen_roughness));
}

// (SH-61) What the sheen leaves to the layers below.
float sheen_passed(Glossy g, float reflectance)
{
    return max_component(g.sheen) > 0.0 ? max(1.0 - max_component(g.sheen) * min(reflectance, 1.0), 0.0) : 1.0;
}

// Upper ends of the ranges of a uniform number in which each lobe is drawn (SH-64); the coat has what is left.
struct Lobes {
    float specular;
    float diffuse;
    float diffuse_through;
    float sheen;
};

Lobes make_lobes(Glossy g, vec3 wo)
{
    float reflected = max_component(g.f0 + (g.f90 - g.f0) * schlick_weight(wo.z));
    if (kIridescence && g.film > 0.0) reflected = max(reflected, 0.3);
    float rest = max(1.0 - reflected, 0.0);
    float diffuse = max_component(g.diffuse) * rest;
    float specular = reflected;
    float scattered = diffuse;
    if (kThroughLobes) {
        specular += max_component(g.through) * rest;
        scattered += max_component(g.diffuse_through) * rest;
    }
    float base = 1.0;
    float above_base = 1.0;
    if (kClearcoat) base = g.coat > 0.0 ? 1.0 - clamp(g.coat, 0.1, 0.9) : 1.0;
    above_base = base;
    if (kSheen) {
        float sheen = max_component(g.sheen) * g.sheen_seen;
        float share = sheen / max(sheen + specular + scattered, 1e-6);
        base *= max_component(g.sheen) > 0.0 ? 1.0 - clamp(share, 0.1, 0.9) : 1.0;
    }
    Lobes lobes;
    lobes.specular = base * (scattered > 0.0 ? clamp(specular / (specular + scattered), 0.1, 1.0) : 1.0);
    lobes.diffuse = base;
    lobes.diffuse_through = base;
    if (kThroughLobes && scattered > diffuse)
        lobes.diffuse = lobes.specular + (base - lobes.specular) * (diffuse / scattered);
    lobes.sheen = above_base;
    return lobes;
}

// Chance that a facet with these reflectances transmits rather than reflects.
float through_chance(Glossy g, vec3 f, vec3 hat)
{
    float through = max_component((1.0 - hat) * g.through);
    float reflected = max_component(f);
    return through > 0.0 ? through / (through + reflected) : 0.0;
}

// (SH-58) One channel's transmission through a body: f |n·wi| over t b (1 - m), and its density over that of the lobe.
vec3 eval_bent(Glossy g, vec3 wo, vec3 wi, float excess, out float pdf)
{
    float eta = 1.0 + excess;
    vec3 h = robust_normalize(wo + eta * wi);
    h = h.z < 0.0 ? -h : (h == vec3(0.0) ? vec3(0.0, 0.0, 1.0) : h);
    float oh = dot(wo, h);
    float ih = -dot(wi, h);
    bool bends = oh > 0.0 && ih > 0.0 && excess != 0.0;
    vec3 f;
    vec3 hat;
    seen_reflectance(g, oh, f, hat);
    float sum = oh - eta * ih;
    float d = glossy_d(g, h);
    float scale = bends ? oh * ih / (sum * sum) : 0.0;
    pdf = through_chance(g, f, hat) * glossy_vndf_over_cos(g, wo, d) * eta * eta * scale;
    return (1.0 - hat) * (4.0 * d * glossy_v(g, wi, wo) * -wi.z * scale);
}

// (SH-58, SH-60)
vec3 eval_body(Glossy g, vec3 wo, vec3 wi, out float pdf)
{
    vec3 value = eval_bent(g, wo, wi, g.excess.y, pdf);
    if (kDispersion) {
        vec3 densities;
        vec3 red = eval_bent(g, wo, wi, g.excess.x, densities.x);
        vec3 blue = eval_bent(g, wo, wi, g.excess.z, densities.z);
        bool spreads = g.excess.x != g.excess.z;
        pdf = spreads ? (densities.x + pdf + densities.z) / 3.0 : pdf;
        value = spreads ? vec3(red.x, value.y, blue.z) : value;
    }
    return value * g.through;
}

// (SH-62) The coat's own reflection, f n_c·wi; its density without the chance of the lobe.
float eval_coat(Glossy g, vec3 wo, vec3 wi, out float pdf)
{
    float cos_o = max(dot(g.coat_n, wo), 1e-7);
    float cos_i = dot(g.coat_n, wi);
    vec3 h = robust_normalize(wo + wi);
    bool reflects = g.coat > 0.0 && cos_i > 0.0 && dot(g.ng, wi) > 0.0;
    float cos_h = dot(g.coat_n, h);
    float d = ggx_d(vec3(length(cross(g.coat_n, h)), 0.0, cos_h), g.coat_alpha);
    pdf = reflects ? 0.5 * ggx_g1_over_2cos(cos_o, g.coat_alpha) * d : 0.0;
    return reflects ? g.coat * d * ggx_v_correlated(cos_i, cos_o, g.coat_alpha) * cos_i : 0.0;
}

// f |n·wi|, and the density with which sample_glossy draws wi.
vec3 eval_glossy(Glossy g, vec3 wo, vec3 wi, out float pdf)
{
    Lobes lobes = make_lobes(g, wo);
    bool reflects = wi.z > 0.0;
    float cos_i = abs(wi.z);
    // Light that goes through a thin wall is light reflected, mirrored (SH-56, SH-57).
    vec3 folded = vec3(wi.xy, cos_i);
    vec3 h = robust_normalize(wo + folded);
    vec3 f;
    vec3 hat;
    seen_reflectance(g, dot(wo, h), f, hat);
    float d = glossy_d(g, h);
    vec3 facets = vec3(d * glossy_v(g, folded, wo));
    float seen = 0.25 * lobes.specular * glossy_vndf_over_cos(g, wo, d);
    float scattered = (lobes.diffuse - lobes.specular) * cosine_hemisphere_pdf(cos_i);

    vec3 value = ((1.0 - hat) * g.diffuse / kPi + f * g.boost * facets) * cos_i;
    float through = 0.0;
    if (kTransmission) through = through_chance(g, f, hat);
    if (kThroughLobes) seen *= reflects ? 1.0 - through : through;
    pdf = seen + scattered;
    if (kThroughLobes && !reflects) {
        value = (1.0 - hat) * (g.diffuse_through / kPi + g.through * facets) * cos_i;
        pdf = seen + (lobes.diffuse_through - lobes.diffuse) * cosine_hemisphere_pdf(cos_i);
    }
    if (kVolume && !reflects && g.body) {
        float bent_pdf;
        vec3 bent = eval_body(g, wo, wi, bent_pdf);
        value = (1.0 - hat) * g.diffuse_through / kPi * cos_i + bent;
        pdf = pdf - seen + lobes.specular * bent_pdf;
    }
    if (!kThroughLobes && !reflects) {
        value = vec3(0.0);
        pdf = 0.0;
    }
    if (kSheen) {
        float reflectance = sheen_reflectance(g, cos_i);
        value *= sheen_passed(g, reflectance);
        float alpha = sheen_alpha(g.sheen_roughness);
        float above = sheen_d(dot(h.xy, h.xy), alpha) * sheen_v_cos(cos_i, wo.z, alpha) / max(reflectance, 1.0);
        value += reflects ? g.sheen * above : vec3(0.0);
        pdf += reflects ? (lobes.sheen - lobes.diffuse_through) * cosine_hemisphere_pdf(cos_i) : 0.0;
    }
    if (kClearcoat) {
        float coat_pdf;
        float coat = eval_coat(g, wo, wi, coat_pdf);
        // Where a coat has another normal, the base's side has to be looked at here.
        bool consistent = (dot(g.ng, wi) > 0.0) == reflects || g.coat == 0.0;
        value = (consistent ? value * (1.0 - g.coat) : vec3(0.0)) + coat;
        pdf += (1.0 - lobes.sheen) * coat_pdf;
    }
    return value;
}

struct GlossySample {
    vec3 wi;        // zero where a facet sends it to the side that its lobe does not reach: it carries nothing
    vec3 straight;  // weight of a sample that goes straight through a body of index 1, or glass; else 0
};

// Draws wi by u.xy, the lobe by u.z, what the facet does by what is left of that.
GlossySample sample_glossy(Glossy g, vec3 wo, vec3 u)
{
    Lobes lobes = make_lobes(g, wo);
    vec3 h = glossy_normal(g, wo, u.xy);
    vec3 cosine = sample_cosine_hemisphere(u.xy);
    bool specular = u.z < lobes.specular;
    float oh = dot(wo, h);
    vec3 mirrored = 2.0 * oh * h - wo;
    mirrored = mirrored.z > 0.0 ? mirrored : vec3(0.0);
    GlossySample drawn = GlossySample(specular ? mirrored : cosine, vec3(0.0));
    if (kTransmission) {
        vec3 f;
        vec3 hat;
        seen_reflectance(g, oh, f, hat);
        float chance = through_chance(g, f, hat);
        float left = u.z / max(lobes.specular, 1e-6);
        bool through = specular && left < chance;
        vec3 wi = vec3(drawn.wi.xy, -drawn.wi.z);
        if (kVolume) {
            float excess = g.excess.y;
            if (kDispersion) {
                float third = 3.0 * left / max(chance, 1e-6);
                excess = third < 1.0 ? g.excess.x : (third < 2.0 ? excess : g.excess.z);
            }
            float eta = 1.0 + excess;
            float square = 1.0 - (1.0 - oh * oh) / (eta * eta);
            // Total for this channel: a direction that carries nothing.
            vec3 bent = robust_normalize((oh / eta - sqrt(max(square, 0.0))) * h - wo / eta);
            bent = square > 0.0 && bent.z < 0.0 ? bent : vec3(0.0);
            wi = g.body ? bent : wi;
            if (through && g.body && excess == 0.0) {
                wi = -wo;
                vec3 reflectance;
                seen_reflectance(g, wo.z, reflectance, hat);
                drawn.straight = (1.0 - hat) * g.through / (lobes.specular * chance);
                if (kSheen) drawn.straight *= sheen_passed(g, g.sheen_seen);
                if (kClearcoat) drawn.straight *= 1.0 - g.coat;
            }
        }
        if (kGlassShadows && through && max_component(g.glass) > 0.0) {
            wi = -wo;
            drawn.straight = g.glass / (lobes.specular * chance);
        }
        drawn.wi = through ? wi : drawn.wi;
    }
    if (kDiffuseTransmission && u.z >= lobes.diffuse && u.z < lobes.diffuse_through) drawn.wi.z = -cosine.z;
    if (kClearcoat) {
        Frame coat = make_frame(g.coat_n);
        vec3 wo_coat = to_local(coat, wo);
        wo_coat.z = max(wo_coat.z, 1e-7);
        vec3 h_coat = to_world(coat, sample_ggx_vndf(wo_coat, g.coat_alpha, u.xy));
        vec3 wi = 2.0 * dot(wo, h_coat) * h_coat - wo;
        wi = dot(g.coat_n, wi) > 0.0 && dot(g.ng, wi) > 0.0 ? wi : vec3(0.0);
        drawn.wi = u.z >= lobes.sheen ? wi : drawn.wi;
    }
    return drawn;
}

#endif
