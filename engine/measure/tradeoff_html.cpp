#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "engine/image/io.h"
#include "engine/measure/page.h"
#include "engine/measure/text.h"
#include "engine/measure/tradeoff.h"

namespace etalon {
namespace {

// Plot area in the SVG's own units.
constexpr double kWidth = 760, kHeight = 420, kLeft = 80, kRight = 20, kTop = 15, kBottom = 45;

/// A logarithmic axis over whole decades.
struct Axis {
    int first = 0, last = 1;  ///< powers of ten at its ends
    double from = 0, to = 1;  ///< where those are, in the SVG

    double at(double value) const
    {
        const double t = (std::log10(value) - first) / (last - first);
        return from + std::clamp(t, 0.0, 1.0) * (to - from);
    }
};

Axis axis_over(const std::vector<double>& values, double from, double to)
{
    const auto [least, most] = std::minmax_element(values.begin(), values.end());
    Axis axis{.from = from, .to = to};
    axis.first = static_cast<int>(std::floor(std::log10(*least)));
    axis.last = std::max(axis.first + 1, static_cast<int>(std::ceil(std::log10(*most))));
    return axis;
}

/// A picture that is exact to the reference's noise has no place on a logarithmic axis: it is shown at this share of
/// the smallest that has.
double shown_error(const TradePoint& point)
{
    return std::max(point.error.relmse, std::max(point.error.deviation, 1e-9));
}

std::string grid(const Axis& x, const Axis& y)
{
    std::string out;
    for (int power = x.first; power <= x.last; ++power) {
        const double at = x.at(std::pow(10.0, power));
        out += fmt::format(
            "<line x1=\"{0:.1f}\" x2=\"{0:.1f}\" y1=\"{1}\" y2=\"{2}\"/><text x=\"{0:.1f}\" y=\"{3}\" "
            "text-anchor=\"middle\">{4:g} s</text>\n",
            at, kTop, kHeight - kBottom, kHeight - kBottom + 18, std::pow(10.0, power));
    }
    for (int power = y.first; power <= y.last; ++power) {
        const double at = y.at(std::pow(10.0, power));
        out += fmt::format(
            "<line x1=\"{1}\" x2=\"{2}\" y1=\"{0:.1f}\" y2=\"{0:.1f}\"/><text x=\"{3}\" y=\"{4:.1f}\" "
            "text-anchor=\"end\">1e{5}</text>\n",
            at, kLeft, kWidth - kRight, kLeft - 8, at + 4, power);
    }
    return out;
}

std::string plot(const Tradeoff& tradeoff)
{
    std::vector<double> seconds, errors;
    for (const TradePoint& point : tradeoff.points) {
        seconds.push_back(std::max(point.time.median(), 1e-6));
        errors.push_back(shown_error(point));
    }
    const Axis x = axis_over(seconds, kLeft, kWidth - kRight);
    const Axis y = axis_over(errors, kHeight - kBottom, kTop);
    std::string out = fmt::format(
        "<svg viewBox=\"0 0 {} {}\" role=\"img\" aria-label=\"Time against error of every point measured; the table "
        "below has the values\">\n<g class=\"grid-lines\">{}</g>\n<text x=\"{}\" y=\"{}\" text-anchor=\"middle\">time "
        "of "
        "a picture</text><text x=\"14\" y=\"{}\" transform=\"rotate(-90 14 {})\" "
        "text-anchor=\"middle\">relMSE</text>\n",
        kWidth, kHeight, grid(x, y), (kLeft + kWidth - kRight) / 2, kHeight - 6, kHeight / 2, kHeight / 2);
    std::vector<std::pair<double, double>> frontier;
    for (std::size_t i = 0; i < tradeoff.points.size(); ++i)
        if (tradeoff.points[i].frontier) frontier.emplace_back(x.at(seconds[i]), y.at(errors[i]));
    std::sort(frontier.begin(), frontier.end());
    std::string line;
    for (const auto& [px, py] : frontier) line += fmt::format("{:.1f},{:.1f} ", px, py);
    out += fmt::format("<polyline points=\"{}\"/>\n", line);
    for (std::size_t i = 0; i < tradeoff.points.size(); ++i) {
        const TradePoint& point = tradeoff.points[i];
        const MedianInterval time = median_interval(point.time.seconds);
        out += fmt::format("<line class=\"whisker\" x1=\"{:.1f}\" x2=\"{:.1f}\" y1=\"{:.1f}\" y2=\"{:.1f}\"/>",
                           x.at(std::max(time.low, 1e-6)), x.at(std::max(time.high, 1e-6)), y.at(errors[i]),
                           y.at(errors[i]));
        out += fmt::format(
            "<circle class=\"{}{}\" cx=\"{:.1f}\" cy=\"{:.1f}\" r=\"{}\" tabindex=\"0\" "
            "data-point=\"{}\"><title>{}</title></circle>\n",
            point.settings.renderer == Renderer::path ? "path" : "raster", point.frontier ? " best" : "",
            x.at(seconds[i]), y.at(errors[i]), point.turned.empty() ? 7 : 5, i, html_escape(point.flags));
    }
    return out + "</svg>\n";
}

std::string data_uri(const Image& display)
{
    return "data:image/png;base64," + base64(encode_png(display, {}));
}

std::string pictures(const Tradeoff& tradeoff)
{
    std::string out = "<div id=\"pictures\">\n";
    for (std::size_t i = 0; i < tradeoff.points.size(); ++i) {
        const TradePoint& point = tradeoff.points[i];
        out += fmt::format(
            "<div class=\"grid\" id=\"point-{}\" hidden><figure><img src=\"{}\" alt=\"Picture\"><figcaption><code>{}"
            "</code></figcaption></figure><figure><img src=\"{}\" alt=\"Relative difference to the reference\">"
            "<figcaption>Difference to the reference, 10⁻⁴ black to 1 white</figcaption></figure></div>\n",
            i, data_uri(develop(point.film, tradeoff.develop)), html_escape(point.flags),
            data_uri(relative_difference_picture(point.film, tradeoff.reference)));
    }
    return out + "</div>\n";
}

std::string points_table(const Tradeoff& tradeoff)
{
    std::string out =
        "<h2>Every point</h2>\n<div class=\"scroll\"><table><thead><tr><th>settings</th><th>turned</th><th>time, "
        "median (interval)</th><th>× standard</th><th>relMSE</th><th>± 2 "
        "σ</th><th>PSNR</th><th>SSIM</th><th>FLIP</th><th>first "
        "call</th><th>memory</th><th>rounds</th></tr></thead><tbody>\n";
    for (const TradePoint& point : tradeoff.points) {
        const MedianInterval time = median_interval(point.time.seconds);
        out += fmt::format(
            "<tr><td{}><code>{}</code></td><td>{}</td><td>{:.3g} ({:.3g} … {:.3g}) s</td><td>{:.2f}</td>"
            "<td>{:.3g}{}</td><td>{:.1g}</td><td>{}</td><td>{:.4f}</td><td>{:.4f}</td><td>{:.3g} s</td><td>{}</td>"
            "<td>{}</td></tr>\n",
            point.frontier ? " class=\"good\"" : "", html_escape(point.flags),
            html_escape(point.turned.empty() ? "standard" : point.turned), point.time.median(), time.low, time.high,
            point.time_ratio, point.error.relmse, point.error.resolved() ? "" : " *", 2 * point.error.deviation,
            point.metrics.psnr ? fmt::format("{:.1f} dB", *point.metrics.psnr) : "identical", point.metrics.ssim,
            point.metrics.flip, point.first_seconds,
            point.memory > 0 ? fmt::format("{:.0f} MB", double(point.memory) / 1e6) : "–", point.time.seconds.size());
    }
    return out +
           "</tbody></table></div>\n<p>Green: on the frontier. *: the reference's own noise is more than a tenth of "
           "this figure. PSNR, SSIM and FLIP are of the developed pictures of the first round, with the reference's "
           "noise in them; the first call makes scene and pipelines, which later ones keep; memory is predicted. "
           "Intervals hold the median with 95% where five or more rounds allow it, else they are the "
           "whole range.</p>\n";
}

constexpr std::string_view kPlotStyle = R"css(
svg { width: 100%; height: auto; } svg text { fill: currentColor; font-size: 12px; }
.grid-lines line { stroke: var(--line); } polyline { fill: none; stroke: var(--good); stroke-width: 2; }
.whisker { stroke: currentColor; opacity: .4; } circle { stroke: var(--soft); cursor: pointer; }
circle.path { fill: #2f81f7; } circle.raster { fill: #db6d28; } circle.best { stroke: var(--good); stroke-width: 3; }
.grid[hidden] { display: none; } circle:focus { outline: 2px solid currentColor; }
)css";

constexpr std::string_view kPlotScript = R"js(
"use strict";
let shown = null;
function show(index) {
  if (shown) shown.hidden = true;
  shown = document.getElementById("point-" + index);
  if (shown) shown.hidden = false;
}
for (const circle of document.querySelectorAll("circle[data-point]"))
  for (const event of ["mouseenter", "focus", "click"])
    circle.addEventListener(event, () => show(circle.dataset.point));
show(0);
)js";

}  // namespace

std::string tradeoff_html(const Tradeoff& tradeoff)
{
    std::string out = fmt::format(
        "<!doctype html>\n<html lang=\"en\"><head><meta charset=\"utf-8\"><meta name=\"viewport\" "
        "content=\"width=device-width\"><title>{0}: speed against accuracy</title><style>{1}{2}</style></head><body>\n"
        "<h1>{0}: speed against accuracy</h1>\n<p>Reference: {3}, {4} samples a pixel, {5}. Orange: rasterizer; blue: "
        "path tracer; green line: the frontier, where nothing measured is both faster and nearer. Point at a circle "
        "(or use Tab) to see its picture.</p>\n",
        html_escape(tradeoff.scene), page::kStyle, kPlotStyle, html_escape(flags_of(tradeoff.reference_settings)),
        tradeoff.reference.samples, html_escape(error_text(tradeoff.reference)));
    if (tradeoff.points.empty())
        out += "<p class=\"bad\">Interrupted before anything was measured.</p>\n";
    else
        out += plot(tradeoff) + pictures(tradeoff) + points_table(tradeoff);
    for (const std::string& note : tradeoff.notes) out += fmt::format("<p>{}</p>\n", html_escape(note));
    out += "<details><summary>How this was made</summary><table>";
    for (const NamedValues* values : {&tradeoff.settings, &tradeoff.versions})
        for (const auto& [key, value] : *values)
            out += fmt::format("<tr><td>{}</td><td>{}</td></tr>\n", html_escape(key), html_escape(value));
    return out + fmt::format("</table><p><code>{}</code></p></details>\n<script>{}</script></body></html>\n",
                             html_escape(tradeoff.command), kPlotScript);
}

}  // namespace etalon
