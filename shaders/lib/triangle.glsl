#ifndef ETALON_LIB_TRIANGLE_GLSL
#define ETALON_LIB_TRIANGLE_GLSL
#include "shaders/lib/numeric.glsl"
#include "shaders/lib/onb.glsl"

// What all triangles share of a ray: its origin, two axes across it and its direction over its squared length.
struct RayFrame {
    vec3 origin;
    vec3 x;
    vec3 y;
    vec3 along;
};

RayFrame make_ray_frame(vec3 origin, vec3 direction)
{
    Frame frame = make_frame(robust_normalize(direction));
    float scale = inverse_scale(largest_of(direction));
    vec3 scaled = direction * scale;
    return RayFrame(origin, frame.x, frame.y, scaled * (scale / dot(scaled, scaled)));
}

struct TriangleHit {
    bool hit;
    bool front;  // the ray meets the side from which the vertices turn counter-clockwise
    float t;     // in lengths of the direction; may be of either sign
    float u;     // barycentrics of p1 and p2
    float v;
};

// (RT-2) The vertices are projected along the ray, each to the same bits whatever triangle it belongs to, and the ray's own
// point (0, 0) is put to three edge functions (TR-1). The sign of a rounded difference of two products is never wrong, only
// zero, and zero counts as inside: rays aimed at the edges and vertices of a closed mesh do not pass (G10; the idea of
// Woop, Benthin & Wald 2013 without its axis permutation).
TriangleHit intersect_triangle(RayFrame ray, vec3 p0, vec3 p1, vec3 p2)
{
    vec3 a = p0 - ray.origin;
    vec3 b = p1 - ray.origin;
    vec3 c = p2 - ray.origin;
    precise float ax = dot(a, ray.x);
    precise float ay = dot(a, ray.y);
    precise float bx = dot(b, ray.x);
    precise float by = dot(b, ray.y);
    precise float cx = dot(c, ray.x);
    precise float cy = dot(c, ray.y);
    precise float e0 = bx * cy - by * cx;
    precise float e1 = cx * ay - cy * ax;
    precise float e2 = ax * by - ay * bx;
    float sum = e0 + e1 + e2;
    vec3 e = vec3(e0, e1, e2);
    bool inside = all(greaterThanEqual(e, vec3(0.0))) || all(lessThanEqual(e, vec3(0.0)));
    float scale = 1.0 / sum;
    float t = (e0 * dot(a, ray.along) + e1 * dot(b, ray.along) + e2 * dot(c, ray.along)) * scale;
    return TriangleHit(inside && sum != 0.0, sum < 0.0, t, e1 * scale, e2 * scale);
}

#endif
