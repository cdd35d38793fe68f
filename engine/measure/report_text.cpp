#include <fmt/format.h>

#include <algorithm>
#include <vector>

#include "engine/measure/diff.h"
#include "engine/measure/picture_error.h"
#include "engine/measure/report.h"
#include "engine/measure/text.h"

namespace etalon {
namespace {

using Row = TableRow;

std::string shortened(const std::string& text, std::size_t limit)
{
    if (columns(text) <= limit) return text;
    std::string out;
    std::size_t count = 0;
    for (const char c : text) {
        if ((static_cast<unsigned char>(c) & 0xc0) != 0x80 && ++count >= limit) break;
        out += c;
    }
    return out + "…";
}

double total_seconds(const RendererRun& run)
{
    double total = 0;
    for (const StageTime& stage : run.stages) total += stage.seconds;
    return total;
}

Row metric_cells(const PictureMetrics& m)
{
    return {percent(m.mean_relative), fmt::format("{:.3g}", m.relmse),
            m.psnr ? fmt::format("{:.1f} dB", *m.psnr) : "identical", fmt::format("{:.4f}", m.ssim),
            fmt::format("{:.4f}", m.flip)};
}

std::string errors_table(const Report& report)
{
    std::vector<Row> rows{{"picture", "error (95% interval)", "of it not noise", "brightness", "display steps"}};
    const auto cell = [](const Estimate& e) {
        return fmt::format("{} ({} to {})", percent(e.value), percent(e.low), percent(e.high));
    };
    const PictureError* first = nullptr;
    for (const RendererRun& run : report.runs) {
        if (!run.error) continue;
        first = &*run.error;
        const PictureError& e = *run.error;
        rows.push_back({run.name, cell(e.relative), e.systematic ? cell(*e.systematic) : "all of it",
                        cell(e.brightness), fmt::format("{:.2g}", e.display.value)});
    }
    if (first == nullptr) return {};
    return "\n" + aligned(rows) +
           fmt::format("  against {} pixels at random, traced by the reference with {} samples of up to {} segments\n",
                       first->pixels, first->samples, first->depth);
}

std::string details(const Comparison& comparison)
{
    std::string out;
    if (comparison.test)
        out += fmt::format(
            "  {} tests, false-alarm rate {}; a difference of {} in a tile or {} in the whole is found with "
            "probability {:g}\n",
            comparison.test->tests, percent(comparison.test->false_alarm), percent(comparison.test->detectable_tile),
            percent(comparison.test->detectable_whole), comparison.test->power);
    for (const std::string& reason : comparison.reasons) out += "  " + reason + "\n";
    return out;
}

}  // namespace

std::string report_table(const Report& report, int width)
{
    // The other columns of a run take about 70; what is left is the device's.
    const std::size_t device_width = static_cast<std::size_t>(std::clamp(width - 70, 12, 60));
    std::vector<Row> runs{{"renderer", "device", "time", "samples", "standard error"}};
    for (const RendererRun& run : report.runs)
        runs.push_back({run.name, shortened(run.device, device_width), seconds_text(total_seconds(run)),
                        run.film.variance.empty() ? "-" : fmt::format("{}", run.film.samples), error_text(run.film)});
    std::string out = fmt::format("{}{}\n", report.scene, report.interrupted ? " (interrupted)" : "") + aligned(runs);
    out += errors_table(report);
    if (report.comparisons.empty()) return out;

    std::vector<Row> pairs{{"compared", "mean diff.", "relMSE", "PSNR", "SSIM", "FLIP", "verdict"}};
    for (const RunComparison& pair : report.comparisons) {
        Row row{report.runs[pair.a].name + " - " + report.runs[pair.b].name};
        const Row cells = metric_cells(pair.comparison.metrics);
        row.insert(row.end(), cells.begin(), cells.end());
        row.emplace_back(name(pair.comparison.verdict));
        pairs.push_back(std::move(row));
    }
    out += "\n" + aligned(pairs);
    for (const RunComparison& pair : report.comparisons) {
        const std::string lines = details(pair.comparison);
        if (!lines.empty())
            out += fmt::format("{} - {}:\n{}", report.runs[pair.a].name, report.runs[pair.b].name, lines);
    }
    return out + "\n" + summary(report) + "\n";
}

std::string diff_table(const FileDiff& diff)
{
    const PictureMetrics& m = diff.comparison.metrics;
    std::vector<Row> rows{{"verdict", std::string(name(diff.comparison.verdict))},
                          {"size", fmt::format("{}x{}", diff.a.width, diff.a.height)},
                          {"error of A", error_text(diff.a)},
                          {"error of B", error_text(diff.b)},
                          {"mean difference", percent(m.mean_relative)},
                          {"RMSE", fmt::format("{:.4g}", m.rmse)},
                          {"relMSE", fmt::format("{:.4g}", m.relmse)},
                          {"PSNR", m.psnr ? fmt::format("{:.2f} dB", *m.psnr) : "identical"},
                          {"SSIM", fmt::format("{:.5f}", m.ssim)},
                          {"FLIP", fmt::format("{:.5f}", m.flip)},
                          {"largest difference", fmt::format("{:.4g}", m.max)}};
    if (m.alpha_max > 0) rows.push_back({"largest difference of alpha", fmt::format("{:.4g}", m.alpha_max)});
    return aligned(rows) + details(diff.comparison);
}

}  // namespace etalon
