// A point of an exact sphere, found by the pixel's own ray.
#ifndef ETALON_SHADERS_RASTER_SPHERE_POINT_GLSL
#define ETALON_SHADERS_RASTER_SPHERE_POINT_GLSL
#include "shaders/raster/point.glsl"

layout(push_constant, scalar) uniform SphereBlock { RasterSphere sphere; };

/// Vulkan's standard positions of 1, 2, 4, 8 and 16 samples a pixel (1.3, §25.3), in sixteenths: y, x. Those of n samples
/// begin at n - 1.
const uint kSamplePositions[31] =
    uint[31](0x88u,                                                                                 //
             0xccu, 0x44u,                                                                          //
             0x26u, 0x6eu, 0xa2u, 0xeau,                                                            //
             0x59u, 0xb7u, 0x9du, 0x35u, 0xd3u, 0x71u, 0xfbu, 0x1fu,                                //
             0x99u, 0x57u, 0xa5u, 0x7cu, 0x63u, 0xdau, 0xbdu, 0x3bu, 0xe6u, 0x18u, 0x24u, 0xc2u, 0x80u, 0x4fu, 0xfeu, 0x01u);

vec2 sample_position(uint i)
{
    const uint packed_position = kSamplePositions[kSamples - 1u + i];
    return vec2(packed_position & 15u, packed_position >> 4) / 16.0;
}

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
    int mask = 0;
    for (uint i = 0u; i < kSamples; ++i)
        if (meet_sphere(corner + sample_position(i), origin, direction, nearest, closest) > 0.0) mask |= 1 << i;
    return mask;
}

/// Depth of a distance along the viewing axis, (TF-4), (TF-5), (TF-7).
float sphere_depth(float t)
{
    const float near = frame.depth_range.x;
    const float far = frame.depth_range.y;
    if (kDepth != 0u) {
        const float over = kOrthographic ? t - near : far * (1.0 - near / t);
        return clamp(over / (far - near), 0.0, 1.0);
    }
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
