#pragma once
#include <cstdint>
#include <string>
#include <vector>

#include "engine/scene/scene.h"

namespace etalon {

/// What the author of a scene could leave out without changing a picture of it, or hardly one where that is said.
struct Suggestion {
    std::string what;                   ///< "normal map on 3 materials is flat"
    std::vector<std::string> pointers;  ///< each place in the file: "/materials/3/normalTexture"
    std::uint64_t bytes = 0;  ///< of memory that it would spare: texels as RGBA with mip levels, vertices as floats
    std::string code;         ///< of the Khronos validator's rule for it; empty where it has none
};

/// The largest first. Of the whole file, whatever the view. Materials of variants, and those that an animation moves,
/// are not called useless.
std::vector<Suggestion> suggest(const Scene& scene);

}  // namespace etalon
