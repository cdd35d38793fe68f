#pragma once
#include "engine/gpu/bindings.h"
#include "engine/gpu/commands.h"
#include "engine/render/raster_targets.h"
#include "engine/scene/settings.h"

namespace etalon {

/// Makes pixels of drawn ones (AA-2): along rows, then along columns.
class RasterFilter {
 public:
    /// False where every pixel is one drawn pixel.
    static bool is_needed(const RenderSettings& settings);

    RasterFilter(gpu::Device& device, const RenderSettings& settings);

    /// For targets of another size; they must stay where they are while this records.
    void bind(const RasterTargets& targets);
    /// From `targets.resolved` to `targets.filtered`, in use `storage` afterwards.
    void record(gpu::Commands& commands, RasterTargets& targets) const;

 private:
    gpu::Device& device_;
    std::uint32_t per_side_;
    int first_ = 0;  // of the drawn pixels that a pixel weighs, relative to its own first
    std::uint32_t taps_ = 0;
    gpu::ComputePipeline pipeline_;
    gpu::Buffer weights_;
    gpu::Bindings rows_, columns_;
};

}  // namespace etalon
