#pragma once
#include "engine/image/film.h"
#include "engine/scene/settings.h"

namespace etalon::reference {

/// The pixels of a picture of `size` from one of which each was drawn as `per_side` × `per_side` (AA-2). AOVs are the
/// caller's.
Film reconstruct(const Film& drawn, ivec2 size, int per_side, PixelFilter filter);

}  // namespace etalon::reference
