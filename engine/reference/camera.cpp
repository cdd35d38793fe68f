#include "engine/reference/camera.h"

namespace etalon::reference {

CameraRays::CameraRays(const View& view)
    : world_from_camera_(view.world_from_camera),
      size_(view.width, view.height),
      extent_(view.camera.xmag, view.camera.ymag),
      orthographic_(view.camera.orthographic && !view.camera.equirectangular),
      equirectangular_(view.camera.equirectangular),
      lens_(view.camera.lens.value_or(ThinLens{})),
      eye_(view.world_from_camera[3]),
      axis_(-normalize(dvec3(view.world_from_camera[2])))
{
    const double half = std::tan(view.camera.yfov / 2);  // of half the angle (TF-4)
    slope_ = {half * size_.x / size_.y, half};
    if (orthographic_ || equirectangular_) lens_.aperture_radius = 0;
}

Ray CameraRays::in_world(const dvec3& origin, const dvec3& direction) const
{
    return {.origin = dvec3(world_from_camera_ * dvec4(origin, 1)),
            .direction = normalize(dmat3(world_from_camera_) * direction)};
}

Ray CameraRays::pinhole(const dvec2& film) const
{
    const dvec2 at(2 * film.x / size_.x - 1, 1 - 2 * film.y / size_.y);
    if (equirectangular_) {  // (TF-9)
        const double longitude = kPi * at.x, polar = kPi / 2 * (1 - at.y);
        return in_world(dvec3(0), dvec3(std::sin(longitude) * std::sin(polar), std::cos(polar),
                                        -std::cos(longitude) * std::sin(polar)));
    }
    if (orthographic_) return in_world(dvec3(at * extent_, 0), dvec3(0, 0, -1));
    return in_world(dvec3(0), dvec3(at * slope_, -1));
}

std::optional<dvec2> CameraRays::film_of(const dvec3& p) const
{
    const dvec3 c = glm::transpose(dmat3(world_from_camera_)) * (p - eye_);
    if (!orthographic_ && c.z >= 0) return std::nullopt;
    const dvec2 at = orthographic_ ? dvec2(c) / extent_ : dvec2(c) / -c.z / slope_;
    return 0.5 * (dvec2(at.x, -at.y) + 1.0) * size_;
}

Ray CameraRays::through_lens(const dvec2& film, const dvec2& lens) const
{
    if (!has_lens()) return pinhole(film);
    const dvec2 at(2 * film.x / size_.x - 1, 1 - 2 * film.y / size_.y);
    const dvec3 focus = lens_.focus_distance * dvec3(at * slope_, -1);
    const dvec3 origin(lens_.aperture_radius * lens, 0);
    return in_world(origin, focus - origin);
}

dvec2 CameraRays::sample_aperture(const dvec2& u) const
{
    const int n = lens_.blades;
    if (n < 3) return sample_disk(u);
    // The parallelogram of two neighbouring corners, of which the half beyond their edge is folded back.
    const int k = std::min(static_cast<int>(u.x * n), n - 1);
    dvec2 b(u.x * n - k, u.y);
    if (b.x + b.y > 1) b = 1.0 - b;
    const auto corner = [&](int i) { return dvec2(std::cos(2 * kPi * i / n), std::sin(2 * kPi * i / n)); };
    return b.x * corner(k) + b.y * corner(k + 1);
}

dvec2 sample_disk(const dvec2& u)
{
    const dvec2 square = 2.0 * u - 1.0;
    if (square == dvec2(0)) return dvec2(0);
    const bool wide = std::abs(square.x) > std::abs(square.y);
    const double r = wide ? square.x : square.y;
    const double angle = wide ? kPi / 4 * (square.y / square.x) : kPi / 2 - kPi / 4 * (square.x / square.y);
    return {r * std::cos(angle), r * std::sin(angle)};
}

}  // namespace etalon::reference
