#include "engine/measure/agreement.h"

#include <optional>
#include <vector>

namespace etalon {
namespace {

bool rasterizes(Renderer kind)
{
    return kind == Renderer::raster || kind == Renderer::reference_raster;
}

struct Pair {
    std::size_t a = 0;
    std::size_t b = 0;
};

/// Among the first `count` contenders, in their order.
std::vector<Pair> pairs_to_compare(std::span<const Contender> contenders, std::size_t count)
{
    std::vector<Pair> pairs;
    std::optional<std::size_t> first_raster, first_path;
    for (std::size_t i = 0; i < count; ++i) {
        auto& first = rasterizes(contenders[i].kind) ? first_raster : first_path;
        if (!first) first = i;
    }
    for (std::size_t a = 0; a < count; ++a)
        for (std::size_t b = a + 1; b < count; ++b) {
            const bool family = rasterizes(contenders[a].kind) == rasterizes(contenders[b].kind);
            const bool bridge = first_raster && first_path && std::min(*first_raster, *first_path) == a &&
                                std::max(*first_raster, *first_path) == b;
            if (family || bridge) pairs.push_back({a, b});
        }
    return pairs;
}

Comparison judge(const Contender& a, const Contender& b, const Film& film_a, const Film& film_b,
                 const AgreementSettings& settings)
{
    const bool rasters = a.kind == Renderer::raster && b.kind == Renderer::reference_raster;
    if (rasters && settings.judge_rasters) return settings.judge_rasters(film_a, film_b);
    return compare(film_a, film_b, settings.compare);
}

}  // namespace

Report measure_agreement(Report report, std::span<const Contender> contenders, const AgreementSettings& settings,
                         const Progress& progress)
{
    const std::size_t first = report.runs.size();
    for (const Contender& contender : contenders) {
        if (progress.stopped()) break;
        RendererRun run = contender.render(progress);
        run.name = contender.name;
        run.label = contender.label;
        report.runs.push_back(std::move(run));
    }
    if (settings.probe && !progress.stopped()) {
        const PixelProbe probe = settings.probe(progress);
        for (std::size_t i = first; i < report.runs.size() && probe.truth.samples >= 2; ++i)
            report.runs[i].error = measure_picture(report.runs[i].film, probe, report.develop);
    }
    report.interrupted = progress.stopped();
    for (const auto& [a, b] : pairs_to_compare(contenders, report.runs.size() - first))
        report.comparisons.push_back({.a = first + a,
                                      .b = first + b,
                                      .comparison = judge(contenders[a], contenders[b], report.runs[first + a].film,
                                                          report.runs[first + b].film, settings)});
    return report;
}

}  // namespace etalon
