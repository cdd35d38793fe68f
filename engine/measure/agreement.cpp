#include "engine/measure/agreement.h"

namespace etalon {

Report measure_agreement(Report report, std::span<const Contender> contenders, const CompareSettings& settings,
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
    report.interrupted = progress.stopped();
    for (std::size_t a = first; a < report.runs.size(); ++a)
        for (std::size_t b = a + 1; b < report.runs.size(); ++b)
            report.comparisons.push_back(
                {.a = a, .b = b, .comparison = compare(report.runs[a].film, report.runs[b].film, settings)});
    return report;
}

}  // namespace etalon
