#include <algorithm>
#include <atomic>
#include <chrono>

#include "engine/base/error.h"
#include "engine/base/parallel.h"
#include "engine/image/shard.h"
#include "engine/reference/aov.h"
#include "engine/reference/path.h"
#include "engine/reference/pixel_sums.h"
#include "engine/reference/reference.h"

namespace etalon::reference {
namespace {

constexpr std::size_t kTile = 16;        // pixels a side: one unit of work of a thread
constexpr double kSecondsPerPass = 0.5;  // how long a stop may have to wait for whole passes, roughly
constexpr std::uint64_t kMaxSamples = 0xffffffffu;

/// Adds samples first … first + count - 1 of a pixel to the sums of its replicates. How many of their paths the depth
/// limit cut.
std::uint64_t add_samples(std::span<PixelSum> sums, const PathTracer& tracer, std::size_t pixel, std::size_t width,
                          const RenderSettings& settings, std::uint64_t first, std::uint64_t count)
{
    std::uint64_t truncated = 0;
    for (std::uint64_t s = first; s < first + count; ++s) {
        const PathRandom random(static_cast<std::uint32_t>(pixel), static_cast<std::uint32_t>(s), settings.seed,
                                settings.sampler);
        const dvec2 film =
            dvec2(static_cast<double>(pixel % width), static_cast<double>(pixel / width)) + random.in_pixel();
        const PathResult path = tracer.trace(film, random);
        sums[s % sums.size()].add(path.radiance, path.alpha);
        truncated += path.truncated ? 1 : 0;
    }
    return truncated;
}

void check_samples(std::uint64_t spp)
{
    if (spp < 1 || spp > kMaxSamples)
        throw Error(Blame::input, "samples per pixel must be 1 … 4294967295, not " + std::to_string(spp));
}

double seconds_since(std::chrono::steady_clock::time_point start)
{
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

/// The samples of a picture so far. A pass gives every pixel the same number more, or, stopped, leaves all as it was.
class Accumulation {
 public:
    /// Of rows first_row … end_row - 1.
    Accumulation(const PathTracer& tracer, int width, int first_row, int end_row, const RenderSettings& settings)
        : tracer_(&tracer),
          width_(static_cast<std::size_t>(width)),
          first_row_(static_cast<std::size_t>(first_row)),
          height_(static_cast<std::size_t>(end_row - first_row)),
          settings_(&settings),
          replicates_(PathRandom::replicates(settings.sampler)),
          sums_(width_ * height_ * replicates_),
          next_(sums_)
    {}

    /// True if the pass was completed.
    bool pass(std::uint64_t count, const Progress& progress, bool may_stop)
    {
        const std::size_t across = (width_ + kTile - 1) / kTile, down = (height_ + kTile - 1) / kTile;
        std::vector<std::uint64_t> truncated(across * down, 0);
        std::atomic<bool> stopped = false;
        parallel_for(
            across * down,
            [&](std::size_t tile) {
                if (may_stop && progress.stopped()) stopped = true;
                if (!stopped) truncated[tile] = render_tile(tile % across, tile / across, count);
            },
            settings_->threads);
        if (stopped) return false;
        std::swap(sums_, next_);
        samples_ += count;
        for (const std::uint64_t t : truncated) truncated_ += t;
        return true;
    }

    FilmState state() const
    {
        FilmState out = state_of(sums_, static_cast<int>(width_), static_cast<int>(height_), samples_);
        out.truncated = truncated_;
        return out;
    }
    void resume(const FilmState& state)
    {
        restore(sums_, state);
        samples_ = state.samples;
        truncated_ = state.truncated;
    }
    double error() const { return relative_error(sums_, width_ * height_); }
    Film film() const
    {
        Film out = film_of(sums_, static_cast<int>(width_), static_cast<int>(height_), samples_);
        out.truncated = truncated_;
        return out;
    }
    std::uint64_t samples() const { return samples_; }

 private:
    std::uint64_t render_tile(std::size_t tile_x, std::size_t tile_y, std::uint64_t count)
    {
        std::uint64_t truncated = 0;
        for (std::size_t y = tile_y * kTile; y < std::min(height_, (tile_y + 1) * kTile); ++y)
            for (std::size_t x = tile_x * kTile; x < std::min(width_, (tile_x + 1) * kTile); ++x) {
                const std::size_t pixel = y * width_ + x;
                const std::span<PixelSum> sums = std::span(next_).subspan(pixel * replicates_, replicates_);
                std::copy_n(sums_.begin() + std::ptrdiff_t(pixel * replicates_), replicates_, sums.begin());
                truncated +=
                    add_samples(sums, *tracer_, first_row_ * width_ + pixel, width_, *settings_, samples_, count);
            }
        return truncated;
    }

    const PathTracer* tracer_;
    std::size_t width_, first_row_, height_;
    const RenderSettings* settings_;
    std::size_t replicates_;
    std::vector<PixelSum> sums_, next_;  // of a pixel's replicates, one after another
    std::uint64_t samples_ = 0;
    std::uint64_t truncated_ = 0;
};

}  // namespace

Film render_path(const PosedScene& posed, const Requirements& required, const RenderSettings& settings,
                 const Progress& progress, const Checkpoints& checkpoints)
{
    assume(posed.scene != nullptr && posed.view.width > 0 && posed.view.height > 0);
    check_samples(settings.spp);
    check_samples(checkpoints, settings.spp);
    const int first_row = settings.shard.first_row(posed.view.height);
    const int end_row = settings.shard.end_row(posed.view.height);
    if (first_row == end_row)
        throw Error(Blame::input, "a part of a picture has no rows", "make no more parts than the picture has rows");
    progress.report({.stage = "building the BVH", .fraction = 0, .error = {}, .samples = {}});
    const World world(posed, required.texture_used, false);
    const PathTracer tracer(posed, world, settings);
    Accumulation picture(tracer, posed.view.width, first_row, end_row, settings);
    if (checkpoints.from != nullptr) picture.resume(*checkpoints.from);

    // How many samples a pass has never changes a bit: each is a function of its number alone, and they are added in
    // order.
    std::uint64_t count = 1;
    auto last_kept = std::chrono::steady_clock::now();
    while (picture.samples() < settings.spp && !(picture.samples() > 0 && progress.stopped())) {
        const auto begin = std::chrono::steady_clock::now();
        const bool may_stop = picture.samples() > 0;  // a picture of no sample would be none
        if (!picture.pass(std::min(count, settings.spp - picture.samples()), progress, may_stop)) break;
        if (seconds_since(begin) < kSecondsPerPass / 2) count *= 2;
        progress.report({.stage = "path tracing",
                         .fraction = static_cast<double>(picture.samples()) / static_cast<double>(settings.spp),
                         .error = picture.samples() < 2 ? std::nullopt : std::optional(picture.error()),
                         .samples = picture.samples()});
        if (checkpoints.keep && seconds_since(last_kept) > checkpoints.seconds) {
            checkpoints.keep(picture.state());
            last_kept = std::chrono::steady_clock::now();
        }
    }
    if (checkpoints.keep) checkpoints.keep(picture.state());
    Film film = picture.film();
    if (settings.aovs)
        film.aovs =
            rows_of(render_aovs(world, tracer.camera(), false, settings.threads), first_row, end_row, posed.view.width);
    return film;
}

Film render_pixels(const PosedScene& posed, const Requirements& required, const RenderSettings& settings,
                   std::span<const std::uint32_t> pixels, const Progress& progress)
{
    assume(posed.scene != nullptr && posed.view.width > 0 && posed.view.height > 0);
    check_samples(settings.spp);
    const auto width = static_cast<std::size_t>(posed.view.width);
    for (const std::uint32_t pixel : pixels) assume(pixel < width * static_cast<std::size_t>(posed.view.height));
    progress.report({.stage = "building the BVH", .fraction = 0, .error = {}, .samples = {}});
    const World world(posed, required.texture_used, false);
    const PathTracer tracer(posed, world, settings);

    constexpr std::size_t kChunk = 64;
    const std::size_t chunks = (pixels.size() + kChunk - 1) / kChunk;
    const std::size_t replicates = PathRandom::replicates(settings.sampler);
    std::vector<PixelSum> sums(pixels.size() * replicates);
    std::vector<std::uint64_t> truncated(chunks, 0);
    std::uint64_t done = 0;
    for (std::uint64_t count = 1; done < settings.spp && !(done > 0 && progress.stopped());) {
        count = std::min(count, settings.spp - done);
        const auto begin = std::chrono::steady_clock::now();
        parallel_for(
            chunks,
            [&](std::size_t chunk) {
                for (std::size_t k = chunk * kChunk; k < std::min(pixels.size(), (chunk + 1) * kChunk); ++k)
                    truncated[chunk] += add_samples(std::span(sums).subspan(k * replicates, replicates), tracer,
                                                    pixels[k], width, settings, done, count);
            },
            settings.threads);
        done += count;
        if (std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count() < kSecondsPerPass / 2)
            count *= 2;
        progress.report({.stage = "path tracing single pixels",
                         .fraction = static_cast<double>(done) / static_cast<double>(settings.spp),
                         .error = {},
                         .samples = done});
    }
    Film film = film_of(sums, static_cast<int>(pixels.size()), 1, done);
    for (const std::uint64_t t : truncated) film.truncated += t;
    return film;
}

}  // namespace etalon::reference
