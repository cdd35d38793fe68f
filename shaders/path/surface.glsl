// The surface at a hit (docs/shading.md §1).
#ifndef ETALON_PATH_SURFACE_GLSL
#define ETALON_PATH_SURFACE_GLSL
#include "shaders/path/material.glsl"
#include "shaders/path/primitive.glsl"

// What a point may be away from the true surface, over the largest coordinate that it was made of: 32 u covers the rounding
// of barycentric interpolation (4 u) and of the next intersection with a coplanar neighbour (about 10 u) (G23, RT-6).
const float kOffset = 1.9073486e-6;

struct Surface {
    vec3 position;
    float slack;    // metres by which rays that leave must be moved off
    vec3 ng;        // towards wo
    vec3 n;         // shading normal, on wo's side
    bool front;     // wo is on the side that the geometric normal points to
    uint material;
    uint flags;     // of the primitive
    vec3 coat_n;    // normal of a clearcoat (SH-62), on wo's side
    vec4 tangent;   // as interpolated, w the bitangent's sign; zero: none
    vec4 uvs;
    vec4 color;
    float light_density;
    uint object;
};

// Where on the primitive: barycentric weights and the geometric normal of the front.
vec3 triangle_normal(PrimitiveData data) { return robust_normalize(cross(data.p1 - data.p0, data.p2 - data.p0)); }

void place_on_triangle(PrimitiveData data, vec3 w, inout Surface s)
{
    vec3 a = w.x * data.p0, b = w.y * data.p1, c = w.z * data.p2;
    s.position = a + b + c;
    vec3 largest = max(abs(data.p0), max(abs(data.p1), abs(data.p2)));
    s.slack = kOffset * max_component(largest);
    s.ng = triangle_normal(data);
}

void place_on_sphere(PrimitiveData data, vec3 point, inout Surface s)
{
    s.ng = robust_normalize(point - data.p0);
    s.position = data.p0 + data.p1.x * s.ng;
    s.slack = kOffset * (max_component(abs(data.p0)) + data.p1.x);
}

// (SH-2) The interpolated normal of the front.
vec3 vertex_normal(uint primitive, vec3 w, vec3 ng)
{
    if (!kNormals) return ng;
    vec3 n = robust_normalize(interpolate(primitive, 0u, w).xyz);
    return n == vec3(0.0) ? ng : n;
}

vec4 tangent_at(uint primitive, vec3 w)
{
    vec4 tangent = vec4(0.0);
    if (kTangents) tangent = interpolate(primitive, kTangentAt, w);
    return tangent;
}

// (SH-2) n as the normal map in a slot of a record turns it.
vec3 mapped_normal(vec3 n, vec4 tangent, uint record, uint slot, float scale, vec4 uvs)
{
    vec3 t = robust_normalize(tangent.xyz);
    vec3 b = cross(n, t) * (tangent.w < 0.0 ? -1.0 : 1.0);
    vec4 none = vec4(0.5, 0.5, 1.0, 1.0);
    vec3 texel = 2.0 * sample_record_slot(record, slot, uvs, false, none).xyz - 1.0;
    vec3 mapped = robust_normalize(scale * (texel.x * t + texel.y * b) + texel.z * n);
    bool usable = t != vec3(0.0) && mapped != vec3(0.0);
    return usable ? mapped : n;
}

// (SH-2) The shading normal of the front.
vec3 shading_normal(vec3 n, vec4 tangent, uint material, vec4 uvs)
{
    if (!kNormalTexture || !kTangents) return n;
    float scale = load_material(material, 4u).x;
    return mapped_normal(n, tangent, kMaterialTexels * material, kNormalSlot, scale, uvs);
}

// (SH-62) The coat's: with its own map, else the interpolated one.
vec3 coat_normal(vec3 n, vec4 tangent, uint material, vec4 uvs)
{
    if (!kClearcoat || !kLayerTextures || !kTangents) return n;
    uint layers = layers_of(material);
    return mapped_normal(n, tangent, layers, kClearcoatNormalSlot, load_record(layers, 5u).x, uvs);
}

// (SH-62) K, seen from a direction at this cosine to the coat's normal.
float coat_reflectance(uint material, vec4 uvs, float cosine)
{
    uint layers = layers_of(material);
    float x = clamp(1.0 - abs(cosine), 0.0, 1.0);
    float coat = load_record(layers, 4u).z * sample_layer(layers, kClearcoatSlot, uvs, false).x;
    return coat * (0.04 + 0.96 * ((x * x) * (x * x) * x));
}

// The surface where a ray met `primitive`; `t` receives how far that is.
Surface make_surface(uint primitive, vec3 origin, vec3 direction, out float t)
{
    PrimitiveData data = load_primitive(primitive);
    bool sphere = kSpheres && (data.flags & kPrimitiveSphere) != 0u;
    Meeting m = meet_primitive(make_ray_frame(origin, direction), direction, data);
    vec3 w = vec3(1.0 - m.u - m.v, m.u, m.v);
    vec3 wo = -direction;
    t = m.t;
    Surface s;
    s.flags = data.flags;
    s.material = data.flags & kPrimitiveMaterial;
    s.light_density = data.light_density;
    s.object = data.object;
    place_on_triangle(data, w, s);
    if (sphere) place_on_sphere(data, origin + t * direction, s);
    s.uvs = uvs_at(primitive, w);
    s.color = color_at(primitive, w);
    s.tangent = tangent_at(primitive, w);
    if (sphere) s.tangent = vec4(0.0);
    vec3 n = vertex_normal(primitive, w, s.ng);
    s.n = shading_normal(n, s.tangent, s.material, s.uvs);
    s.coat_n = coat_normal(n, s.tangent, s.material, s.uvs);
    if (sphere) s.n = s.ng;
    if (sphere) s.coat_n = s.ng;
    s.front = dot(s.ng, wo) > 0.0;
    if (!s.front) {
        s.ng = -s.ng;
        s.n = -s.n;
        s.coat_n = -s.coat_n;
    }
    if (dot(s.n, wo) <= 0.0) s.n = s.ng;  // (SH-4)
    if (dot(s.coat_n, wo) <= 0.0) s.coat_n = s.ng;
    return s;
}

// Where a ray along `direction` starts, and what it need not meet: the triangle itself, or the outside of a sphere.
vec3 leave(Surface s, vec3 direction)
{
    float side = dot(direction, s.ng) < 0.0 ? -1.0 : 1.0;
    return s.position + side * s.slack * s.ng;
}

uint self_of(Surface s, uint primitive, vec3 direction)
{
    bool sphere = kSpheres && (s.flags & kPrimitiveSphere) != 0u;
    bool outward = (dot(direction, s.ng) > 0.0) == s.front;
    return sphere && !outward ? kNoPrimitive : primitive;
}

#endif
