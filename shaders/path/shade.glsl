// What happens where a path's segment ends: light is collected, a light is sampled, and the path goes on
// (docs/shading.md §3).
#ifndef ETALON_PATH_SHADE_GLSL
#define ETALON_PATH_SHADE_GLSL
#include "shaders/path/queues.glsl"
#include "shaders/path/lights.glsl"
#include "shaders/path/random.glsl"
#include "shaders/path/reflection.glsl"

// Segments after which Russian roulette begins: the first ones carry most of the picture.
const uint kRouletteAfter = 2u;

// Light collected at the end of a segment, and whether the scene covers it.
struct Collected {
    vec3 light;
    float alpha;
};

Collected leave_scene(PathState path, bool camera_ray)
{
    if (camera_ray && frame.background_mode == kBackgroundTransparent) return Collected(vec3(0.0), 0.0);
    if (camera_ray && frame.background_mode == kBackgroundColour) return Collected(frame.background, 1.0);
    if (!kSky) return Collected(vec3(0.0), 1.0);
    float pdf;
    vec3 value = eval_sky(path.direction, pdf);
    float weight = 1.0;
    if (samples_sky() && path.pdf >= 0.0) weight = power_heuristic(path.pdf, pdf / float(frame.strategy_count));
    return Collected(path.throughput * value * weight, 1.0);
}

vec3 collect_emission(PathState path, Surface s, uint primitive, float t)
{
    if (!s.front && (s.flags & kPrimitiveEmitsBack) == 0u) return vec3(0.0);
    float weight = 1.0;
    if (path.pdf >= 0.0) {
        vec3 from = path.origin;
        if (kGlassShadows) from -= path.reach * path.direction;
        weight = power_heuristic(path.pdf, emitter_pdf(primitive, s, from, path.direction, path.reach + t));
    }
    vec3 value = emission(s.material, s.uvs);
    if (kClearcoat) value *= 1.0 - coat_reflectance(s.material, s.uvs, dot(s.coat_n, path.direction));
    return path.throughput * value * weight;
}

// The value that a reflecting direction must not have through the surface, or a transmitted one in front of it.
bool is_consistent(Surface s, vec3 wi, float local_z) { return (dot(s.ng, wi) > 0.0) == (local_z > 0.0); }

// A ray towards a light, and what comes from there if nothing is in the way.
struct ShadowRay {
    vec3 origin;
    uint self;
    vec3 direction;
    float reach;  // in lengths of the direction
    vec3 light;
    bool punctual;
};

// What the end of a segment gives.
struct Shaded {
    vec4 collected;  // light; alpha of a camera ray, and 2 more where the depth limit cuts the path
    bool casts;      // `shadow` is to be traced
    bool goes_on;    // with `next`
    ShadowRay shadow;
    PathState next;
};

// `path` met `primitive`, or kNoPrimitive, or was lost; segments count from 0. Without `here` nothing comes of it.
Shaded shade(PathState path, uint primitive, uint segment, bool here)
{
    bool lost = primitive == kLostPrimitive;
    bool hit = primitive != kNoPrimitive && !lost;
    bool camera_ray = segment == 0u;
    bool last = segment + 1u >= frame.max_depth;

    uint pixel;
    uint sample_in_pass;
    split_slot(path.slot, pixel, sample_in_pass);
    uint id = picture_pixel(pixel);
    uint sample_index = push.first_sample + sample_in_pass;

    float t;
    Surface s = make_surface(hit ? primitive : 0u, path.origin, path.direction, t);
    vec4 base = base_color(s.material, s.uvs, s.color);
    Frame local = shading_frame(s);
    vec3 wo_local = to_local(local, -path.direction);
    wo_local.z = max(wo_local.z, 1e-7);
    Bsdf bsdf = make_bsdf(s, base.xyz, local, -path.direction, wo_local.z);
    if (kVolume) path.throughput *= passed_by_medium(path.medium, hit ? t : kMaxFloat);

    bool unlit = kUnlit && bsdf.model == kModelUnlit;
    bool black = !s.front && (material_flags(s.material) & kMaterialBlackBack) != 0u;
    bool scatters = here && hit && !unlit && !black;

    Collected collected = Collected(vec3(0.0), 1.0);
    if (primitive == kNoPrimitive) collected = leave_scene(path, camera_ray);
    if (kEmission && hit) collected.light = collect_emission(path, s, primitive, t);
    if (unlit && hit) collected.light = path.throughput * base.xyz;
    // A ray that the traversal gave up: the sample is lost and counted, not guessed.
    if (lost) collected.light = vec3(uintBitsToFloat(0x7fc00000u));

    // Direct light.
    ShadowRay shadow = ShadowRay(path.origin, path.self, path.direction, 0.0, vec3(0.0), false);
    bool casts = false;
    bool glass = is_glass(s);
    if (!last && scatters && !is_delta(bsdf) && !glass) {
        LightSample light = sample_light(s.position, s.n, path_bits(id, sample_index, 2u * segment + 3u));
        vec3 wi_local = to_local(local, light.wi);
        float pdf;
        vec3 value = eval_bsdf(bsdf, wo_local, wi_local, pdf);
        value *= path.throughput * light.value * (light.pdf > 0.0 ? power_heuristic(light.pdf, pdf) : 1.0);
        casts = max_component(value) > 0.0 && (is_consistent(s, light.wi, wi_local.z) || has_coat(bsdf));
        shadow.origin = leave(s, light.wi);
        shadow.self = self_of(s, primitive, light.wi);
        // The whole way to the light is 1: the ray stops just short of it.
        shadow.direction = light.infinite ? light.wi : light.target - shadow.origin;
        shadow.reach = light.infinite ? kMaxFloat : 1.0 - 1e-6;
        if (kVolume) {
            float way = light.infinite ? kMaxFloat : robust_length(shadow.direction);
            value *= passed_by_medium(medium_towards(s, light.wi, path.medium), way);
        }
        shadow.light = value;
        shadow.punctual = !(light.pdf > 0.0);
    }

    // The next segment.
    bool goes_on = false;
    PathState next = path;
    if (scatters) {
        uvec4 bits = path_bits(id, sample_index, 2u * segment + 2u);
        BsdfSample drawn = sample_bsdf(bsdf, wo_local, vec3(unit_float(bits.x), unit_float(bits.y), unit_float(bits.z)));
        next.direction = robust_normalize(to_world(local, drawn.wi));
        next.throughput = path.throughput * drawn.weight;
        next.pdf = drawn.pdf > 0.0 ? drawn.pdf : -1.0;
        next.origin = leave(s, next.direction);
        next.self = self_of(s, primitive, next.direction);
        next.reach = 0.0;
        if (glass) {
            // Glass is no place where light is looked for: what it mirrors is found by chance, what it passes by those before.
            bool straight = drawn.wi.z < 0.0;
            next.pdf = straight ? path.pdf : -1.0;
            next.reach = straight ? path.reach + t : 0.0;
            next.direction = straight ? path.direction : next.direction;
        }
        float carried = max_component(next.throughput);
        if (kVolume) next.medium = medium_towards(s, next.direction, path.medium);
        goes_on = carried > 0.0 && (is_consistent(s, next.direction, drawn.wi.z) || has_coat(bsdf));
        if (frame.roulette != 0u && segment >= kRouletteAfter && !last) {
            float survival = clamp(3.0 * carried, 0.05, 1.0);  // (MC-4)
            goes_on = goes_on && unit_float(bits.w) < survival;
            next.throughput /= survival;
        }
    }
    float alpha = camera_ray ? collected.alpha : 0.0;
    bool cut = last && goes_on;
    return Shaded(vec4(collected.light, alpha + (cut ? 2.0 : 0.0)), casts, goes_on && !last, shadow, next);
}

#endif
