// Next-event estimation: one kind of light is chosen, then one light of it (docs/shading.md §3).
#ifndef ETALON_PATH_LIGHTS_GLSL
#define ETALON_PATH_LIGHTS_GLSL
#include "shaders/lib/onb.glsl"
#include "shaders/lib/sampling.glsl"
#include "shaders/path/environment.glsl"
#include "shaders/path/light_tree.glsl"
#include "shaders/path/surface.glsl"
#include "shaders/shared/rng.h"

struct LightSample {
    vec3 wi;       // unit, from the shading point
    vec3 target;   // where the shadow ray ends, if not infinitely far
    bool infinite;
    vec3 value;    // radiance / density (with the chance of the choice); irradiance for delta lights
    float pdf;     // over solid angle, with the chance of the choice; 0: delta
};

const LightSample kNoLight = LightSample(vec3(0.0, 0.0, 1.0), vec3(0.0), true, vec3(0.0), 0.0);

// (SH-22) What light `index` sends to a point.
LightSample punctual_light(vec3 from, uint index)
{
    vec4 a = uintBitsToFloat(imageLoad(lights, int(4u * index)));
    vec4 b = uintBitsToFloat(imageLoad(lights, int(4u * index + 1u)));
    vec4 c = uintBitsToFloat(imageLoad(lights, int(4u * index + 2u)));
    float spot_offset = uintBitsToFloat(imageLoad(lights, int(4u * index + 3u)).x);
    uint type = floatBitsToUint(a.w);
    if (type == kLightDirectional) return LightSample(-c.xyz, vec3(0.0), true, a.xyz, 0.0);

    vec3 towards = b.xyz - from;
    float distance = robust_length(towards);
    if (!(distance > 0.0)) return kNoLight;
    vec3 wi = towards / distance;
    vec3 value = a.xyz / distance / distance;
    if (type == kLightSpot) {
        float cone = clamp(dot(c.xyz, -wi) * c.w + spot_offset, 0.0, 1.0);
        value *= cone * cone;
    }
    if (b.w > 0.0) {
        float ratio = distance / b.w;
        value *= max(min(1.0 - (ratio * ratio) * (ratio * ratio), 1.0), 0.0);
    }
    return LightSample(wi, b.xyz, false, value, 0.0);
}

// Of up to this many punctual lights each is weighed; of more, so many neighbours in their list, beginning anywhere.
const uint kWeighedLights = 16u;

// One punctual light, by what each would send to a surface of normal n if nothing were in the way (Talbot et al. 2005). Light
// from behind keeps a little weight: some surfaces transmit.
LightSample sample_punctual(vec3 from, vec3 n, uint pick, float u)
{
    uint first;
    uint low;
    umulExtended(pick, frame.light_count, first, low);
    uint weighed = min(frame.light_count, kWeighedLights);
    LightSample chosen = kNoLight;
    float chosen_weight = 0.0;
    float sum = 0.0;
    for (uint i = 0u; i < weighed; ++i) {
        uint index = first + i < frame.light_count ? first + i : first + i - frame.light_count;
        LightSample light = punctual_light(from, index);
        float cosine = dot(n, light.wi);
        float weight = min(max_component(light.value), 1e30) * (max(cosine, 0.0) + 0.05);
        sum += weight;
        // A reservoir of one, fed by a single number: what is left of it is uniform again.
        float chance = sum > 0.0 ? weight / sum : 0.0;
        bool take = u < chance;
        u = take ? u / max(chance, 1e-20) : (u - chance) / max(1.0 - chance, 1e-20);
        chosen_weight = take ? weight : chosen_weight;
        if (take) chosen = light;
    }
    float scale = float(frame.light_count) / float(weighed) * float(frame.strategy_count);
    chosen.value *= chosen_weight > 0.0 ? scale * (sum / chosen_weight) : 0.0;
    return chosen;
}

// Radiance that an emitter of normal ng sends towards wo from a point of it, on average over its coverage.
vec3 emitted(uint primitive, uint flags, vec3 weights, vec3 ng, vec3 wo)
{
    uint material = flags & kPrimitiveMaterial;
    vec4 uvs = uvs_at(primitive, weights);
    vec3 value = emission(material, uvs);
    if (kClearcoat) {
        // (SH-62) The coat is over the light.
        bool sphere = kSpheres && (flags & kPrimitiveSphere) != 0u;
        vec3 vertex_n = vertex_normal(primitive, weights, ng);
        vec3 n = coat_normal(vertex_n, tangent_at(primitive, weights), material, uvs);
        float cosine = dot(sphere ? ng : n, wo);
        // (SH-4) on the side of wo, whichever that is.
        cosine = cosine * dot(ng, wo) > 0.0 ? cosine : dot(ng, wo);
        value *= 1.0 - coat_reflectance(material, uvs, cosine);
    }
    if (kAlpha) value *= coverage_at(primitive, material, weights);
    return value;
}

LightSample sample_triangle_light(PrimitiveData data, uint primitive, vec3 from, vec2 u)
{
    vec2 b = sample_triangle(u);
    vec3 w = vec3(1.0 - b.x - b.y, b);
    Surface there;
    place_on_triangle(data, w, there);
    vec3 towards = there.position - from;
    float distance = robust_length(towards);
    if (!(distance > 0.0)) return kNoLight;
    vec3 wi = towards / distance;
    float cosine = -dot(there.ng, wi);
    vec3 front = there.ng;
    if ((data.flags & kPrimitiveEmitsBack) != 0u) {
        there.ng = cosine < 0.0 ? -there.ng : there.ng;
        cosine = abs(cosine);
    }
    if (!(cosine > 0.0) || !(data.light_density > 0.0)) return kNoLight;
    float pdf = data.light_density * distance / cosine * distance / float(frame.strategy_count);  // (MC-7)
    // The ray ends a little before the light, so that neither it nor a neighbour in its plane is in the way (G24).
    vec3 target = there.position + there.slack * there.ng;
    return LightSample(wi, target, false, emitted(primitive, data.flags, w, front, -wi) / pdf, pdf);
}

// Density of directions towards a sphere light from `from`, and how they are drawn: within its cone from outside.
float sphere_light_pdf(PrimitiveData data, vec3 from)
{
    float ratio = data.p1.x / max(robust_length(data.p0 - from), 1e-38);
    return ratio < 1.0 ? data.light_density / (cone_solid_angle(ratio * ratio) * float(frame.strategy_count)) : 0.0;
}

// From inside, a sphere light is left to the BSDF's samples: density 0 here and in sphere_light_pdf.
LightSample sample_sphere_light(PrimitiveData data, uint primitive, vec3 from, vec2 u)
{
    vec3 towards = data.p0 - from;
    float distance = robust_length(towards);
    float pdf = sphere_light_pdf(data, from);
    if (!(pdf > 0.0)) return kNoLight;
    float ratio = data.p1.x / distance;
    vec3 wi = to_world(make_frame(towards / distance), sample_cone(u, ratio * ratio));
    // The near root; tangent where rounding makes the ray miss.
    float along = dot(towards, wi);
    vec3 closest = towards - along * wi;
    float t = along - sqrt(max(data.p1.x * data.p1.x - dot(closest, closest), 0.0));
    Surface there;
    place_on_sphere(data, from + t * wi, there);
    vec3 target = there.position + there.slack * there.ng;
    return LightSample(wi, target, false, emitted(primitive, data.flags, vec3(1.0, 0.0, 0.0), there.ng, -wi) / pdf, pdf);
}

LightSample sample_emitter(vec3 from, uint pick, uint threshold, vec2 u)
{
    uint primitive;
    PrimitiveData data;
    if (kLightTree) {
        float chance;
        uint leaf = choose_leaf(from, pick, threshold, chance);
        primitive = imageLoad(emitters, int(leaf)).x;
        data = load_primitive(primitive);
        data.light_density = chance * per_area(data);
    } else {
        uint index;
        uint low;
        umulExtended(pick, frame.emitter_count, index, low);
        uvec4 entry = imageLoad(emitters, int(index));
        primitive = unit_float(threshold) < uintBitsToFloat(entry.x) ? entry.z : entry.y;
        data = load_primitive(primitive);
    }
    if (kSpheres && (data.flags & kPrimitiveSphere) != 0u) return sample_sphere_light(data, primitive, from, u);
    return sample_triangle_light(data, primitive, from, u);
}

// Does next-event estimation draw from this kind of light here? All kinds present have the same chance.
bool samples_emitters() { return kEmission && frame.emitter_count > 0u; }
bool samples_punctual() { return kPunctual && frame.light_count > 0u; }
bool samples_sky() { return kSkyMap && frame.cells_x > 0u; }

LightSample sample_light(vec3 from, vec3 n, uvec4 bits)
{
    if (frame.strategy_count == 0u) return kNoLight;
    uint strategy;
    uint pick;  // what is left of bits.x is uniform again
    umulExtended(bits.x, frame.strategy_count, strategy, pick);
    vec2 u = vec2(unit_float(bits.z), unit_float(bits.w));
    LightSample light = kNoLight;
    uint next = 0u;
    if (samples_emitters()) {
        if (strategy == next) light = sample_emitter(from, pick, bits.y, u);
        ++next;
    }
    if (samples_punctual()) {
        if (strategy == next) light = sample_punctual(from, n, pick, u.x);
        ++next;
    }
    if (samples_sky() && strategy == next) {
        vec3 value;
        float pdf;
        light.wi = sample_sky(pick, bits.y, u, value, pdf);
        light.infinite = true;
        light.pdf = pdf / float(frame.strategy_count);
        light.value = light.pdf > 0.0 ? value / light.pdf : vec3(0.0);
    }
    return light;
}

// The density with which sample_light draws the direction in which a path met an emitter.
float emitter_pdf(uint primitive, Surface s, vec3 from, vec3 wi, float distance)
{
    if (!samples_emitters() || !(s.light_density > 0.0)) return 0.0;
    float density = s.light_density;
    if (kLightTree || kSpheres) {
        PrimitiveData data = load_primitive(primitive);
        if (kLightTree) data.light_density = leaf_chance(from, uint(data.light_density) - 1u) * per_area(data);
        density = data.light_density;
        if (kSpheres && (s.flags & kPrimitiveSphere) != 0u) return sphere_light_pdf(data, from);
    }
    float cosine = abs(dot(s.ng, wi));
    return density * distance / max(cosine, 1e-38) * distance / float(frame.strategy_count);
}

#endif
