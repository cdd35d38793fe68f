// Where a ray meets one primitive: the same function for the traversal and for shading, so that both agree to the bit.
#ifndef ETALON_PATH_PRIMITIVE_GLSL
#define ETALON_PATH_PRIMITIVE_GLSL
#include "shaders/lib/sphere.glsl"
#include "shaders/lib/triangle.glsl"
#include "shaders/path/scene_data.glsl"

struct Meeting {
    bool met;    // at t > 0
    bool front;  // from outside, for spheres
    float t;     // in lengths of the direction
    float u;     // barycentrics of p1 and p2; 0 for spheres
    float v;
};

Meeting meet_primitive(RayFrame ray, vec3 direction, PrimitiveData data)
{
    Meeting m = Meeting(false, true, 0.0, 0.0, 0.0);
    if (kTriangles) {
        TriangleHit hit = intersect_triangle(ray, data.p0, data.p1, data.p2);
        m = Meeting(hit.hit && hit.t > 0.0, hit.front, hit.t, hit.u, hit.v);
    }
    if (kSpheres && (data.flags & kPrimitiveSphere) != 0u) {
        vec2 both;
        bool crosses = intersect_sphere(ray.origin, direction, data.p0, data.p1.x, both);
        bool enters = both.x > 0.0;
        float t = enters ? both.x : both.y;
        m = Meeting(crosses && t > 0.0, enters, t, 0.0, 0.0);
    }
    return m;
}

#endif
