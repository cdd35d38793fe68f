#include "engine/render/raster_frame.h"

#include <algorithm>
#include <cmath>

#include "engine/math/transform.h"
#include "engine/render/material.h"

namespace etalon {
namespace {

dmat3 world_from_camera(const View& view)
{
    return dmat3(view.world_from_camera);
}

/// The farthest corner of the bounds along the viewing axis, metres.
double depth_of_bounds(const View& view, const dvec3& low, const dvec3& high)
{
    const dvec3 axis = -world_from_camera(view)[2];
    double depth = 0;
    for (int corner = 0; corner < 8; ++corner) {
        const dvec3 p{(corner & 1) != 0 ? high.x : low.x, (corner & 2) != 0 ? high.y : low.y,
                      (corner & 4) != 0 ? high.z : low.z};
        depth = std::max(depth, dot(p - eye_of(view), axis));
    }
    return depth;
}

/// (TF-7)
RasterProjection project_forward(const View& view, const dvec3& bounds_min, const dvec3& bounds_max)
{
    const Camera& camera = view.camera;
    const double near = camera.znear;
    const double far = std::max(2 * near, 1.01 * depth_of_bounds(view, bounds_min, bounds_max));
    RasterProjection projection{.near = near, .far = far};
    dmat4& m = projection.clip_from_camera;
    if (camera.orthographic) {
        projection.film_half = dvec2(camera.xmag, camera.ymag);
        m = orthographic(camera.xmag, camera.ymag, near, far);
        m[2][2] = -1 / (far - near);
        m[3][2] = -near / (far - near);
    } else {
        const double half_height = std::tan(camera.yfov / 2);
        projection.film_half = dvec2(half_height * view.width / view.height, half_height);
        m = perspective(camera.yfov, double(view.width) / view.height, near);
        m[2][2] = -far / (far - near);
        m[3][2] = -far * near / (far - near);
    }
    return projection;
}

}  // namespace

RasterProjection project(const View& view, const dvec3& bounds_min, const dvec3& bounds_max, DepthKind kind)
{
    if (kind != DepthKind::reversed_32) return project_forward(view, bounds_min, bounds_max);
    const Camera& camera = view.camera;
    RasterProjection projection{.near = camera.znear};
    if (!camera.orthographic) {
        const double half_height = std::tan(camera.yfov / 2);
        projection.film_half = dvec2(half_height * view.width / view.height, half_height);
        projection.clip_from_camera = perspective(camera.yfov, double(view.width) / view.height, camera.znear);
        return projection;
    }
    projection.film_half = dvec2(camera.xmag, camera.ymag);
    // 1%: what lies on the far side of the bounds is still nearer than the cleared depth.
    const double depth = std::max(depth_of_bounds(view, bounds_min, bounds_max), projection.near);
    projection.far = depth + 0.01 * (depth - projection.near) + 1e-3 * depth + 1e-6;
    projection.clip_from_camera = orthographic(camera.xmag, camera.ymag, projection.near, projection.far);
    return projection;
}

shared::RasterFrame make_frame(const PosedScene& posed, const View& view, const EnvironmentTables* tables,
                               std::uint32_t light_count, std::uint32_t emitter_count, const dvec3& background,
                               vec2 point_and_line, DepthKind depth)
{
    const RasterProjection projection = project(view, posed.bounds_min, posed.bounds_max, depth);
    const dmat3 rotation = world_from_camera(view);
    const Environment& environment = posed.environment;
    shared::RasterFrame frame{
        .clip_from_world = mat4(projection.clip_from_camera * dmat4(glm::transpose(rotation))),
        .world_from_camera = mat3(rotation),
        .environment_radiance = vec3(environment.radiance * environment.scale),
        .environment_turn = vec2(dvec2(std::cos(environment.rotation), std::sin(environment.rotation))),
        .environment_scale = static_cast<float>(environment.scale),
        .film_half = vec2(projection.film_half),
        .size = vec2(static_cast<float>(view.width), static_cast<float>(view.height)),
        .depth_range = vec2(dvec2(projection.near, projection.far)),
        .mirror_size = uvec2(0),
        .light_count = light_count,
        .emitter_count = emitter_count,
        .background = vec4(dvec4(background, 1)),
        .point_size = point_and_line.x,
        .line_width = point_and_line.y};
    if (tables != nullptr) {
        frame.mirror_size = uvec2(tables->mirror_width, tables->mirror_height);
    }
    return frame;
}

void place(const dmat4& world_from_object, const dvec3& eye, shared::RasterDraw& draw)
{
    dmat4 relative = world_from_object;
    relative[3] -= dvec4(eye, 0);
    const dmat4 rows = glm::transpose(relative);
    for (int i = 0; i < 3; ++i) draw.object_rows[i] = vec4(rows[i]);

    const dmat3 m(world_from_object);
    double largest = 0;
    for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 3; ++j) largest = std::max(largest, std::abs(m[i][j]));
    const dmat3 unit = m / (largest > 0 ? largest : 1.0);
    const double sign = is_mirrored(world_from_object) ? -1 : 1;
    draw.handedness = static_cast<float>(sign);
    draw.scale = static_cast<float>(std::cbrt(std::abs(dot(cross(m[0], m[1]), m[2]))));
    draw.normal_matrix = mat3(sign * cofactor(unit));
}

bool is_mirrored(const dmat4& world_from_object)
{
    const dmat3 m(world_from_object);
    return dot(cross(m[0], m[1]), m[2]) < 0;
}

std::optional<PixelBox> pixels_of(const PosedSphere& sphere, const View& view, double near)
{
    const dvec3 c = glm::transpose(world_from_camera(view)) * (sphere.center - eye_of(view));
    const RasterProjection projection = project(view, sphere.center, sphere.center);
    const double front = -c.z - sphere.radius;
    const double back = -c.z + sphere.radius;
    if (back < near) return std::nullopt;
    const dvec2 size(view.width, view.height);
    dvec2 low(0), high = size;
    if (view.camera.orthographic || front > 0) {
        // The box about the sphere, seen from both its near and far side.
        low = size, high = dvec2(0);
        for (const double depth : {front, back})
            for (const double side : {-sphere.radius, sphere.radius}) {
                const double scale = view.camera.orthographic ? 1 : 1 / depth;
                const dvec2 film = (dvec2(c) + dvec2(side)) * scale / projection.film_half;
                const dvec2 pixel = (dvec2(film.x, -film.y) + 1.0) / 2.0 * size;
                low = glm::min(low, pixel);
                high = glm::max(high, pixel);
            }
    }
    // One pixel around it for the rounding of the shader's rays.
    const dvec2 first = glm::clamp(glm::floor(low) - 1.0, dvec2(0), size);
    const dvec2 last = glm::clamp(glm::ceil(high) + 1.0, dvec2(0), size);
    if (last.x <= first.x || last.y <= first.y) return std::nullopt;
    return PixelBox{static_cast<int>(first.x), static_cast<int>(first.y), static_cast<std::uint32_t>(last.x - first.x),
                    static_cast<std::uint32_t>(last.y - first.y)};
}

}  // namespace etalon
