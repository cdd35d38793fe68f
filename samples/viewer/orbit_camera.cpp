#include "samples/viewer/orbit_camera.h"

#include <algorithm>
#include <glm/gtc/matrix_transform.hpp>

namespace etalon {
namespace {

constexpr double kZoomStep = 1.1;
constexpr double kNearest = 1e-4;  // of the scene's radius: the eye never reaches what it turns about
constexpr double kFarthest = 1e4;  // likewise

dmat3 turn(double angle, const dvec3& axis)
{
    return dmat3(glm::rotate(dmat4(1), angle, axis));
}

}  // namespace

OrbitCamera::OrbitCamera(const View& view, const dvec3& bounds_min, const dvec3& bounds_max)
    : camera_(view.camera),
      world_from_camera_(view.world_from_camera),
      center_((bounds_min + bounds_max) / 2.0),
      radius_(std::max(length(bounds_max - bounds_min) / 2, 1e-6))
{
    const dvec3 eye(view.world_from_camera[3]);
    const dvec3 forward = -world_from_camera_[2];
    const double along = dot(center_ - eye, forward);
    distance_ = along > kNearest * radius_ ? along : radius_;
    target_ = eye + distance_ * forward;
}

double OrbitCamera::visible_height() const
{
    return camera_.orthographic ? 2 * camera_.ymag : 2 * distance_ * std::tan(camera_.yfov / 2);
}

void OrbitCamera::orbit(double dx, double dy)
{
    world_from_camera_ = turn(-kPi * dx, dvec3(0, 1, 0)) * world_from_camera_;
    const dmat3 tilted = turn(-kPi * dy, world_from_camera_[0]) * world_from_camera_;
    const bool upright = world_from_camera_[1].y >= 0;
    if ((tilted[1].y >= 0) == upright) world_from_camera_ = tilted;
    // Thousands of small turns must not skew the axes.
    world_from_camera_[2] = normalize(world_from_camera_[2]);
    world_from_camera_[0] = normalize(cross(world_from_camera_[1], world_from_camera_[2]));
    world_from_camera_[1] = cross(world_from_camera_[2], world_from_camera_[0]);
}

void OrbitCamera::pan(double dx, double dy)
{
    target_ += visible_height() * (dy * world_from_camera_[1] - dx * world_from_camera_[0]);
}

void OrbitCamera::zoom(double steps)
{
    const double factor = std::pow(kZoomStep, -steps);
    if (camera_.orthographic)
        camera_.ymag = std::clamp(camera_.ymag * factor, kNearest * radius_, kFarthest * radius_);
    else
        distance_ = std::clamp(distance_ * factor, kNearest * radius_, kFarthest * radius_);
}

void OrbitCamera::frame(double aspect)
{
    target_ = center_;
    const double narrow = std::min(aspect, 1.0);
    camera_.ymag = radius_ / narrow;
    distance_ = camera_.orthographic ? 2 * radius_ : radius_ / std::sin(std::atan(std::tan(camera_.yfov / 2) * narrow));
}

View OrbitCamera::view(ivec2 size) const
{
    View out{.width = size.x, .height = size.y, .camera = camera_};
    out.camera.xmag = camera_.ymag * size.x / size.y;
    out.world_from_camera = dmat4(world_from_camera_);
    out.world_from_camera[3] = dvec4(target_ + distance_ * world_from_camera_[2], 1);
    // The file's near plane may lie far out for its own camera; close up it must not cut the scene open.
    out.camera.znear = std::min(camera_.znear, distance_ / 100);
    return out;
}

}  // namespace etalon
