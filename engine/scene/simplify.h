#pragma once
#include <optional>
#include <string>
#include <vector>

#include "engine/scene/pose.h"

namespace etalon {

/// Something of a material that no picture shows.
struct Removal {
    std::string pointer;  ///< where in the file: "/materials/3/emissiveTexture"
    std::string what;     ///< why it is not needed: "every texel read is 1"
};

/// pose() with everything that the file has, also what no picture shows: to hold one against the other.
PosedScene pose_whole(const Scene& scene, const PoseSettings& settings = {});

/// Takes from the materials of a posed scene what changes no bit of any picture, for pose(): a texture that is 0 or 1
/// in every texel of each channel that is read becomes its factor, so does one whose factors are 0, and of textures
/// that are alike one stays. Other constants are left alone: devices round a texel times a factor in their own ways.
std::vector<Removal> simplify(PosedScene& posed);

/// The code (0 … 1 of 8 bits) that a channel has in every texel; nothing where texels differ or there are none.
std::optional<double> constant_channel(const Texels& image, int channel);

/// What a device may hold instead of an image whose texels are all alike: the same, halved as long as both sides are
/// even, so that footprints keep their shape. Nothing where texels differ.
std::optional<Texels> shrunk_constant(const Texels& image);

/// For each image the first one of the same size and texels, itself where it is that one.
std::vector<Index> equal_images(const std::vector<Texels>& images);
/// Textures of equal images read the first of them.
void share_equal_images(Scene& scene);

}  // namespace etalon
