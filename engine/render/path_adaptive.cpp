#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <functional>
#include <numeric>

#include "engine/base/error.h"
#include "engine/render/path.h"
#include "engine/render/render.h"

namespace etalon {
namespace {

constexpr std::uint64_t kPilotSamples = 16;
constexpr std::uint64_t kPilotSeed = 0xc2b2ae3d27d4eb4fu;

using Clock = std::chrono::steady_clock;

double milliseconds_since(Clock::time_point start)
{
    return std::chrono::duration<double, std::milli>(Clock::now() - start).count();
}

/// All pixels of a picture, in columns of 8 rows as the whole one is traced (shaders/path/start.glsl): neighbours in
/// the list are neighbours in the picture.
std::vector<std::uint32_t> in_strips(std::uint32_t width, std::uint32_t height)
{
    std::vector<std::uint32_t> out;
    for (std::uint32_t top = 0; top < height; top += 8)
        for (std::uint32_t x = 0; x < width; ++x)
            for (std::uint32_t y = top; y < std::min(top + 8, height); ++y) out.push_back(y * width + x);
    return out;
}

template <typename T>
void scatter(std::vector<T>& to, const std::vector<T>& from, std::span<const std::uint32_t> pixels, std::size_t count)
{
    if (from.empty()) return;
    to.resize(count);
    for (std::size_t k = 0; k < pixels.size(); ++k) to[pixels[k]] = from[k];
}

/// Puts a film of all pixels, in the order of a list, where they belong.
void place(Film& film, const Film& part, std::span<const std::uint32_t> pixels)
{
    const std::size_t count = film.pixel_count();
    scatter(film.mean, part.mean, pixels, count);
    scatter(film.variance, part.variance, pixels, count);
    scatter(film.alpha, part.alpha, pixels, count);
    scatter(film.aovs.depth, part.aovs.depth, pixels, count);
    scatter(film.aovs.normal, part.aovs.normal, pixels, count);
    scatter(film.aovs.albedo, part.aovs.albedo, pixels, count);
    scatter(film.aovs.emission, part.aovs.emission, pixels, count);
    scatter(film.aovs.object_id, part.aovs.object_id, pixels, count);
    scatter(film.aovs.material_id, part.aovs.material_id, pixels, count);
    scatter(film.aovs.uv, part.aovs.uv, pixels, count);
}

/// One list of pixels to `samples`, or as far as `progress` lets it.
void trace(PathTracer& tracer, const View& view, std::uint64_t seed, const SampleGroup& group, const Progress& progress,
           const std::function<void(double)>& report)
{
    tracer.start(view, seed, group.pixels);
    while (tracer.samples() < group.samples && !progress.stopped()) {
        tracer.step(group.samples);
        report(double(tracer.samples()) + tracer.pass_fraction());
    }
}

}  // namespace

Film render_path_adaptively(gpu::Device& device, const PosedScene& posed, const Requirements& required,
                            const RenderSettings& settings, AdaptiveGoal goal, const Progress& progress)
{
    if (!settings.shard.whole())
        throw Error(Blame::input, "adaptive samples are dealt out over a whole picture, not over a shard",
                    "leave out one of the two");
    const auto begin = Clock::now();
    const View& view = posed.view;
    PathTracer tracer(device, posed, required, settings, progress, Traversal::by_device, PixelSet::chosen);
    const double preparing = milliseconds_since(begin);

    Film film;
    film.width = view.width;
    film.height = view.height;
    const std::uint64_t spp = std::max<std::uint64_t>(settings.spp, 2);
    const SampleGroup all{.samples = std::max<std::uint64_t>(std::min(kPilotSamples, spp / 4 * 2), 2),
                          .pixels = in_strips(std::uint32_t(view.width), std::uint32_t(view.height))};
    // Two samples a pixel in any case: without them there would be nothing to show.
    tracer.start(view, settings.seed ^ kPilotSeed, all.pixels);
    while (tracer.samples() < all.samples && !(tracer.samples() >= 2 && progress.stopped())) tracer.step(all.samples);
    const Film pilot = tracer.film();
    film.samples = pilot.samples;
    film.replicates = pilot.replicates;
    film.nonfinite = pilot.nonfinite;
    film.truncated = pilot.truncated;
    place(film, pilot, all.pixels);
    const std::vector<SampleGroup> groups = plan_samples(film, spp, goal);
    film.counts.assign(film.pixel_count(), static_cast<std::uint32_t>(pilot.samples));

    double work = 1, done = 0;
    for (const SampleGroup& group : groups) work += double(group.samples) * double(group.pixels.size());
    for (const SampleGroup& group : groups) {
        if (group.samples == 0 || progress.stopped()) break;
        const auto each = double(group.pixels.size());
        trace(tracer, view, settings.seed, group, progress, [&](double now) {
            progress.report(
                {.stage = "path tracing", .fraction = (done + now * each) / work, .error = {}, .samples = {}});
        });
        done += double(group.samples) * each;
        if (tracer.samples() >= 2) add_samples(film, tracer.film(), group.pixels);
    }
    const double samples = std::accumulate(film.counts.begin(), film.counts.end(), 0.0);
    film.samples = static_cast<std::uint64_t>(std::llround(samples / double(film.pixel_count())));
    film.metadata["adaptive"] = fmt::format(
        "goal={} pilot={} groups={}", goal == AdaptiveGoal::error ? "error" : "relmse", pilot.samples, groups.size());
    film.metadata["milliseconds.scene"] = fmt::format("{:.3f}", preparing);
    film.metadata["milliseconds.path tracing"] = fmt::format("{:.3f}", milliseconds_since(begin) - preparing);
    return film;
}

}  // namespace etalon
