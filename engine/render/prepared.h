#pragma once
#include <cstddef>
#include <memory>

#include "engine/base/progress.h"
#include "engine/gpu/device.h"
#include "engine/image/film.h"
#include "engine/scene/pose.h"
#include "engine/scene/settings.h"

namespace etalon {

/// One posed scene as the device has it for several settings at once: geometry, textures, BVH and pipelines are made at
/// the first picture of each and kept for the next ones. Those that were not used for longest go when there are more
/// than `most`. `posed` (with its scene) and the device must outlive it; when the device is lost it is of no more use.
class PreparedScene {
 public:
    PreparedScene(gpu::Device& device, const PosedScene& posed, std::size_t most);
    PreparedScene(PreparedScene&&) noexcept;
    PreparedScene& operator=(PreparedScene&&) noexcept;
    ~PreparedScene();

    /// The picture of render_raster() or render_path(), to the bit. Samples and seed of path tracers may change from
    /// one to the next without anything being made anew.
    Film draw(const RenderSettings& settings, const Progress& progress);
    /// How many are kept.
    std::size_t size() const;

 private:
    struct State;
    std::unique_ptr<State> state_;
};

}  // namespace etalon
