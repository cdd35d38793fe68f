#pragma once
#include "engine/image/film.h"
#include "engine/reference/camera.h"
#include "engine/reference/surface.h"

namespace etalon::reference {

/// docs/shading.md §6 for every pixel. `cull_all`: whose backs are passed, as in `opacity`. Row by row on `threads`
/// threads.
Aovs render_aovs(const World& world, const CameraRays& camera, bool cull_all, unsigned threads);

}  // namespace etalon::reference
