#pragma once
#include <optional>

#include "engine/reference/intersect.h"
#include "engine/scene/pose.h"

namespace etalon::reference {

/// World-space camera rays of a view, unit directions, t in metres from the lens (docs of View).
class CameraRays {
 public:
    explicit CameraRays(const View& view);

    /// Through film point `film` in pixels (x right, y down from the top left corner), by the middle of the lens.
    Ray pinhole(const dvec2& film) const;
    /// Through point `lens` of a thin lens, in its radii: rays of one film point meet on the plane of focus.
    Ray through_lens(const dvec2& film, const dvec2& lens) const;
    /// The film position, pixels, at which a world point is seen by the middle of the lens; nothing where it is not in
    /// front.
    std::optional<dvec2> film_of(const dvec3& p) const;
    /// A point of the aperture, uniform: of the unit disk, or of the polygon that the blades make in it (TF-8).
    dvec2 sample_aperture(const dvec2& u) const;
    bool has_lens() const { return lens_.aperture_radius > 0; }

    /// Distance of `p` along the viewing axis, metres, > 0 in front; from the eye where all directions are seen.
    double depth(const dvec3& p) const { return equirectangular_ ? length(p - eye_) : dot(axis_, p - eye_); }

 private:
    Ray in_world(const dvec3& origin, const dvec3& direction) const;

    dmat4 world_from_camera_;
    dvec2 size_;
    dvec2 slope_;   ///< perspective: x, y of the direction at the film's right and top edge, z = -1
    dvec2 extent_;  ///< orthographic: half extents
    bool orthographic_, equirectangular_;
    ThinLens lens_;
    dvec3 eye_, axis_;
};

/// Uniform in the unit disk, without the seams that a square mapping has (Shirley & Chiu 1997).
dvec2 sample_disk(const dvec2& u);

}  // namespace etalon::reference
