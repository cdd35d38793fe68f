#include "engine/scene/view.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>

#include "engine/base/error.h"
#include "engine/base/limits.h"
#include "engine/scene/builder.h"

namespace etalon {

namespace {

constexpr ivec2 kStandardSize(1280, 720);
constexpr double kFramedAzimuth = 35;  // degrees: a three-quarter view
constexpr double kFramedElevation = 20;

double radians(double degrees)
{
    return degrees * kPi / 180;
}

// Rotation and translation of `m` alone: glTF cameras ignore scale. Also undoes mirroring and shear.
dmat4 rigid(const dmat4& m, const std::string& who)
{
    const dvec3 z = normalize(dvec3(m[2]));
    const dvec3 x = normalize(cross(dvec3(m[1]), z));
    const dmat4 out(dvec4(x, 0), dvec4(cross(z, x), 0), dvec4(z, 0), dvec4(dvec3(m[3]), 1));
    if (!is_finite(x) || !is_finite(z) || !is_finite(dvec3(m[3])))
        throw Error(Blame::input,
                    fmt::format("{} has no direction: its node's world matrix is singular or not finite", who),
                    "repair the node's scale, or choose another camera");
    return out;
}

std::string label(const Scene& scene, const PlacedCamera& placed)
{
    const std::string& name = scene.cameras[placed.camera].name;
    const std::string& node = scene.nodes[placed.node].name;
    return fmt::format("{} \"{}\"", placed.camera, name.empty() ? node : name);
}

const PlacedCamera& find_camera(const Scene& scene, std::span<const PlacedCamera> cameras, const std::string& wanted)
{
    for (const PlacedCamera& placed : cameras)
        if (scene.cameras[placed.camera].name == wanted || scene.nodes[placed.node].name == wanted) return placed;
    Index index = kNone;
    const auto [end, error] = std::from_chars(wanted.data(), wanted.data() + wanted.size(), index);
    if (error == std::errc{} && end == wanted.data() + wanted.size())
        for (const PlacedCamera& placed : cameras)
            if (placed.camera == index) return placed;
    std::string names;
    for (const PlacedCamera& placed : cameras) names += (names.empty() ? "" : ", ") + label(scene, placed);
    throw Error(
        Blame::input, fmt::format("no camera \"{}\" in this scene", wanted),
        cameras.empty() ? "the scene has no camera: leave the option out, or use an orbit" : "choose one of: " + names);
}

double framing_distance(const Subject& subject, double yfov, ivec2 size)
{
    const double vertical = yfov / 2;
    const double horizontal = std::atan(std::tan(vertical) * size.x / size.y);
    return subject.radius / std::sin(std::min(vertical, horizontal));
}

View orbit_view(const Orbit& orbit, const Subject& subject, ivec2 size)
{
    const double yfov = orbit.yfov.value_or(45);
    if (!(yfov > 0 && yfov < 180))
        throw Error(Blame::input, fmt::format("orbit: a field of view of {} degrees", yfov),
                    "between 0 and 180, both excluded");
    const dvec3 target = orbit.target.value_or(subject.center);
    View view{.width = size.x, .height = size.y, .world_from_camera = dmat4(1), .camera = {}};
    view.camera.name = "orbit";
    view.camera.yfov = radians(yfov);
    const double distance = orbit.distance.value_or(framing_distance(subject, view.camera.yfov, size));
    if (!(distance > 0) || !std::isfinite(distance) || !std::isfinite(orbit.azimuth) ||
        !std::isfinite(orbit.elevation) || !is_finite(target))
        throw Error(Blame::input, "orbit: angles and target must be finite and the distance positive",
                    "azimuth,elevation in degrees, distance in metres");
    // Built from the angles, not from an up vector: straight above and below are views like any other.
    view.world_from_camera = translation(target) * rotation_y(radians(orbit.azimuth)) *
                             rotation_x(-radians(orbit.elevation)) * translation(dvec3(0, 0, distance));
    view.camera.znear = std::max(distance * 1e-3, (distance - subject.radius) / 2);
    return view;
}

/// (TF-8) The radius of an aperture at `f_stop`, on a film of kFilmHeight.
constexpr double kFilmHeight = 0.024;  // metres: of the 36 mm x 24 mm that f-stops are commonly thought of on

ThinLens thin_lens(const LensSettings& lens, const View& view, const Subject& subject)
{
    const Camera& camera = view.camera;
    const dvec3 axis = -normalize(dvec3(view.world_from_camera[2]));
    const double ahead = dot(axis, subject.center - dvec3(view.world_from_camera[3]));
    const double focus = lens.focus.value_or(ahead > 0 ? ahead : subject.radius);
    if (!(lens.f_stop > 0) || !(focus > 0) || !std::isfinite(focus) || lens.blades < 0)
        throw Error(Blame::input, "lens: f-stop and focus must be positive and finite, and blades not negative",
                    "for example f-stop 2.8, focus at 1.5 metres, 6 blades");
    if (camera.orthographic || camera.equirectangular)
        throw Error(Blame::input, "lens: only a perspective camera has one", "leave out the lens or the projection");
    const double focal_length = kFilmHeight / (2 * std::tan(camera.yfov / 2));
    return {.aperture_radius = focal_length / (2 * lens.f_stop), .focus_distance = focus, .blades = lens.blades};
}

// What the settings make of the view's camera.
View changed(View view, const Subject& subject, const PoseSettings& settings)
{
    Camera& camera = view.camera;
    if (settings.projection == Projection::orthographic && !camera.orthographic) {
        // As large as perspective shows what is as far away as the scene's centre.
        const dvec3 axis = -normalize(dvec3(view.world_from_camera[2]));
        const double ahead = dot(axis, subject.center - dvec3(view.world_from_camera[3]));
        camera.orthographic = true;
        camera.ymag = std::tan(camera.yfov / 2) * (ahead > 0 ? ahead : subject.radius);
        camera.xmag = camera.ymag * view.width / view.height;
    }
    camera.equirectangular = settings.projection == Projection::equirectangular;
    if (settings.projection != Projection::camera) camera.lens.reset();
    if (settings.lens) camera.lens = thin_lens(*settings.lens, view, subject);
    return view;
}

}  // namespace

ivec2 picture_size(const PoseSettings& settings, const FilmHints& hints)
{
    const ivec2 size = settings.size ? *settings.size : hints.size.value_or(kStandardSize);
    const Limits limits(LimitLevel::none);  // the user's own are the caller's to keep
    const auto most_side = std::int64_t(limits.picture_side);
    const auto most_pixels = std::int64_t(limits.picture_pixels);
    if (size.x < 1 || size.y < 1 || size.x > most_side || size.y > most_side ||
        std::int64_t{size.x} * size.y > most_pixels)
        throw Error(Blame::input, fmt::format("a picture of {}x{} pixels is not possible", size.x, size.y),
                    fmt::format("1 to {} pixels a side, {} in all", most_side, most_pixels));
    return size;
}

View choose_view(const Scene& scene, std::span<const PlacedCamera> cameras, const Subject& subject, ivec2 size,
                 const PoseSettings& settings, std::vector<std::string>& notes)
{
    if (settings.orbit) return changed(orbit_view(*settings.orbit, subject, size), subject, settings);
    if (cameras.empty() && !settings.camera) {
        const Orbit framed{
            .azimuth = kFramedAzimuth, .elevation = kFramedElevation, .distance = {}, .target = {}, .yfov = {}};
        View view = orbit_view(framed, subject, size);
        view.camera.name = "framed";
        notes.push_back(fmt::format("no camera in the scene: framed from azimuth {}, elevation {} degrees",
                                    kFramedAzimuth, kFramedElevation));
        return changed(view, subject, settings);
    }
    const PlacedCamera& placed = settings.camera ? find_camera(scene, cameras, *settings.camera) : cameras.front();
    View view{.width = size.x, .height = size.y, .world_from_camera = dmat4(1), .camera = placed.state};
    view.world_from_camera = rigid(placed.world_from_node, "camera " + label(scene, placed));
    view.camera.xmag = view.camera.ymag * size.x / size.y;
    return changed(view, subject, settings);
}

}  // namespace etalon
