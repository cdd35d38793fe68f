#pragma once
#include <cstdint>
#include <span>
#include <vector>

#include "engine/math/types.h"

namespace etalon {

/// MikkTSpace tangents of indexed triangles, one for each of `indices`: xyz unit and perpendicular to the corner's
/// normal, w = ±1 such that the bitangent is w · cross(normal, xyz) and points to where v falls (up in a picture whose
/// v = 0 is its top row), as glTF wants it. Two corners of one vertex get different tangents where the uv mapping is
/// mirrored or torn there. Triangles without area or without uv area take what their neighbours have, else some
/// direction along the surface.
///
/// `positions`, `normals` (unit) and `uv` have one entry a vertex; a multiple of three indices, all below that number.
/// Vertices that are equal in all three count as one. Mikkelsen, Simulation of Wrinkled Surfaces Revisited, 2008,
/// §2.2-2.3 and appendix, with the angular threshold of 180 degrees that glTF's convention implies.
std::vector<vec4> compute_tangents(std::span<const vec3> positions, std::span<const vec3> normals,
                                   std::span<const vec2> uv, std::span<const std::uint32_t> indices);

}  // namespace etalon
