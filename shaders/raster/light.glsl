// The radiance of a surface towards the viewer: docs/shading.md (SH-31), (SH-43) to (SH-45).
#ifndef ETALON_SHADERS_RASTER_LIGHT_GLSL
#define ETALON_SHADERS_RASTER_LIGHT_GLSL
#include "shaders/raster/behind.glsl"
#include "shaders/raster/gathered.glsl"
#include "shaders/raster/shadow.glsl"

/// (SH-22) Irradiance on a surface that faces the light, lux or candela per square metre; `wi` points to it.
vec3 arriving(LightRecord light, vec3 position, out vec3 wi)
{
    if (light.type == kLightDirectional) {
        wi = -light.direction;
        return light.color_intensity;
    }
    const vec3 to_light = light.position - position;
    const float d2 = dot(to_light, to_light);
    wi = to_light * inversesqrt(d2);
    float attenuation = 1.0;
    if (light.type == kLightSpot) {
        const float cone = clamp(dot(light.direction, -wi) * light.spot_scale + light.spot_offset, 0.0, 1.0);
        attenuation = cone * cone;
    }
    if (light.range > 0.0) {
        const float ratio2 = d2 / (light.range * light.range);
        attenuation *= max(min(1.0 - ratio2 * ratio2, 1.0), 0.0);
    }
    return light.color_intensity * (attenuation / d2);
}

vec3 punctual_light(Seen v, vec3 position, Gathered gathered)
{
    vec3 sum = vec3(0.0);
    for (uint i = 0u; i < frame.light_count; ++i) {
        vec3 wi;
        const vec3 irradiance = arriving(lights[i], position, wi);
        vec3 light = scattered(v, wi) * irradiance;
        if (kShadows == kShadowsMap && light != vec3(0.0)) light *= lit_share(i, position, v.s.ng);
        if (kShadows == kShadowsRay && !is_lit(gathered, i)) light = vec3(0.0);
        sum += light;
    }
    return sum;
}

/// (SH-39) Emissive draws and spheres seen as points, but for `object_id` itself.
vec3 emitter_light(Seen v, vec3 position, uint object_id)
{
    vec3 sum = vec3(0.0);
    for (uint i = 0u; i < frame.emitter_count; ++i) {
        const EmitterRecord emitter = emitters[i];
        const vec3 away = emitter.center - position;
        const float d2 = dot(away, away);
        const vec3 wi = away * inversesqrt(max(d2, 1e-30));
        if (emitter.object_id == object_id) continue;
        const float facing = -dot(emitter.area_vector, wi);
        float seen = 0.25 * emitter.area;
        if ((emitter.flags & kEmitterFlat) != 0u)
            seen = (emitter.flags & kEmitterTwoSided) != 0u ? abs(facing) : max(facing, 0.0);
        sum += scattered(v, wi) * emitter.radiance * (seen / max(d2, emitter.area / kPi));
    }
    return sum;
}

/// (SH-34) F0 A + F90 B, and F̂ as diffuse light in a uniform surrounding meets it (SH-33).
Fresnel environment_fresnel(Seen v, vec2 ab)
{
    const Reflectance r = v.s.reflectance;
    const Layers l = v.s.layers;
    const float grazing = 1.0 - v.n_v;
    const float w = grazing * grazing * grazing / 36.0;
    if (kPlainFresnel) return Fresnel(r.f0 * ab.x + ab.y, r.f0 + (1.0 - r.f0) * w);
    const ThinFilm film = make_film(v.n_v, l.film_ior, l.film_thickness);
    vec3 dielectric = l.f0 * ab.x + l.f90 * ab.y;
    vec3 metal = r.metal * ab.x + ab.y;
    vec3 lost = l.f0 + (l.f90 - l.f0) * w;
    vec3 lost_metal = r.metal + (1.0 - r.metal) * w;
    if (kIridescence && l.film > 0.0 && l.film_thickness > 0.0) {
        const vec3 over_dielectric = film_reflectance(film, l.f0);
        dielectric = mix(dielectric, over_dielectric * (ab.x + ab.y), l.film);
        lost = mix(lost, over_dielectric, l.film);
        if (r.metallic > 0.0) {
            const vec3 over_metal = film_reflectance(film, r.metal);
            metal = mix(metal, over_metal * (ab.x + ab.y), l.film);
            lost_metal = mix(lost_metal, over_metal, l.film);
        }
    }
    return Fresnel(mix(dielectric, metal, r.metallic), mix(vec3(max_component(lost)), lost_metal, r.metallic));
}

/// Where reflected light comes from (SH-34); of anisotropic surfaces about a bent normal (SH-65).
vec3 mirrored(Seen v)
{
    if (!kAnisotropy) return dominant_reflection(v.wo, v.s.n, v.s.reflectance.roughness);
    const vec3 b = v.s.layers.bitangent;
    const vec3 along = cross(cross(b, v.wo), b);
    const float size = length(along);
    const float keep = 1.0 - v.s.layers.anisotropy * (1.0 - v.s.reflectance.roughness);
    const float keep2 = keep * keep;
    const vec3 bent = size > 0.0 ? along / size : v.s.n;
    return reflect(-v.wo, normalize(mix(bent, v.s.n, keep2 * keep2)));
}

/// (SH-33), (SH-34) for glTF's models, below the coat.
vec3 environment_on_layers(Seen v)
{
    const Reflectance r = v.s.reflectance;
    const Layers l = v.s.layers;
    const vec2 ab = specular_albedo(r.roughness, v.n_v);
    const Fresnel f = environment_fresnel(v, ab);
    const float e = ab.x + ab.y;
    vec3 through = 1.0 - f.hat;
    if (kTransmission) through *= 1.0 - l.transmission;
    vec3 sum = environment_reflection(mirrored(v), r.roughness) * f.f * (1.0 + v.f_ms * ((1.0 - e) / e));
    const float kept = kDiffuseTransmission ? 1.0 - l.diffuse_transmission : 1.0;
    sum = v.s.occlusion * (sum + kept * through * r.diffuse / kPi * environment_irradiance(v.s.n));
    if (kDiffuseTransmission)
        sum += l.diffuse_transmission * (1.0 - r.metallic) * through * l.diffuse_transmission_color / kPi *
               environment_irradiance(-v.s.n);
    return sum;
}

/// (SH-33), (SH-34), (SH-37); the ambient term of (SH-38).
vec3 environment_light(Seen v)
{
    const Surface s = v.s;
    if (kBlinnPhong) {
        return s.occlusion * (s.reflectance.diffuse + s.reflectance.f0) * environment_irradiance(s.n) / kPi;
    }
    if (kGltfModel) return environment_on_layers(v);
    if (kModel == kModelMirror) return s.occlusion * s.base * environment_reflection(reflect(-v.wo, s.n), 0.0);
    vec3 sum = s.reflectance.diffuse / kPi * environment_irradiance(s.n);
    if (kModel != kModelLambert) {
        const vec2 ab = specular_albedo(s.reflectance.roughness, v.n_v);
        const vec3 r = dominant_reflection(v.wo, s.n, s.reflectance.roughness);
        sum += environment_reflection(r, s.reflectance.roughness) * (s.reflectance.f0 * ab.x + ab.y);
    }
    return s.occlusion * sum;
}

/// Environment and what is seen through the surface, with the layers above the base (SH-65).
vec3 surroundings(Seen v, vec3 position, vec2 pixel)
{
    const Layers l = v.s.layers;
    vec3 sum = vec3(0.0);
    if (kEnvironment != kEnvironmentNone) sum = environment_light(v);
    if (kTransmission)
        sum += (1.0 - fresnel(v.s.reflectance, l, v.n_v).hat) * light_from_behind(v, position, pixel);
    if (kSheen) {
        sum *= below_sheen(v, v.sheen_seen);
        if (kEnvironment != kEnvironmentNone)
            sum += v.s.occlusion * min(v.sheen_seen, 1.0) * l.sheen_color * environment_irradiance(v.s.n) / kPi;
    }
    if (kClearcoat) {
        sum *= 1.0 - v.coat;
        if (kEnvironment != kEnvironmentNone)
            sum += v.s.occlusion * v.coat * environment_reflection(reflect(-v.wo, l.coat_normal), l.coat_roughness);
    }
    return sum;
}

/// (SH-31); what is not lit shows its base colour, and its emission unless it is `unlit` (SH-15).
vec3 radiance(Surface s, vec3 position, uint object_id)
{
    if (kModel == kModelUnlit) return s.base;
    if (!kLit) return s.base + s.emission;
    const Seen v = seen_from(s, towards_viewer(position));
    Gathered gathered = Gathered(vec3(0.0), uvec3(0u), false);
    if (kGatheredLight || kShadows == kShadowsRay) gathered = gathered_at(position, object_id);
    vec3 sum = s.emission * (1.0 - v.coat);
    const bool spread = kModel != kModelMirror || kBlinnPhong;  // a perfect mirror shows no point lights (SH-37)
    if (kPunctualLights && spread) sum += punctual_light(v, position, gathered);
    if (kEmitters && spread) sum += emitter_light(v, position, object_id);
    if (kGatheredLight && gathered.found) return sum + gathered.light;
    if (kEnvironment != kEnvironmentNone || kTransmission) sum += surroundings(v, position, gl_FragCoord.xy);
    return sum;
}

/// The colour to blend over what is behind: premultiplied (SH-32).
vec4 shade(Surface s, vec3 position, uint object_id)
{
    const vec3 color = radiance(s, position, object_id);
    return kAlphaBlend ? vec4(color * s.alpha, s.alpha) : vec4(color, 1.0);
}

#endif
