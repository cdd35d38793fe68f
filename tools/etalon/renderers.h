#pragma once
#include <optional>
#include <string>

#include "engine/base/progress.h"
#include "engine/gpu/device.h"
#include "engine/image/film.h"
#include "engine/image/film_state.h"
#include "engine/measure/rasters.h"
#include "engine/measure/report.h"
#include "engine/scene/pose.h"
#include "engine/scene/settings.h"
#include "tools/etalon/arguments.h"

namespace etalon::cli {

/// A film and how long its making took, stage by stage where the renderer says so.
struct Drawn {
    Film film;
    std::vector<StageTime> stages;
};

/// The renderers behind one call, and the device that two of them need: made at first use, kept for all later scenes.
class Renderers {
 public:
    explicit Renderers(const Arguments& arguments);

    /// `checkpoints` are for the path tracers. Film::metadata gets scene, renderer, settings, seed, version and device;
    /// times leave it, so that the same settings give the same file.
    Drawn draw(const std::string& scene_name, const PosedScene& posed, const RenderSettings& settings,
               const Progress& progress, const Checkpoints& checkpoints = {});

    /// "CPU, double precision" for the references, else what Vulkan device it is.
    std::string device_of(Renderer renderer);

    /// Of the Vulkan device.
    RasterPrecision raster_precision();

    /// With --validate: throws Error(machine) quoting what the validation layers said, if anything.
    void check_validation() const;

 private:
    gpu::Device& device();

    gpu::DeviceOptions options_;
    std::uint64_t memory_;  ///< bytes that may be needed in all
    std::optional<gpu::Device> device_;
};

/// "1.23% (95% interval 1.10% to 1.36%)"; "not measured" of a rasterized film; of a path-traced one with a single
/// sample a pixel, that this is the reason.
std::string describe_error(const Film& film, Renderer renderer);

}  // namespace etalon::cli
