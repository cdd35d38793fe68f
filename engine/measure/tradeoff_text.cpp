#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "engine/base/files.h"
#include "engine/image/io.h"
#include "engine/measure/text.h"
#include "engine/measure/tradeoff.h"

namespace etalon {
namespace {

std::string error_cell(const ErrorMeasurement& error)
{
    return fmt::format("{:.3g} ± {:.1g}{}", error.relmse, 2 * error.deviation, error.resolved() ? "" : " (*)");
}

std::string time_cell(const Timing& time)
{
    const MedianInterval interval = median_interval(time.seconds);
    return fmt::format("{:.3g} ({:.3g} … {:.3g}) s", time.median(), interval.low, interval.high);
}

std::vector<const TradePoint*> frontier_of(const Tradeoff& tradeoff)
{
    std::vector<const TradePoint*> out;
    for (const TradePoint& point : tradeoff.points)
        if (point.frontier) out.push_back(&point);
    std::sort(out.begin(), out.end(),
              [](const TradePoint* a, const TradePoint* b) { return a->time.median() < b->time.median(); });
    return out;
}

std::string megabytes(std::uint64_t bytes)
{
    return bytes == 0 ? "-" : fmt::format("{:.0f} MB", double(bytes) / 1e6);
}

std::string quoted(const std::string& text)
{
    std::string out = "\"";
    for (const char c : text) out += c == '"' ? std::string("\"\"") : std::string(1, c);
    return out + "\"";
}

}  // namespace

std::string tradeoff_table(const Tradeoff& tradeoff)
{
    std::string out =
        fmt::format("{}: reference {} spp {}\n\nFrontier (nothing measured is both faster and nearer)\n",
                    tradeoff.scene, tradeoff.reference.samples,
                    tradeoff.reference_cached ? "of an earlier run" : "in " + seconds_text(tradeoff.reference_seconds));
    std::vector<TableRow> rows = {{"time", "relMSE", "settings to copy"}};
    for (const TradePoint* point : frontier_of(tradeoff))
        rows.push_back({time_cell(point->time), error_cell(point->error), point->flags});
    out += aligned(rows);

    out += "\nWhat each knob buys and costs here, alone\n";
    rows = {{"knob", "settings", "time", "relMSE", "at the standard", "FLIP", "memory"}};
    for (const TradePoint& point : tradeoff.points) {
        if (point.turned.empty() || point.turned == "several") continue;
        rows.push_back({point.turned, point.flags, fmt::format("× {:.2f}", point.time_ratio), error_cell(point.error),
                        error_cell(tradeoff.points[point.base].error), fmt::format("{:.3f}", point.metrics.flip),
                        megabytes(point.memory)});
    }
    out += aligned(rows);
    const bool unresolved = std::any_of(tradeoff.points.begin(), tradeoff.points.end(),
                                        [](const TradePoint& point) { return !point.error.resolved(); });
    if (unresolved)
        out += "(*) the reference's own noise is more than a tenth of this: a larger --budget resolves it\n";
    for (const std::string& note : tradeoff.notes) out += note + "\n";
    return out;
}

std::string tradeoff_csv(const Tradeoff& tradeoff)
{
    std::string out =
        "settings,turned,frontier,rounds,seconds_median,seconds_low,seconds_high,time_ratio,relmse,relmse_deviation,"
        "reference_share,psnr_db,ssim,flip,first_seconds,memory_bytes_predicted\r\n";
    for (const TradePoint& point : tradeoff.points) {
        const MedianInterval time = median_interval(point.time.seconds);
        out += fmt::format("{},{},{},{},{},{},{},{},{},{},{},{},{},{},{},{}\r\n", quoted(point.flags), point.turned,
                           point.frontier ? 1 : 0, point.time.seconds.size(), point.time.median(), time.low, time.high,
                           point.time_ratio, point.error.relmse, point.error.deviation, point.error.reference_share,
                           point.metrics.psnr ? fmt::format("{}", *point.metrics.psnr) : "", point.metrics.ssim,
                           point.metrics.flip, point.first_seconds, point.memory);
    }
    return out;
}

std::vector<std::filesystem::path> write_tradeoff(const Tradeoff& tradeoff, const std::filesystem::path& folder)
{
    make_folder(folder);
    const std::vector<std::filesystem::path> written = {folder / "tradeoff.html", folder / "tradeoff.json",
                                                        folder / "tradeoff.csv", folder / "reference.exr"};
    if (!tradeoff.reference.mean.empty()) write_film(tradeoff.reference, written[3]);
    replace_file(written[2], tradeoff_csv(tradeoff));
    replace_file(written[1], tradeoff_json(tradeoff));
    replace_file(written[0], tradeoff_html(tradeoff));
    return written;
}

}  // namespace etalon
