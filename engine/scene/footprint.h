#pragma once
#include <cstdint>
#include <string>

#include "engine/scene/pose.h"
#include "engine/scene/settings.h"

namespace etalon {

/// Bytes of memory that a run will hold at its peak, predicted before they are asked for. The factors were measured as
/// peak resident sizes (docs/limits.md); the prediction is good to about a third.
struct Footprint {
    std::uint64_t program = 0;   ///< libraries, and for a device its driver with its compiler
    std::uint64_t geometry = 0;  ///< as loaded, and what the renderer makes of it
    std::uint64_t textures = 0;
    std::uint64_t picture = 0;  ///< targets, film and output
    std::uint64_t total() const;
};

/// Of a picture alone, when nothing is known of its scene.
Footprint predict(ivec2 size, const RenderSettings& settings);
Footprint predict(const PosedScene& posed, const RenderSettings& settings);

/// Throws Error(machine) with need against have when `footprint` is over `memory` bytes.
void check_memory(const Footprint& footprint, std::uint64_t memory);

/// "program 290.0 MiB, geometry 12.0 MiB, …"
std::string describe(const Footprint& footprint);

/// "1.5 GiB", "12.0 MiB".
std::string describe_bytes(std::uint64_t bytes);

}  // namespace etalon
