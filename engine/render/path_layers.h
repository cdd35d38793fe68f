#pragma once
#include <cstring>
#include <span>
#include <vector>

#include "engine/scene/scene.h"

namespace etalon {

/// Does `material` have layers that act (docs/shading.md §2b)?
bool layered(const Material& material);

/// Records padded to whole texels.
template <std::size_t texels, class Record>
std::vector<uvec4> padded(const std::vector<Record>& records)
{
    static_assert(sizeof(Record) <= 16 * texels);
    std::vector<uvec4> out(texels * records.size());
    for (std::size_t i = 0; i < records.size(); ++i) std::memcpy(&out[texels * i], &records[i], sizeof(Record));
    return out;
}

/// The materials as kernels read them: MaterialRecords, then LayerRecords, each material with the texel of its own (or
/// of one that changes nothing) in MaterialRecord::layers.
std::vector<uvec4> path_materials(std::span<const Material> scene_materials);

}  // namespace etalon
