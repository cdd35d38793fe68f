#pragma once
#include "engine/math/types.h"

namespace etalon {

/// Translation · rotation · scale, as glTF composes a node. The quaternion need not be unit; 0 is no rotation (G31).
dmat4 compose(const dvec3& translation, const dquat& rotation, const dvec3& scale);

/// What turns normals: the cofactor matrix, det(m) · m⁻ᵀ without dividing, so that flattened axes work too (TF-1, G28).
/// Its result is not unit, and a mirroring m turns it to the other side.
dmat3 cofactor(const dmat3& m);

/// world_from_camera of a camera at `eye` that sees `target` with `up` upwards on its picture; it looks down its −Z.
/// Where `up` is within 10⁻³ rad of the view or no direction, the world axis that lies least along the view replaces it
/// (G29); where target and eye are one point it looks down the world's −Z. Orthonormal always.
dmat4 look_at(const dvec3& eye, const dvec3& target, const dvec3& up = dvec3(0, 1, 0));

/// clip_from_camera with reversed, infinite depth and Vulkan's y (TF-4). `yfov`: full vertical angle in radians, in (0,
/// π); `aspect`: width/height > 0; `near` > 0, metres. Throws Error(input) outside (G8).
dmat4 perspective(double yfov, double aspect, double near);

/// clip_from_camera of an orthographic view (TF-5): half extents > 0, reversed depth from `near` (1) to `far` (0), near
/// < far, metres in front of the camera (negative: behind). Throws Error(input) outside.
dmat4 orthographic(double xmag, double ymag, double near, double far);

}  // namespace etalon
