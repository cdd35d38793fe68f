#pragma once
// Private to engine/render: what a PathTracer consists of. path.cpp makes samples, path_film.cpp reads them.
#include <algorithm>
#include <optional>
#include <vector>

#include "engine/render/path.h"
#include "engine/render/path_kernels.h"

namespace etalon {

/// Paths in flight at once: more hide the cost of a dispatch (some 20 µs on software devices), fewer stay in its
/// caches.
inline constexpr std::uint32_t kWaveCapacity = 1u << 17;
/// Samples of all pixels that a pass holds at most, of which the film is told at once (8 MiB of them).
inline constexpr std::uint32_t kPassSlots = 1u << 19;
/// Of a kernel with a thread for each of `count`.
inline std::uint32_t groups_for(std::uint32_t count)
{
    return (count + shared::kPathWorkgroup - 1) / shared::kPathWorkgroup;
}

/// Of a picture's first wave, before the scene's speed is known: a stop must not wait for long even where it is slow.
inline constexpr std::uint32_t kFirstWave = 1u << 14;
/// Samples a pixel that are summed in float before they are merged in double (M1); counts of a block fit 16 bits.
inline constexpr std::uint32_t kBlockSamples = 256;

struct PathTracer::State {
    gpu::Device* device;
    bool wants_aovs;
    Shard shard;
    PathScene scene;
    PathKernels kernels;
    PathQueues queues;
    gpu::Buffer frame;
    gpu::Buffer aovs;
    std::vector<PathBand> bands;
    std::uint32_t width = 0, height = 0;  ///< pixels of the film
    std::uint32_t first_row = 0;          ///< of the film in the picture
    std::uint32_t wave = kFirstWave;      ///< paths of the next wave, adapted to the scene's speed

    PathSamples total;                 ///< of completed blocks
    std::uint64_t first_of_block = 0;  ///< sample number
    std::uint32_t in_block = 0;        ///< samples of completed passes of this block

    std::uint32_t in_pass = 0;  ///< samples a pixel of the pass at hand; 0: none
    std::size_t band = 0;       ///< where the pass at hand stands
    std::uint32_t next_slot = 0;
    std::uint64_t slots_done = 0;

    std::vector<bool> unreached;  ///< pixels without samples, after a stop in the first pass; else empty

    bool timing = false;
    std::vector<KernelTime> times;

    State(gpu::Device& device, const PosedScene& posed, const Requirements& required, const RenderSettings& settings,
          const Progress& progress, Traversal traversal, PixelSet pixels);
    void resize(const View& view);
    void choose(std::span<const std::uint32_t> pixels);
    void look_through(const View& view);
    void begin_pass(std::uint64_t most_samples);
    std::uint32_t run_fused(PathBand& at, const shared::PathPush& push);
    void run_wave(PathBand& at, std::uint32_t count);
    void end_pass();
    void mark_unreached();
    void trace_from_camera(gpu::Commands& commands, PathBand& at, PathKernel& generate, const shared::PathPush& push);
    void trace_centres(gpu::Commands& commands, PathBand& at, const shared::PathPush& push);
    void bounce(gpu::Commands& commands, PathBand& at, shared::PathPush push);
    const gpu::Bindings& bindings(PathBand& at, PathKernel& kernel, std::size_t from);
    void launch(gpu::Commands& commands, PathBand& at, PathKernel& kernel, const shared::PathPush& push,
                std::uint32_t groups);
    void launch_indirect(gpu::Commands& commands, PathBand& at, PathKernel& kernel, const shared::PathPush& push,
                         std::uint32_t row);
    void trace(gpu::Commands& commands, PathBand& at, PathKernel& kernel, PathKernel& retry,
               const shared::PathPush& push, std::uint32_t retry_row, std::optional<std::uint32_t> row);
    void trace_shadows(gpu::Commands& commands, PathBand& at, const shared::PathPush& push);
    void finish(gpu::Commands& commands);
    PathSamples nothing() const;
    void read_block(PathSamples& samples) const;
    /// In either of its two buffers of the film.
    std::size_t floats_of(const PathBand& at) const
    {
        return 4 * std::size_t{at.pixel_count} * scene.features.replicates();
    }
    void read_aovs(Film& film);
    FilmState save() const;
    void restore(const FilmState& state);
    std::uint32_t trace_groups(std::uint32_t rays) const
    {
        const std::uint32_t each = shared::kPathWorkgroup * kernels.rays_per_lane;
        return (rays + each - 1) / each;
    }
};

}  // namespace etalon
