#ifndef ETALON_LIB_SPHERE_GLSL
#define ETALON_LIB_SPHERE_GLSL
#include "shaders/lib/numeric.glsl"

// (RT-4) The smaller and larger t at which the ray meets the sphere, in lengths of the direction; false where it misses.
// Distances from the closest approach, not b² - 4ac, so that a far or a huge sphere keeps its digits (G14, G15).
bool intersect_sphere(vec3 origin, vec3 direction, vec3 center, float radius, out vec2 t)
{
    vec3 f = origin - center;
    float dd = dot(direction, direction);
    float b = -dot(f, direction);
    vec3 l = f + (b / dd) * direction;
    float discriminant = radius * radius - dot(l, l);
    float distance = sqrt(dot(f, f));
    float c = (distance - radius) * (distance + radius);
    float root = sqrt(dd * max(discriminant, 0.0));
    float q = b < 0.0 ? b - root : b + root;
    float t0 = q / dd;
    float t1 = q != 0.0 ? c / q : 0.0;
    t = vec2(min(t0, t1), max(t0, t1));
    return discriminant >= 0.0;
}

#endif
