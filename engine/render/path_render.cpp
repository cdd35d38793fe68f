#include <fmt/format.h>

#include <chrono>
#include <optional>

#include "engine/render/path.h"
#include "engine/render/render.h"

namespace etalon {
namespace {

double seconds_since(std::chrono::steady_clock::time_point start)
{
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

/// Adds samples until there are enough or `progress` stops it.
void trace(PathTracer& tracer, const RenderSettings& settings, const Progress& progress, const Checkpoints& checkpoints)
{
    auto last_kept = std::chrono::steady_clock::now();
    auto last_report = std::chrono::steady_clock::now();
    ProgressUpdate update;
    update.stage = "path tracing";
    // Stopped at once, there would be nothing to show: one step is made.
    const auto has_something = [&] { return tracer.samples() > 0 || tracer.pass_fraction() > 0; };
    while (tracer.samples() < settings.spp && !(progress.stopped() && has_something())) {
        const bool passed = tracer.step(settings.spp);
        const double done = double(tracer.samples()) + tracer.pass_fraction();
        update.fraction = done / double(settings.spp);
        update.samples = tracer.samples();
        // Reading the film costs as much as a step, so the error so far is said about once a second.
        if (passed && seconds_since(last_report) > 1) {
            if (const auto error = estimate_error(tracer.film())) update.error = error->relative;
            last_report = std::chrono::steady_clock::now();
        }
        progress.report(update);
        if (passed && checkpoints.keep && seconds_since(last_kept) > checkpoints.seconds) {
            checkpoints.keep(tracer.state());
            last_kept = std::chrono::steady_clock::now();
        }
    }
    if (tracer.samples() == 0) {
        tracer.stop_pass();
    } else if (checkpoints.keep) {
        checkpoints.keep(tracer.state());
    }
}

}  // namespace

Film render_path(gpu::Device& device, const PosedScene& posed, const Requirements& required,
                 const RenderSettings& settings, const Progress& progress, const Checkpoints& checkpoints,
                 KernelTimes kernels)
{
    check_samples(checkpoints, settings.spp);
    std::optional<PathSamples> kept;
    for (bool renewed = false;; renewed = true) {
        if (renewed) {
            progress.report({.stage = "starting the lost device again"});
            device.renew();
        }
        const auto begin = std::chrono::steady_clock::now();
        std::optional<PathTracer> tracer;
        try {
            tracer.emplace(device, posed, required, settings, progress);
            tracer->measure_kernels(kernels == KernelTimes::measured);
            const double preparing = seconds_since(begin);
            if (checkpoints.from != nullptr) tracer->resume(*checkpoints.from);
            if (kept) tracer->resume(*kept);
            trace(*tracer, settings, progress, checkpoints);
            const double tracing = seconds_since(begin) - preparing;
            Film film = tracer->film();
            film.metadata["milliseconds.scene"] = fmt::format("{:.3f}", 1e3 * preparing);
            film.metadata["milliseconds.path tracing"] = fmt::format("{:.3f}", 1e3 * tracing);
            for (const KernelTime& kernel : tracer->kernel_times())
                film.metadata["milliseconds.kernel " + kernel.name] = fmt::format("{:.3f}", kernel.milliseconds);
            return film;
        } catch (const gpu::DeviceLost&) {
            if (renewed) throw;
            if (tracer) kept = tracer->kept();
        }
    }
}

}  // namespace etalon
