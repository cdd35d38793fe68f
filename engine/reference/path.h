#pragma once
#include <cstdint>

#include "engine/reference/camera.h"
#include "engine/reference/environment.h"
#include "engine/reference/light.h"
#include "engine/scene/settings.h"

namespace etalon::reference {

/// Uniform numbers of one path: a pure function of pixel, sample and dimension, multiples of 2⁻⁵³ below 1. With sobol,
/// the two of a pair() fill the square evenly over the samples of a pixel (MC-8).
class PathRandom {
 public:
    PathRandom(std::uint32_t pixel, std::uint32_t sample, std::uint64_t seed, Sequence sampler = Sequence::pcg);
    /// Independent parts that a pixel's samples are dealt to in turn (MC-10).
    static std::size_t replicates(Sequence sampler);
    dvec2 pair(std::uint32_t dimension) const;
    /// Where in its pixel the path starts (SH-24).
    dvec2 in_pixel() const;
    /// For the chance that a shape lets segment `segment` pass: another number for every shape, and for a sphere's far
    /// side.
    double of_shape(std::uint32_t segment, const Shape& shape, bool leaving) const;

 private:
    std::uint32_t pixel_, sample_, seed_;
    Sequence sampler_;
};

/// What one path brings.
struct PathResult {
    dvec3 radiance{0};
    double alpha = 0;        ///< 1 where it met the scene, or a background that is not transparent (SH-23)
    bool truncated = false;  ///< the depth limit cut it while it carried light
};

/// Which of its two ways a path takes to find light; every choice has the same mean.
struct PathChoices {
    bool sample_lights =
        true;  ///< next-event estimation, weighted against BSDF sampling (MC-3); false: BSDF sampling alone
};

/// The light transport of docs/shading.md §3 for one scene.
class PathTracer {
 public:
    PathTracer(const PosedScene& posed, const World& world, const RenderSettings& settings, PathChoices choices = {});

    /// (SH-20) One path through film point `film` (pixels).
    PathResult trace(const dvec2& film, const PathRandom& random) const;
    const CameraRays& camera() const { return camera_; }

 private:
    // `medium`: of the body that wo's ray came through, null outside of all (SH-59).
    dvec3 direct(const Surface& surface, const dvec3& wo, const MaterialLayers* medium, const PathRandom& random,
                 std::uint32_t dimension) const;
    dvec3 from_area(const Surface& surface, const dvec3& wo, const MaterialLayers* medium, const PathRandom& random,
                    std::uint32_t dimension) const;
    dvec3 from_punctual(const Surface& surface, const dvec3& wo, const MaterialLayers* medium, double pick) const;
    dvec3 from_environment(const Surface& surface, const dvec3& wo, const MaterialLayers* medium, const dvec2& u) const;
    dvec3 visibility(const Surface& surface, const dvec3& target, std::uint32_t light) const;
    dvec3 visibility(const Ray& ray, std::uint32_t light) const;
    bool is_glass(Index material) const;
    void leave(const Ray& ray, int depth, const dvec3& throughput, double weight, PathResult& result) const;

    const PosedScene* posed_;
    const World* world_;
    CameraRays camera_;
    AreaLights area_;
    EnvironmentSampler environment_;
    PathChoices choices_;
    Background background_;
    dvec3 background_color_;
    int max_depth_;
    bool russian_roulette_;
    bool glass_shadows_;
};

}  // namespace etalon::reference
