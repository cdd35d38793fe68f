#pragma once
#include "engine/gpu/bindings.h"
#include "engine/gpu/commands.h"
#include "engine/render/raster_targets.h"

namespace etalon {

/// The picture that transmitting surfaces show, with its levels: each the area average of the one above (SH-65).
class RasterBehind {
 public:
    explicit RasterBehind(gpu::Device& device);

    /// For targets of another size; they must stay where they are while this records.
    void bind(const RasterTargets& targets);
    /// From `targets.resolved`, as drawn so far, to `targets.levels`, in use `sampled` afterwards.
    void record(gpu::Commands& commands, RasterTargets& targets) const;

 private:
    gpu::Device& device_;
    gpu::ComputePipeline shrink_;
    gpu::Bindings bindings_;
};

}  // namespace etalon
