#pragma once
#include <optional>
#include <vector>

#include "engine/reference/surface.h"

namespace etalon::reference {

/// (MC-3) Weight of a sample drawn with density `p` where `q` is the density of the other way to draw it.
double power_heuristic(double p, double q);

/// What a punctual light sends to a point. (SH-22)
struct Incident {
    dvec3 wi{0};          ///< unit, towards the light
    double distance = 0;  ///< metres; infinite for directional lights
    dvec3 irradiance{0};  ///< on a surface facing it: I · attenuation / d², or E
};
Incident incident(const PosedLight& light, const dvec3& p);

/// A point drawn on an emissive surface, as seen from p.
struct AreaSample {
    dvec3 point{0};           ///< world
    dvec3 wi{0};              ///< unit, towards it
    dvec3 radiance{0};        ///< towards p, times the opacity of a masked or blended emitter
    double pdf = 0;           ///< per steradian at p, > 0
    std::uint32_t shape = 0;  ///< of SceneIndex::shapes()
};

/// The emissive triangles and spheres of a scene, drawn in proportion to an estimate of their power. (SH-21)
class AreaLights {
 public:
    explicit AreaLights(const World& world);

    bool empty() const { return sums_.empty(); }
    /// `pick` chooses the light, `u` the point; nothing where it does not shine on p.
    std::optional<AreaSample> sample(const dvec3& p, double pick, const dvec2& u) const;
    /// Density per steradian with which `sample` from p draws the point that `ray` (from p, unit direction) met.
    double pdf(const dvec3& p, const Ray& ray, const Hit& hit) const;

 private:
    std::optional<AreaSample> sample_triangle(std::uint32_t shape, const dvec3& p, const dvec2& u) const;
    std::optional<AreaSample> sample_sphere(std::uint32_t shape, const dvec3& p, const dvec2& u) const;

    const World* world_;
    std::vector<std::uint32_t> shapes_;  ///< of each light
    std::vector<double> sums_;           ///< running sum of the chances, the last is 1
    std::vector<double> chance_;         ///< per shape of the index; 0: never drawn
};

}  // namespace etalon::reference
