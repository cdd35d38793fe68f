// One ray against the BVH: what both trace kernels share.
#ifndef ETALON_PATH_TRAVERSAL_GLSL
#define ETALON_PATH_TRAVERSAL_GLSL
#include "shaders/path/material.glsl"
#include "shaders/path/primitive.glsl"
#include "shaders/shared/rng.h"

layout(constant_id = kSpecShadow) const bool kShadow = false;
layout(constant_id = kSpecBlendSolid) const bool kBlendSolid = false;

// A ray that is done, as a node reference; and the key of a child that is missed: just above +infinity.
const int kDone = int(0x80000000u);
const int kMissed = 0x7f800001;

struct Ray {
    RayFrame frame;
    vec3 direction;
    vec3 inverse;    // on the BVH's grid: t = q * inverse - shifted
    vec3 shifted;
    uint self;
    uint alpha_key;  // of the random numbers that decide about partly covered surfaces
};

Ray make_ray(vec3 origin, vec3 direction, uint self, uint alpha_key)
{
    vec3 d = direction * frame.grid_scale;
    // Zero components get a tiny value, so that nothing becomes 0 * Inf (G19); on the grid directions are never that small.
    const float tiny = 1e-18;
    d = vec3(abs(d.x) < tiny ? tiny : d.x, abs(d.y) < tiny ? tiny : d.y, abs(d.z) < tiny ? tiny : d.z);
    vec3 inverse = 1.0 / d;
    return Ray(make_ray_frame(origin, direction), direction, inverse, (origin - frame.grid_base) * frame.grid_scale * inverse,
               self, alpha_key);
}

// Entry distance into a child as float bits, or kMissed. Distances are compared as signed integers: the same order for
// values that are not negative, and without the special cases of float min and max.
int child_key(uvec4 child, Ray ray, int t_max)
{
    vec3 low = vec3(int(child.x & 0xffffu), int(child.x >> 16), int(child.y & 0xffffu));
    vec3 high = vec3(int(child.y >> 16), int(child.z & 0xffffu), int(child.z >> 16));
    ivec3 a = floatBitsToInt(low * ray.inverse - ray.shifted);
    ivec3 b = floatBitsToInt(high * ray.inverse - ray.shifted);
    int t_near = max(max(min(a.x, b.x), min(a.y, b.y)), max(min(a.z, b.z), 0));
    int t_far = min(min(max(a.x, b.x), max(a.y, b.y)), min(max(a.z, b.z), t_max));
    return t_near <= t_far ? t_near : kMissed;
}

struct Hit {
    float t;
    uint primitive;
};

// Is a partly covered surface there for this ray? Decided by a number of the ray and the primitive alone, so that the order
// of traversal does not matter (SH-6).
bool is_there(Ray ray, uint primitive, uint flags, float u, float v)
{
    float covered = coverage_at(primitive, flags & kPrimitiveMaterial, vec3(1.0 - u - v, u, v));
    if (kBlendSolid) return covered > 0.0;
    return unit_float(pcg4d(uvec4(ray.alpha_key, primitive, frame.seed, 0x5eed0a1fu)).x) < covered;
}

// (SH-70) What glass lets through, of a shadow ray so far and at the last test.
vec3 passed = vec3(1.0);
vec3 passed_here = vec3(1.0);

vec3 passed_by_primitive(Ray ray, PrimitiveData data, uint primitive, Meeting m, float t_max)
{
    bool sphere = kSpheres && (data.flags & kPrimitiveSphere) != 0u;
    vec3 n = cross(data.p1 - data.p0, data.p2 - data.p0);
    if (sphere) n = ray.frame.origin + m.t * ray.direction - data.p0;
    vec3 w = vec3(1.0 - m.u - m.v, m.u, m.v);
    float cosine = abs(dot(robust_normalize(n), robust_normalize(ray.direction)));
    vec3 once = passed_by_glass(data.flags & kPrimitiveMaterial, uvs_at(primitive, w), color_at(primitive, w), cosine);
    // A sphere that is entered is left again at the same cosine, unless the light is within.
    float out_again = m.t + 2.0 * data.p1.x * cosine / robust_length(ray.direction);
    bool twice = sphere && m.front && (data.flags & kPrimitiveCulled) == 0u && out_again < t_max;
    return twice ? once * once : once;
}

// Tests one primitive; `hit` is replaced where it is met closer.
bool meet(Ray ray, uint primitive, inout Hit hit)
{
    PrimitiveData data = load_primitive(primitive);
    Meeting m = meet_primitive(ray.frame, ray.direction, data);
    bool culled = (data.flags & kPrimitiveCulled) != 0u;
    bool met = m.met && m.t < hit.t && primitive != ray.self && !(culled && !m.front);
    if (kAlpha && met && (data.flags & kPrimitiveAlpha) != 0u) met = is_there(ray, primitive, data.flags, m.u, m.v);
    if (kGlassShadows && kShadow) {
        bool glass = met && (data.flags & kPrimitiveGlass) != 0u;
        passed_here = glass ? passed_by_primitive(ray, data, primitive, m, hit.t) : vec3(1.0);
        met = met && !glass;
    }
    hit.t = met ? m.t : hit.t;
    hit.primitive = met ? primitive : hit.primitive;
    return met;
}

#endif
