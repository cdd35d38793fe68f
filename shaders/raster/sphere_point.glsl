// A point of an exact sphere, found by the pixel's own ray.
#ifndef ETALON_SHADERS_RASTER_SPHERE_POINT_GLSL
#define ETALON_SHADERS_RASTER_SPHERE_POINT_GLSL
#include "shaders/raster/point.glsl"

layout(push_constant, scalar) uniform SphereBlock { RasterSphere sphere; };

/// Vulkan's standard positions of 4 samples a pixel.
const vec2 kSamplePositions[4] =
    vec2[4](vec2(0.375, 0.125), vec2(0.875, 0.375), vec2(0.125, 0.625), vec2(0.625, 0.875));

/// Where the ray through `pixel` shows the sphere, in metres along the viewing axis; below 0 where it does not. `nearest`
/// is the ray's closest approach to the centre, relative to it. (RT-4) without its cancellations.
float meet_sphere(vec2 pixel, out vec3 origin, out vec3 direction, out vec3 nearest, out float closest)
{
    film_ray(pixel, origin, direction);
    const vec3 f = origin - sphere.center;
    const float dd = dot(direction, direction);
    const float b = -dot(f, direction);
    closest = b / dd;
    nearest = f + closest * direction;
    const float discriminant = sphere.radius * sphere.radius - dot(nearest, nearest);
    if (discriminant < 0.0) return -1.0;
    const float distance = length(f);
    const float c = (distance - sphere.radius) * (distance + sphere.radius);
    const float root = sqrt(dd * discriminant);
    const float q = b >= 0.0 ? b + root : b - root;
    const float other = q == 0.0 ? 0.0 : c / q;
    const float enter = min(q / dd, other);
    const float leave = max(q / dd, other);
    if (enter >= frame.depth_range.x) return enter;
    return !kCullBack && leave >= frame.depth_range.x ? leave : -1.0;
}

/// The samples of this pixel that the sphere covers.
int covered_samples(vec2 corner)
{
    vec3 origin, direction, nearest;
    float closest;
    if (kSamples == 1u) return meet_sphere(corner + 0.5, origin, direction, nearest, closest) > 0.0 ? 1 : 0;
    int mask = 0;
    for (int i = 0; i < 4; ++i)
        if (meet_sphere(corner + kSamplePositions[i], origin, direction, nearest, closest) > 0.0) mask |= 1 << i;
    return mask;
}

/// Reversed depth of a distance along the viewing axis, (TF-4) and (TF-5).
float sphere_depth(float t)
{
    const float near = frame.depth_range.x;
    const float far = frame.depth_range.y;
    return clamp(kOrthographic ? (far - t) / (far - near) : near / t, 0.0, 1.0);
}

/// The point to shade: by the ray of the pixel's centre, or the silhouette nearest to that ray where it misses.
/// `t`: metres along the viewing axis.
Point sphere_point(vec2 center, out float t)
{
    vec3 origin, direction, nearest;
    float closest;
    t = meet_sphere(center, origin, direction, nearest, closest);
    Point p;
    if (t > 0.0) {
        p.position = origin + t * direction;
        p.ng = normalize(p.position - sphere.center);
        p.front = dot(p.ng, towards_viewer(p.position)) > 0.0;
    } else {
        t = max(closest, frame.depth_range.x);
        p.ng = normalize(nearest);
        p.position = sphere.center + sphere.radius * p.ng;
        p.front = true;
    }
    p.n = p.ng;
    p.tangent = vec4(0.0);
    p.uv[0] = Uv(vec2(0.0), vec2(0.0), vec2(0.0));
    p.uv[1] = p.uv[0];
    p.color = vec4(1.0);
    p.scale = sphere.scale;
    return p;
}

#endif
