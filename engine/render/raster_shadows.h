#pragma once
#include <vector>

#include "engine/gpu/buffer.h"
#include "engine/gpu/image.h"
#include "engine/scene/pose.h"
#include "shaders/shared/raster.h"

namespace etalon {

/// Where the shadow maps of a posed scene look from, and what they hold (SH-43).
class RasterShadows {
 public:
    /// One map: `view` is what it sees, as wide as high.
    struct Map {
        View view;
        bool parallel = false;   ///< of a directional light
        std::uint32_t slot = 0;  ///< of records()
    };

    /// None without lights.
    RasterShadows(gpu::Device& device, const PosedScene& posed);

    const std::vector<Map>& maps() const { return maps_; }
    /// Depth as drawn, of one map at a time.
    gpu::Image& target() { return target_; }
    /// Reversed depth of all maps, one after the other.
    const gpu::Buffer& depths() const { return depths_; }
    std::uint64_t bytes_of_a_map() const { return std::uint64_t{side_} * side_ * sizeof(float); }
    /// Six for each light, relative to an eye.
    std::vector<shared::RasterShadow> records(const dvec3& eye) const;

 private:
    void add(std::size_t slot, const dvec3& eye, const dvec3& direction, const Camera& camera, shared::uint kind);

    std::uint32_t side_ = 0;
    std::vector<Map> maps_;
    std::vector<shared::RasterShadow> records_;  // of each slot, but for where it looks from
    std::vector<dvec3> eyes_;
    gpu::Image target_;
    gpu::Buffer depths_;
};

}  // namespace etalon
