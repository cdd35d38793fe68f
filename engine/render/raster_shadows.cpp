#include "engine/render/raster_shadows.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "engine/render/raster_frame.h"

namespace etalon {
namespace {

constexpr double kTexels = 1 << 24;  // of all maps together: 64 MiB
constexpr double kMostSide = 2048;
constexpr double kLeastSide = 64;
constexpr double kWidestCone = 1.3;  // radians from the axis; beyond it a spot is looked at as a point light is

const std::array<dvec3, 6> kAxes{dvec3(1, 0, 0),  dvec3(-1, 0, 0), dvec3(0, 1, 0),
                                 dvec3(0, -1, 0), dvec3(0, 0, 1),  dvec3(0, 0, -1)};

bool is_cube(const Light& light)
{
    return light.type == LightType::point || (light.type == LightType::spot && light.outer_cone > kWidestCone);
}

/// A camera there that looks along `direction`, unit.
dmat4 look_along(const dvec3& eye, const dvec3& direction)
{
    const dvec3 back = -direction;
    const dvec3 across = normalize(cross(std::abs(back.y) < 0.9 ? dvec3(0, 1, 0) : dvec3(1, 0, 0), back));
    dmat4 world_from_camera(1);
    world_from_camera[0] = dvec4(across, 0);
    world_from_camera[1] = dvec4(cross(back, across), 0);
    world_from_camera[2] = dvec4(back, 0);
    world_from_camera[3] = dvec4(eye, 1);
    return world_from_camera;
}

std::uint32_t side_for(std::size_t maps)
{
    const double side = std::exp2(std::floor(std::log2(std::sqrt(kTexels / double(maps)))));
    return static_cast<std::uint32_t>(std::clamp(side, kLeastSide, kMostSide));
}

}  // namespace

RasterShadows::RasterShadows(gpu::Device& device, const PosedScene& posed)
    : records_(6 * posed.lights.size(), shared::RasterShadow{.light_from_world = mat3(1),
                                                             .eye = vec3(0),
                                                             .half_extent = 1,
                                                             .depth_range = vec2(0),
                                                             .kind = shared::kShadowNone,
                                                             .side = 1,
                                                             .first = 0}),
      eyes_(records_.size(), dvec3(0))
{
    std::size_t count = 0;
    for (const PosedLight& light : posed.lights) count += is_cube(light.light) ? 6 : 1;
    if (count == 0) return;
    side_ = side_for(count);
    const dvec3 center = (posed.bounds_min + posed.bounds_max) / 2.0;
    const double radius = std::max(length(posed.bounds_max - posed.bounds_min) / 2, 1e-9);
    for (std::size_t i = 0; i < posed.lights.size(); ++i) {
        const PosedLight& light = posed.lights[i];
        Camera camera;
        camera.znear = 1e-4 * radius;
        if (light.light.type == LightType::directional) {
            camera.orthographic = true;
            camera.xmag = camera.ymag = 1.01 * radius;
            add(6 * i, center - 1.02 * radius * light.direction, light.direction, camera, shared::kShadowParallel);
        } else if (is_cube(light.light)) {
            // Two texels more on each side, for those that are read about a point at the border.
            camera.yfov = 2 * std::atan(1 + 4.0 / side_);
            for (std::size_t face = 0; face < 6; ++face)
                add(6 * i + face, light.position, kAxes[face], camera, shared::kShadowCube);
        } else {
            camera.yfov = 2 * std::atan(std::tan(std::max(light.light.outer_cone, 1e-3)) * (1 + 4.0 / side_));
            add(6 * i, light.position, light.direction, camera, shared::kShadowCone);
        }
    }
    target_ = {device,
               {.format = VK_FORMAT_D32_SFLOAT,
                .width = side_,
                .height = side_,
                .usage = VK_IMAGE_USAGE_DEPTH_STENCIL_ATTACHMENT_BIT,
                .name = "shadow map"}};
    depths_ = {device, {.size = count * bytes_of_a_map(), .name = "shadow maps"}};
    for (std::size_t i = 0; i < maps_.size(); ++i) {
        const Map& map = maps_[i];
        const RasterProjection projection = project(map.view, posed.bounds_min, posed.bounds_max);
        shared::RasterShadow& record = records_[map.slot];
        record.half_extent = static_cast<float>(projection.film_half.y);
        record.depth_range = vec2(dvec2(projection.near, projection.far));
        record.first = static_cast<shared::uint>(i * side_ * side_);
    }
}

void RasterShadows::add(std::size_t slot, const dvec3& eye, const dvec3& direction, const Camera& camera,
                        shared::uint kind)
{
    const int side = static_cast<int>(side_);
    maps_.push_back(
        {.view = {.width = side, .height = side, .world_from_camera = look_along(eye, direction), .camera = camera},
         .parallel = camera.orthographic,
         .slot = static_cast<std::uint32_t>(slot)});
    shared::RasterShadow& record = records_[slot];
    record.light_from_world = mat3(glm::transpose(dmat3(maps_.back().view.world_from_camera)));
    record.kind = kind;
    record.side = side_;
    eyes_[slot] = eye;
}

std::vector<shared::RasterShadow> RasterShadows::records(const dvec3& eye) const
{
    std::vector<shared::RasterShadow> out = records_;
    for (std::size_t i = 0; i < out.size(); ++i) out[i].eye = vec3(eyes_[i] - eye);
    return out;
}

}  // namespace etalon
