#pragma once
#include <optional>
#include <string>
#include <thread>

#include "engine/base/progress.h"
#include "engine/gpu/device.h"
#include "engine/image/adaptive.h"
#include "engine/image/film.h"
#include "engine/image/film_state.h"
#include "engine/image/post.h"
#include "engine/measure/rasters.h"
#include "engine/measure/report.h"
#include "engine/render/prepared.h"
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

    /// draw() for the rasterizer and the path tracer on the device, where scene and pipelines stay for the next picture
    /// of `posed`, which must be the same one until forget_device() and outlive that.
    Film draw_again(const std::string& scene_name, const PosedScene& posed, const RenderSettings& settings,
                    const Progress& progress);

    /// The film after post passes, on the device where that drew it, else in double; adds to `stages`.
    Film post(Film film, const PostChain& chain, Renderer renderer, std::vector<StageTime>& stages);

    /// "CPU, double precision" for the references, else what device it is.
    std::string device_of(Renderer renderer);

    /// Of the device.
    RasterPrecision raster_precision();

    /// With --validate: throws Error(machine) quoting what the validation layers said, if anything.
    void check_validation() const;

    /// After a failure of the machine: the next picture starts the device anew.
    void forget_device()
    {
        prepared_.reset();
        device_.reset();
    }

 private:
    gpu::Device& device(Renderer renderer = Renderer::path);

    gpu::DeviceOptions options_;
    bool may_fall_back_;    ///< to OpenGL, for the rasterizer
    std::uint64_t memory_;  ///< bytes that may be needed in all
    bool profile_;          ///< the path tracer's kernels are timed
    std::optional<AdaptiveGoal> adaptive_;  ///< of --adaptive
    std::optional<gpu::Device> device_;
    std::optional<PreparedScene> prepared_;
    std::jthread pictures_ahead_;  ///< what writes them is loaded while the first is drawn
};

/// "1.23% (95% interval 1.10% to 1.36%)"; "not measured" of a rasterized film; of a path-traced one with a single
/// sample a pixel, or of a post-processed one, that this is the reason.
std::string describe_error(const Film& film, Renderer renderer);

}  // namespace etalon::cli
