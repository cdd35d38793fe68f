#pragma once
#include "engine/math/types.h"

namespace etalon {

/// Translation · rotation · scale, as glTF composes a node. The quaternion need not be unit; 0 is no rotation (G31).
dmat4 compose(const dvec3& translation, const dquat& rotation, const dvec3& scale);

/// What turns normals: the cofactor matrix, det(m) · m⁻ᵀ without dividing, so that flattened axes work too (TF-1, G28).
/// Its result is not unit, and a mirroring m turns it to the other side.
dmat3 cofactor(const dmat3& m);

/// clip_from_camera with reversed, infinite depth and Vulkan's y (TF-4). `yfov`: full vertical angle in radians, in (0,
/// π); `aspect`: width/height > 0; `near` > 0, metres. Throws Error(input) outside (G8).
dmat4 perspective(double yfov, double aspect, double near);

/// clip_from_camera of an orthographic view (TF-5): half extents > 0, reversed depth from `near` (1) to `far` (0), near
/// < far, metres in front of the camera (negative: behind). Throws Error(input) outside.
dmat4 orthographic(double xmag, double ymag, double near, double far);

}  // namespace etalon
