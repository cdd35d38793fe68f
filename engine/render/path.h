#pragma once
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "engine/base/progress.h"
#include "engine/gpu/device.h"
#include "engine/image/film.h"
#include "engine/image/film_state.h"
#include "engine/scene/pose.h"
#include "engine/scene/requirements.h"
#include "engine/scene/settings.h"

namespace etalon {

/// What one kind of kernel took, by the device's clock.
struct KernelTime {
    std::string name;
    double milliseconds = 0;
};

/// What a path tracer has measured and read from the device: whole blocks of 256 samples a pixel.
struct PathSamples {
    std::vector<FilmSum> sums;  ///< of each replicate (MC-10); one where samples are independent
    std::uint64_t nonfinite = 0;
    std::uint64_t truncated = 0;

    std::uint64_t samples() const
    {
        std::uint64_t all = 0;
        for (const FilmSum& sum : sums) all += sum.samples();
        return all;
    }
};

/// Which kernels follow the paths; the picture is the same to the bit. By the device and the scene: software devices
/// get whole paths in one kernel, or (large scenes) queues with persistent lanes and a stack in registers; GPUs queues
/// with one ray an invocation and a stack in memory. Tests ask for the queues, or for those of GPUs, everywhere.
enum class Traversal { by_device, queues, exact };

/// Of what its pictures are: of all pixels of a view (or of a shard's rows), or of lists of them.
enum class PixelSet { all, chosen };

/// The path tracer's state on a device: docs/shading.md §3 as a wavefront (docs/architecture.md). The scene is
/// flattened, its BVH built and everything `required` uploaded once; pictures of any view follow. `posed` (with its
/// scene) must outlive it. The same picture to the bit whatever the number of steps, threads or the times it is read in
/// between. With settings.shard the film has the rows of that part alone.
class PathTracer {
 public:
    /// Throws Error(machine) when the device lacks memory, Error(input) when `required` lacks a material's model.
    PathTracer(gpu::Device& device, const PosedScene& posed, const Requirements& required,
               const RenderSettings& settings, const Progress& progress = {},
               Traversal traversal = Traversal::by_device, PixelSet pixels = PixelSet::all);
    PathTracer(PathTracer&&) noexcept;
    PathTracer& operator=(PathTracer&&) noexcept;
    ~PathTracer();

    /// Drops all samples and looks through `view`, whose kind of camera must be that of the posed scene.
    void start(const View& view);
    /// The same with other random numbers than those of the settings.
    void start(const View& view, std::uint64_t seed);
    /// The same of `pixels` of the view alone (y * width + x), where the tracer was made for PixelSet::chosen: a film
    /// of one row, whose pixels are to the bit those of the whole picture.
    void start(const View& view, std::uint64_t seed, std::span<const std::uint32_t> pixels);
    /// Does a bounded piece of the current pass, about 50 ms of device time; a pass is one sample in every pixel, or
    /// more of small pictures, but not beyond `most_samples` in all. True when it completed the pass.
    bool step(std::uint64_t most_samples);
    /// Gives the pass at hand up, where it is not the first. The first one ends where it stands: with as many samples
    /// as all pixels have, or with one where pixels were reached and none in the others. Then film() or start() alone
    /// may follow.
    void stop_pass();
    /// Samples per pixel of completed passes.
    std::uint64_t samples() const;
    /// Of the pass at hand, 0 … 1.
    double pass_fraction() const;
    /// What completed passes measured. AOVs where settings ask for them. Pixels that a stopped first pass did not reach
    /// are 0 with alpha 0; their number is in metadata "pixels.unreached", which is there only then.
    Film film();
    /// What outlives the device, and can go on in another tracer of the same scene, settings and view, to the same
    /// bits.
    PathSamples kept() const;
    void resume(const PathSamples& kept);
    /// The same to the last completed pass, read from the device; `of` is empty. Error(input) when a state is not of a
    /// picture of this size.
    FilmState state() const;
    void resume(const FilmState& state);
    /// Off by default: timing makes each kernel wait for the one before.
    void measure_kernels(bool on);
    /// Sums since construction, while measure_kernels was on.
    const std::vector<KernelTime>& kernel_times() const;

 private:
    friend class PathGather;  // follows paths that begin elsewhere by the same kernels
    struct State;
    std::unique_ptr<State> state_;
};

}  // namespace etalon
