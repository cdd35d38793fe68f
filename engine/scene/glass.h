#pragma once
#include "engine/scene/scene.h"

namespace etalon {

/// (SH-70) A material that lets all light through that it does not reflect, straight, smooth, and without a volume: a
/// window pane. Such can be looked through by shadow rays without bias.
bool is_smooth_thin_glass(const Material& material);

}  // namespace etalon
