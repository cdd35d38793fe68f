#include <cmath>
#include <nlohmann/json.hpp>

#include "engine/measure/diff.h"
#include "engine/measure/picture_error.h"
#include "engine/measure/report.h"
#include "engine/measure/stability.h"
#include "engine/measure/text.h"
#include "engine/measure/tradeoff.h"
#include "engine/scene/knobs.h"

namespace etalon {
namespace {

using Json = nlohmann::ordered_json;

/// JSON has no NaN and no Inf: null.
Json number(double value)
{
    return std::isfinite(value) ? Json(value) : Json(nullptr);
}
Json number(const std::optional<double>& value)
{
    return value ? number(*value) : Json(nullptr);
}

Json stages_json(const std::vector<StageTime>& stages)
{
    Json out = Json::array();
    for (const StageTime& stage : stages) out.push_back({{"stage", stage.stage}, {"seconds", number(stage.seconds)}});
    return out;
}

Json values_json(const NamedValues& values)
{
    Json out = Json::object();
    for (const auto& [key, value] : values) out[key] = value;
    return out;
}

Json error_json(const Film& film)
{
    const std::optional<ErrorEstimate> error = estimate_error(film);
    if (!error) return nullptr;
    return {{"relative", number(error->relative)}, {"low", number(error->low)}, {"high", number(error->high)}};
}

/// Over pixels and channels that are finite.
double mean_radiance(const Film& film)
{
    double sum = 0, count = 0;
    for (const vec3& value : film.mean) {
        for (int c = 0; c < 3; ++c) {
            if (!std::isfinite(value[c])) continue;
            sum += double(value[c]);
            ++count;
        }
    }
    return count > 0 ? sum / count : 0;
}

Json film_json(const Film& film)
{
    const FilmCheck checked = check(film);
    return {{"width", film.width},
            {"height", film.height},
            {"samples", film.samples},
            {"mean_radiance", number(mean_radiance(film))},
            {"error_measured", !film.variance.empty()},
            {"error", error_json(film)},
            {"nonfinite_samples", film.nonfinite},
            {"truncated_paths", film.truncated},
            {"nan_pixels", checked.nan_pixels},
            {"inf_pixels", checked.inf_pixels},
            {"single_colour", checked.single_colour}};
}

Json finding_json(const TileFinding& tile)
{
    constexpr const char* kChannels[] = {"red", "green", "blue"};
    return {{"x", tile.x},
            {"y", tile.y},
            {"width", tile.width},
            {"height", tile.height},
            {"channel", kChannels[tile.channel]},
            {"z", number(tile.z)},
            {"p", number(tile.p)},
            {"relative", number(tile.relative)}};
}

Json test_json(const StatisticalTest& test)
{
    Json failures = Json::array();
    for (const TileFinding& tile : test.failures) failures.push_back(finding_json(tile));
    Json whole = Json::array();
    for (const TileFinding& channel : test.whole) whole.push_back(finding_json(channel));
    return {{"false_alarm", number(test.false_alarm)},
            {"level", number(test.level)},
            {"tests", test.tests},
            {"failed", test.failed},
            {"power", number(test.power)},
            {"detectable_tile", number(test.detectable_tile)},
            {"detectable_whole", number(test.detectable_whole)},
            {"worst_tile", finding_json(test.worst_tile)},
            {"whole", whole},
            {"failures", failures},
            {"tile_z_std", number(test.tile_z_std)},
            {"pixel_z_std", number(test.pixel_z_std)},
            {"pixel_z_max", number(test.pixel_z_max)},
            {"pixel_over_bound", test.pixel_over_bound},
            {"constant", test.constant},
            {"constant_unequal", test.constant_unequal},
            {"uniformity_p", number(test.uniformity_p)},
            {"tile_p_histogram", test.tile_p_histogram},
            {"pixel_p_histogram", test.pixel_p_histogram}};
}

Json comparison_json(const Comparison& comparison)
{
    const PictureMetrics& m = comparison.metrics;
    return {{"verdict", name(comparison.verdict)},
            {"passed", passed(comparison.verdict)},
            {"reasons", comparison.reasons},
            {"metrics",
             {{"identical", m.identical},
              {"rmse", number(m.rmse)},
              {"relmse", number(m.relmse)},
              {"psnr_db", number(m.psnr)},
              {"ssim", number(m.ssim)},
              {"flip", number(m.flip)},
              {"max", number(m.max)},
              {"mean_relative", number(m.mean_relative)},
              {"alpha_max", number(m.alpha_max)}}},
            {"test", comparison.test ? test_json(*comparison.test) : Json(nullptr)}};
}

/// Names come from files: bytes that are not UTF-8 become U+FFFD instead of an exception.
std::string dump(const Json& json)
{
    return json.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

Json timing_json(const Timing& time)
{
    const MedianInterval interval = median_interval(time.seconds);
    return {{"median", time.median()},
            {"low", interval.low},
            {"high", interval.high},
            {"confidence", interval.confidence},
            {"all", time.seconds}};
}

Json estimate_json(const Estimate& estimate)
{
    return {{"value", number(estimate.value)}, {"low", number(estimate.low)}, {"high", number(estimate.high)}};
}

Json picture_error(const PictureError& error)
{
    Json map = Json::array();
    for (const double cell : error.map) map.push_back(number(cell));
    return {{"text", describe(error)},
            {"rmse_nit", estimate_json(error.rmse)},
            {"relative", estimate_json(error.relative)},
            {"relmse", estimate_json(error.relmse)},
            {"display_steps", estimate_json(error.display)},
            {"brightness", estimate_json(error.brightness)},
            {"systematic", error.systematic ? estimate_json(*error.systematic) : Json(nullptr)},
            {"mean_nit", number(error.mean)},
            {"probe",
             {{"pixels", error.pixels},
              {"samples", error.samples},
              {"max_depth", error.depth},
              {"left_out", error.left_out},
              {"cut_by_time", error.cut}}},
            {"map", {{"columns", error.cells_x}, {"rows", error.cells_y}, {"relative", map}}}};
}

}  // namespace

std::string picture_error_json(const PictureError& error)
{
    Json out{{"schema", "etalon-picture-error/1"}};
    out.update(picture_error(error));
    return dump(out);
}

std::string report_json(const Report& report)
{
    Json runs = Json::array();
    for (const RendererRun& run : report.runs)
        runs.push_back({{"name", run.name},
                        {"label", run.label},
                        {"device", run.device},
                        {"film", film_json(run.film)},
                        {"picture_error", run.error ? picture_error(*run.error) : Json(nullptr)},
                        {"stages", stages_json(run.stages)}});
    Json comparisons = Json::array();
    for (const RunComparison& pair : report.comparisons) {
        Json row{{"a", report.runs[pair.a].name}, {"b", report.runs[pair.b].name}};
        row.update(comparison_json(pair.comparison));
        comparisons.push_back(std::move(row));
    }
    const Json out{{"schema", "etalon-report/1"},
                   {"scene", report.scene},
                   {"command", report.command},
                   {"passed", passed(report)},
                   {"interrupted", report.interrupted},
                   {"settings", values_json(report.settings)},
                   {"versions", values_json(report.versions)},
                   {"notes", report.notes},
                   {"stages", stages_json(report.stages)},
                   {"renderers", runs},
                   {"comparisons", comparisons}};
    return dump(out);
}

std::string diff_json(const FileDiff& diff, const std::string& name_a, const std::string& name_b)
{
    Json out{{"schema", "etalon-diff/1"},
             {"a", name_a},
             {"b", name_b},
             {"film_a", film_json(diff.a)},
             {"film_b", film_json(diff.b)}};
    out.update(comparison_json(diff.comparison));
    return dump(out);
}

std::string tradeoff_json(const Tradeoff& tradeoff)
{
    Json points = Json::array();
    for (const TradePoint& point : tradeoff.points)
        points.push_back({{"settings", point.flags},
                          {"turned", point.turned},
                          {"frontier", point.frontier},
                          {"seconds", timing_json(point.time)},
                          {"time_ratio", point.time_ratio},
                          {"relmse", point.error.relmse},
                          {"relmse_deviation", point.error.deviation},
                          {"reference_share", point.error.reference_share},
                          {"resolved", point.error.resolved()},
                          {"psnr_db", number(point.metrics.psnr)},
                          {"ssim", number(point.metrics.ssim)},
                          {"flip", number(point.metrics.flip)},
                          {"first_seconds", point.first_seconds},
                          {"memory_bytes_predicted", point.memory}});
    Json table = Json::array();
    for (const Knob& knob : knobs())
        table.push_back({{"name", knob.name},
                         {"renderers", knob.scope == KnobScope::path     ? "path tracers"
                                       : knob.scope == KnobScope::raster ? "rasterizers"
                                                                         : "CPU stages"},
                         {"standard", knob_value(RenderSettings{}, knob.name)},
                         {"what", knob.what},
                         {"buys", knob.buys},
                         {"costs", knob.costs},
                         {"changes_pixels", knob.metric != KnobMetric::none}});
    const Json out = {{"schema", "etalon-tradeoff/1"},
                      {"scene", tradeoff.scene},
                      {"command", tradeoff.command},
                      {"settings", values_json(tradeoff.settings)},
                      {"versions", values_json(tradeoff.versions)},
                      {"notes", tradeoff.notes},
                      {"interrupted", tradeoff.interrupted},
                      {"reference",
                       {{"settings", flags_of(tradeoff.reference_settings)},
                        {"samples", tradeoff.reference.samples},
                        {"from_cache", tradeoff.reference_cached},
                        {"seconds", tradeoff.reference_seconds}}},
                      {"knobs", table},
                      {"points", points}};
    return out.dump(1, ' ', false, Json::error_handler_t::replace) + "\n";
}

std::string stability_json(const Stability& stability)
{
    Json rows = Json::array();
    for (const StabilityRow& row : stability.rows) {
        Json probes = Json::array();
        for (const Probe& probe : row.probes)
            probes.push_back({{"size", probe.size}, {"holds", probe.holds}, {"why", probe.why}});
        const std::optional<double> broken = row.breaks_at();
        rows.push_back({{"id", row.id},
                        {"relation", row.name},
                        {"unit", row.unit},
                        {"renderer", name(row.renderer)},
                        {"promised", row.promised},
                        {"promise", row.promise == Holding::holds    ? "holds"
                                    : row.promise == Holding::breaks ? "breaks"
                                                                     : "not reached"},
                        {"holds_to", row.holds_to() > 0 ? Json(row.holds_to()) : Json(nullptr)},
                        {"breaks_at", broken ? Json(*broken) : Json(nullptr)},
                        {"probes", probes}});
    }
    const Json out = {{"schema", "etalon-stability/1"},
                      {"scene", stability.scene},
                      {"command", stability.command},
                      {"settings", values_json(stability.settings)},
                      {"versions", values_json(stability.versions)},
                      {"notes", stability.notes},
                      {"interrupted", stability.interrupted},
                      {"passed", passed(stability)},
                      {"rows", rows}};
    return out.dump(1, ' ', false, Json::error_handler_t::replace) + "\n";
}

}  // namespace etalon
