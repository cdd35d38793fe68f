#pragma once
#include "engine/scene/pose.h"

namespace etalon {

/// A camera that turns about a point: what the mouse moves. World frame, metres.
class OrbitCamera {
 public:
    /// Starts at `view` and turns about the point on its axis that is nearest to the middle of the bounds.
    OrbitCamera(const View& view, const dvec3& bounds_min, const dvec3& bounds_max);

    /// Turns by fractions of the picture's height; a whole height is half a turn. Never over the poles.
    void orbit(double dx, double dy);
    /// Moves the scene with the pointer: by fractions of the picture's height, y down.
    void pan(double dx, double dy);
    /// Nearer by `steps` of the wheel; an orthographic view shows less instead.
    void zoom(double steps);
    /// Puts the whole scene into a picture of `aspect`, seen from the same side.
    void frame(double aspect);

    View view(ivec2 size) const;

 private:
    double visible_height() const;  ///< at the target, metres

    Camera camera_;
    dmat3 world_from_camera_{1};
    dvec3 target_{0};
    double distance_ = 1;  ///< from eye to target, > 0
    dvec3 center_{0};
    double radius_ = 1;  ///< of the scene about its centre, > 0
};

}  // namespace etalon
