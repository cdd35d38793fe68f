#pragma once
#include <cstdint>
#include <vector>

#include "engine/scene/scene.h"

namespace etalon {

/// glTF's primitive modes, by its numbers.
enum class DrawMode { points, lines, line_loop, line_strip, triangles, triangle_strip, triangle_fan };

Topology topology_of(DrawMode mode);

/// Strips, fans and loops as a plain list of points, lines or triangles (glTF 2.0 §3.7.2.1); what is left over at the
/// end of a list is dropped. A strip's triangles all keep the winding of the first.
std::vector<std::uint32_t> unrolled(DrawMode mode, std::vector<std::uint32_t> indices);

/// Removes triangles whose area is exactly zero: they cover nothing, and have no normal.
void drop_triangles_without_area(Primitive& primitive);

/// Unit normals: given ones are normalized (a zero one becomes that of a face at it); where there are none, each
/// triangle gets its own three vertices with the geometric normal. Points and lines without normals keep none.
void finish_normals(Primitive& primitive);

/// MikkTSpace tangents from uv set `uv_set`; vertices are split where tangents of one vertex differ.
void add_tangents(Primitive& primitive, int uv_set);

}  // namespace etalon
