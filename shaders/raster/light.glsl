// The radiance of a surface towards the viewer: docs/shading.md (SH-31), without shadows.
#ifndef ETALON_SHADERS_RASTER_LIGHT_GLSL
#define ETALON_SHADERS_RASTER_LIGHT_GLSL
#include "shaders/raster/environment.glsl"
#include "shaders/raster/surface.glsl"

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

vec3 punctual_light(Surface s, vec3 position, vec3 wo, float n_v)
{
    vec3 sum = vec3(0.0);
    for (uint i = 0u; i < frame.light_count; ++i) {
        vec3 wi;
        const vec3 irradiance = arriving(lights[i], position, wi);
        const float n_l = dot(s.n, wi);
        if (n_l > 0.0 && dot(s.ng, wi) > 0.0) sum += reflected(s.reflectance, s.n, wo, wi, n_v) * irradiance * n_l;
    }
    return sum;
}

/// (SH-39) Emissive draws and spheres seen as points, but for `object_id` itself.
vec3 emitter_light(Surface s, vec3 position, vec3 wo, float n_v, uint object_id)
{
    vec3 sum = vec3(0.0);
    for (uint i = 0u; i < frame.emitter_count; ++i) {
        const EmitterRecord emitter = emitters[i];
        const vec3 away = emitter.center - position;
        const float d2 = dot(away, away);
        const vec3 wi = away * inversesqrt(max(d2, 1e-30));
        const float n_l = dot(s.n, wi);
        if (emitter.object_id == object_id || n_l <= 0.0 || dot(s.ng, wi) <= 0.0) continue;
        const float facing = -dot(emitter.area_vector, wi);
        float seen = 0.25 * emitter.area;
        if ((emitter.flags & kEmitterFlat) != 0u)
            seen = (emitter.flags & kEmitterTwoSided) != 0u ? abs(facing) : max(facing, 0.0);
        sum += reflected(s.reflectance, s.n, wo, wi, n_v) * emitter.radiance * (n_l * seen / max(d2, emitter.area / kPi));
    }
    return sum;
}

/// (SH-33), (SH-34), (SH-37); the ambient term of (SH-38).
vec3 environment_light(Surface s, vec3 wo, float n_v)
{
    if (kBlinnPhong) {
        return s.occlusion * (s.reflectance.diffuse + s.reflectance.f0) * environment_irradiance(s.n) / kPi;
    }
    const vec3 r = reflect(-wo, s.n);
    if (kModel == kModelMirror) return s.occlusion * s.base * environment_reflection(r, 0.0);
    vec3 sum = s.reflectance.diffuse / kPi * environment_irradiance(s.n);
    if (kModel != kModelLambert) {
        const vec2 ab = specular_albedo(s.reflectance.roughness, n_v);
        sum += environment_reflection(r, s.reflectance.roughness) * (s.reflectance.f0 * ab.x + ab.y);
    }
    return s.occlusion * sum;
}

/// (SH-31); what is not lit shows its base colour, and its emission unless it is `unlit` (SH-15).
vec3 radiance(Surface s, vec3 position, uint object_id)
{
    if (kModel == kModelUnlit) return s.base;
    if (!kLit) return s.base + s.emission;
    const vec3 wo = towards_viewer(position);
    const float n_v = max(dot(s.n, wo), 1e-4);
    vec3 sum = s.emission;
    const bool spread = kModel != kModelMirror || kBlinnPhong;  // a perfect mirror shows no point lights (SH-37)
    if (kPunctualLights && spread) sum += punctual_light(s, position, wo, n_v);
    if (kEmitters && spread) sum += emitter_light(s, position, wo, n_v, object_id);
    if (kEnvironment != kEnvironmentNone) sum += environment_light(s, wo, n_v);
    return sum;
}

/// The colour to blend over what is behind: premultiplied (SH-32).
vec4 shade(Surface s, vec3 position, uint object_id)
{
    const vec3 color = radiance(s, position, object_id);
    return kAlphaBlend ? vec4(color * s.alpha, s.alpha) : vec4(color, 1.0);
}

#endif
