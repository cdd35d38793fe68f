#pragma once
#include <optional>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "engine/base/limits.h"
#include "engine/scene/scene.h"

namespace etalon {

/// Where the viewer stands and how it projects. Camera space: right-handed, +Y up, looks down -Z, metres.
/// Pixel (i, j), row 0 on top, covers film point (sx, sy) = ((i + dx) / width, (j + dy) / height), dx, dy in [0, 1).
/// Perspective: direction normalize((2 sx - 1) tan(yfov/2) width/height, (1 - 2 sy) tan(yfov/2), -1).
/// Orthographic: origin ((2 sx - 1) xmag, (1 - 2 sy) ymag, 0), direction -Z. docs/equations.md.
/// Equirectangular: direction (sin φ sin θ, cos θ, -cos φ sin θ), φ = (2 sx - 1) π, θ = sy π: -Z in the middle, +Y on
/// top.
struct View {
    int width = 0;
    int height = 0;
    dmat4 world_from_camera{1};  ///< rigid: rotation and translation only
    Camera camera;               ///< xmag adjusted to the picture's aspect (ymag kept)
};

/// One primitive in one place.
struct Draw {
    Index mesh = 0;
    Index primitive = 0;
    Index node = 0;
    dmat4 world_from_object{1};
    Index deformed = kNone;  ///< into PosedScene::deformed: the primitive as skin and morph targets shape it
};

struct PosedSphere {
    dvec3 center{0};    ///< world, metres
    double radius = 1;  ///< > 0
    Index material = 0;
    Index node = 0;
};

struct PosedLight {
    Light light;
    dvec3 position{0};          ///< world, metres
    dvec3 direction{0, 0, -1};  ///< in which it shines, world, unit
};

/// What a renderer draws: a scene at one instant, flattened, seen by one view. `scene` must outlive it. Geometry is to
/// be had from primitive(draw) and materials from materials(): those of the scene are as they are before they move.
struct PosedScene {
    const Scene* scene = nullptr;
    View view;
    std::vector<Draw> draws;  ///< visible ones, in depth-first node order
    std::vector<Primitive> deformed;
    std::vector<Material> moved_materials;  ///< as the animation has them, all of them; empty: the scene's
    std::vector<PosedSphere> spheres;
    std::vector<PosedLight> lights;
    Environment environment;             ///< resolved: black when there is none
    dvec3 bounds_min{0}, bounds_max{0};  ///< world box of draws and spheres
    std::vector<std::string> notes;  ///< choices made for the user: "no camera: framed from …", "no light: studio"

    const Primitive& primitive(const Draw& d) const
    {
        return d.deformed != kNone ? deformed[d.deformed] : scene->meshes[d.mesh].primitives[d.primitive];
    }
    const std::vector<Material>& materials() const
    {
        return moved_materials.empty() ? scene->materials : moved_materials;
    }
    const Material& material(const Draw& d) const { return materials()[primitive(d).material]; }
};

struct Orbit {
    double azimuth = 0;              ///< degrees about +Y from +Z
    double elevation = 0;            ///< degrees above the horizon
    std::optional<double> distance;  ///< metres; framed when absent
    std::optional<dvec3> target;     ///< world; centre of the bounds when absent
    std::optional<double> yfov;      ///< degrees; 45 when absent
};

/// A lens put before whatever camera is chosen.
struct LensSettings {
    double f_stop = 8;            ///< focal length / diameter; focal length as of a film 24 mm high (TF-8)
    std::optional<double> focus;  ///< metres along the axis; the centre of the scene's bounds when absent
    int blades = 0;               ///< as ThinLens::blades
};

/// `camera`: as the chosen camera does.
enum class Projection { camera, orthographic, equirectangular };

/// All animations of the file at once; where two move the same thing, the later one does.
inline constexpr const char* kEveryAnimation = "all";

struct PoseSettings {
    std::optional<Index> root;          ///< which glTF scene; the file's default when absent
    std::optional<std::string> camera;  ///< name or index
    std::optional<Orbit> orbit;         ///< instead of a camera
    std::optional<LensSettings> lens;   ///< the camera's own when absent
    Projection projection = Projection::camera;
    std::optional<ivec2> size;               ///< pixels; the scene's hint, else 1280x720
    std::optional<Environment> environment;  ///< replaces the scene's (its rotation and scale below still apply)
    bool no_environment = false;             ///< black
    double environment_rotation = 0;         ///< degrees, added
    double environment_intensity = 1;        ///< multiplied
    std::optional<double> time;              ///< seconds into the animation, held at its ends; absent: the rest pose
    std::optional<std::string> animation;  ///< name, index or kEveryAnimation; the first when absent. Alone: at time 0
    std::optional<std::pair<dvec3, dvec3>> framed;  ///< world box that a framed or orbiting view shows; that of this
                                                    ///< instant when absent
    Limits limits{};                                ///< draws and posed_bytes are of this step
};

/// Poses nodes, skins and morph targets at the settings' time, flattens the node forest, picks or frames the camera,
/// and adds the neutral studio environment where the scene has no light of its own: no environment, no punctual light,
/// and no emission but textures of ordinary strength (at most 1).
PosedScene pose(const Scene& scene, const PoseSettings& settings = {});

/// The neutral studio: an equirectangular map with a mean radiance near 1 nit, soft key from above.
Environment studio_environment();

}  // namespace etalon
