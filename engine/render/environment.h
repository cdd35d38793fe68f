#pragma once
#include "engine/image/image.h"

namespace etalon {

/// What a rasterizer looks up instead of integrating an environment map: (SH-33…35), in the map's own frame, that is
/// before its rotation and scale, so that turning and dimming it costs nothing.
struct EnvironmentTables {
    /// The six tables P of (SH-35) in one RGBA picture (alpha 1): table 0 at the top left, table k = 1 … 5 in the
    /// kTableWidth × kTableHeight texels from row mirror_height + (k − 1) kTableHeight; after them E/π of (SH-33).
    Image atlas;
    int mirror_width = 0;   ///< of table 0: at most 512
    int mirror_height = 0;  ///< at most 256

    static constexpr int kTableWidth = 64;
    static constexpr int kTableHeight = 32;
    static constexpr int kRoughTables = 5;
};

/// Of an equirectangular map of linear radiance with 3 or 4 channels (docs/shading.md §5). On up to `threads` threads
/// (0: one per core), with the same bits whatever their number.
EnvironmentTables tabulate(const Image& map, unsigned threads = 0);

}  // namespace etalon
