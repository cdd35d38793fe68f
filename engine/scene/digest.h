#pragma once
#include "engine/base/digest.h"
#include "engine/scene/pose.h"

namespace etalon {

/// A fingerprint of all that a renderer reads of a posed scene: geometry, materials, textures, lights, environment and
/// view. Names, notes and what is not in the picture (other cameras, animations, unused variants) do not count.
Digest digest(const PosedScene& posed);
/// Of all that decides how a material looks: not its name.
Digest digest(const Material& material);

}  // namespace etalon
