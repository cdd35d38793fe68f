// Starts a path where a viewing ray meets the surface that its pixel shows, and a shadow ray towards an emitter or the environment (SH-44), and says
// what they would find of an environment that nothing hides: that is looked at more often, as it takes no rays, and is the
// control variate of gather_sum.comp.
#version 460
#extension GL_EXT_scalar_block_layout : require
#extension GL_GOOGLE_include_directive : require
#include "shaders/path/gather.glsl"
#include "shaders/path/shade.glsl"

layout(local_size_x = kPathWorkgroup) in;

layout(set = 0, binding = kBindKnown, std430) writeonly buffer Known { vec4 known[]; };

// Looks at the unhidden environment for each path: beyond 4 they take longer than the path.
const uint kLooks = 4u;
// Dimensions of random numbers that no path of at most 65536 segments uses.
const uint kFirstDimension = 0x20000000u;

// Of light from this side the environment is the greater part. What comes straight through glass is what lies behind it.
bool is_open(Surface s, vec3 wi)
{
    if (!(kTransmission || kDiffuseTransmission || kDielectric || kRoughDielectric) || dot(s.n, wi) > 0.0) return true;
    bool through = !(kDiffuseTransmission && floatBitsToUint(load_material(s.material, 4u).w) == kModelMetallicRoughness);
    if (kTransmission) through = through || load_record(layers_of(s.material), 5u).y > 0.0;
    return !through;
}

// A direction before the shading normal and behind the surface, or the other way round: no path follows it, and as rasterizers do
// not replace normals it sees the environment, or balls under strong normal maps would have dark rims.
bool is_bent(Surface s, vec3 wi) { return (dot(s.ng, wi) > 0.0) != (dot(s.n, wi) > 0.0); }

// What the environment would send to the viewer from the open side, were nothing in the way: one sample of the BSDF and one of
// the map, MIS.
vec3 look(Surface s, Bsdf bsdf, Frame local, vec3 wo, uvec4 of_bsdf, uvec4 of_sky)
{
    vec3 sum = vec3(0.0);
    float sky_pdf;
    BsdfSample drawn = sample_bsdf(bsdf, wo, vec3(unit_float(of_bsdf.x), unit_float(of_bsdf.y), unit_float(of_bsdf.z)));
    vec3 wi = robust_normalize(to_world(local, drawn.wi));
    vec3 light = eval_sky(wi, sky_pdf);
    float weight = samples_sky() && drawn.pdf > 0.0 ? power_heuristic(drawn.pdf, sky_pdf) : 1.0;
    if (is_open(s, wi)) sum = drawn.weight * light * weight;
    if (samples_sky()) {
        wi = sample_sky(of_sky.x, of_sky.y, vec2(unit_float(of_sky.z), unit_float(of_sky.w)), light, sky_pdf);
        float pdf;
        vec3 value = eval_bsdf(bsdf, wo, to_local(local, wi), pdf);
        if (sky_pdf > 0.0 && is_open(s, wi)) sum += value * light * (power_heuristic(sky_pdf, pdf) / sky_pdf);
    }
    return sum;
}

void main()
{
    uint index = gl_GlobalInvocationID.x;
    bool here = index < push.slot_count;
    index = min(index, push.slot_count - 1u);
    PathState viewing = load_path(index);
    uint primitive = imageLoad(hits_in, int(index)).x;
    here = here && primitive != kNoPrimitive && primitive != kLostPrimitive;
    primitive = here ? primitive : 0u;
    // Rays that miss the object of the pixel's centre are not asked.
    here = here && load_primitive(primitive).object == load_primitive(load_point(index).primitive).object;
    Shaded shaded = shade(viewing, primitive, 0u, here);

    float t;
    Surface s = make_surface(primitive, viewing.origin, viewing.direction, t);
    ShadowRay shadow = shaded.shadow;
    PathState next = shaded.next;
    next.reach = 0.0;
    vec3 by_path = vec3(0.0);
    vec3 by_looks = vec3(0.0);
    vec3 found = vec3(0.0);  // without a ray
    // Where nothing scatters, the path is still the viewing ray.
    bool scatters = next.direction != viewing.direction;
    if (kSky && scatters) {
        if (is_open(s, next.direction)) by_path = leave_scene(next, false).light;
        if (!shaded.goes_on && is_bent(s, next.direction)) found = by_path;
        bool towards_sky = shadow.reach == kMaxFloat && !shadow.punctual && is_open(s, shadow.direction);
        if (towards_sky) by_path += shadow.light;
        if (towards_sky && !shaded.casts && is_bent(s, shadow.direction)) found += shadow.light;
        vec4 base = base_color(s.material, s.uvs, s.color);
        Frame local = shading_frame(s);
        vec3 wo = to_local(local, -viewing.direction);
        wo.z = max(wo.z, 1e-7);
        Bsdf bsdf = make_bsdf(s, base.xyz, local, -viewing.direction, wo.z);
        uint id = picture_pixel(viewing.slot);
        for (uint i = 0u; i < kLooks; ++i) {
            uint number = kLooks * push.first_sample + i;
            by_looks += look(s, bsdf, local, wo, path_bits(id, number, kFirstDimension), path_bits(id, number, kFirstDimension + 1u));
        }
        by_looks /= float(kLooks);
    }

    // Punctual lights are the rasterizer's.
    bool casts = shaded.casts && !shadow.punctual;
    uint place = append(counter_at(0u, kCountShadows), casts);
    if (casts) {
        shadows_out[3u * place] = vec4(shadow.origin, uintBitsToFloat(shadow.self));
        shadows_out[3u * place + 1u] = vec4(shadow.direction, shadow.reach);
        shadows_out[3u * place + 2u] = vec4(shadow.light, uintBitsToFloat(viewing.slot));
    }
    place = append(counter_at(1u, kCountPaths), shaded.goes_on);
    if (shaded.goes_on) store_path(place, next);
    if (gl_GlobalInvocationID.x >= push.slot_count) return;
    radiance[viewing.slot] = vec4(found, 0.0);
    known[2u * index] = vec4(by_path, here ? 1.0 : 0.0);
    known[2u * index + 1u] = vec4(by_looks, 0.0);
}
