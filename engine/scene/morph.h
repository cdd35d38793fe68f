#pragma once
#include <span>

#include "engine/scene/scene.h"

namespace etalon {

/// The base shape plus each target times its weight (glTF 2.0 §3.7.2.2), summed in double; weights left out are 0. With
/// no weight but 0 it is the base, bit for bit (promise P8). Normals are not unit; finish_deformed() makes them so.
/// Error(input) when a vertex gets beyond every float.
Primitive morphed(const Primitive& base, std::span<const double> weights);

/// What follows from positions that moved: unit normals (those of the flat faces where the file has none) and tangents,
/// computed anew where the file has none and `reshaped` (by morph targets, or by any means where faces are flat). Drops
/// targets and influences: what is left does not move.
void finish_deformed(Primitive& primitive, bool reshaped);

}  // namespace etalon
