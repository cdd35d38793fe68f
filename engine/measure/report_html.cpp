#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "engine/image/io.h"
#include "engine/measure/page.h"
#include "engine/measure/picture_error.h"
#include "engine/measure/report.h"
#include "engine/measure/text.h"

namespace etalon {
namespace {

/// Above this many pixels the page carries pictures that are averaged down, and says so: a page of many megabytes is
/// slow.
constexpr std::size_t kMostPixels = std::size_t{1} << 20;

std::string data_uri(const Image& display)
{
    const std::vector<std::byte> png = encode_png(display, {});
    return "data:image/png;base64," + base64(png);
}

std::string picture(const Image& display, const std::string& alternative, const std::string& caption)
{
    return fmt::format(
        "<figure><img src=\"{}\" width=\"{}\" height=\"{}\" alt=\"{}\"><figcaption>{}</figcaption></figure>\n",
        data_uri(display), display.width, display.height, html_escape(alternative), caption);
}

/// Mean over `factor` × `factor` blocks (what does not fill a block is cut); errors of the mean shrink with it.
Film smaller(const Film& film, int factor)
{
    if (factor == 1) return film;
    Film out;
    out.width = film.width / factor;
    out.height = film.height / factor;
    out.samples = film.samples;
    const float count = static_cast<float>(factor * factor);
    for (int y = 0; y < out.height; ++y) {
        for (int x = 0; x < out.width; ++x) {
            vec3 mean(0), variance(0);
            float alpha = 0;
            for (int k = 0; k < factor * factor; ++k) {
                const std::size_t i = std::size_t(y * factor + k / factor) * std::size_t(film.width) +
                                      std::size_t(x * factor + k % factor);
                mean += film.mean[i] / count;
                if (!film.variance.empty()) variance += film.variance[i] / (count * count);
                alpha += film.alpha.empty() ? 1 / count : film.alpha[i] / count;
            }
            out.mean.push_back(mean);
            out.alpha.push_back(alpha);
            if (!film.variance.empty()) out.variance.push_back(variance);
        }
    }
    return out;
}

/// Shared-exponent pixels for page::kScript: mantissas above, exponents below. Relative precision of the largest
/// channel 2^-8.
Image shared_exponent(int width, int height, const std::vector<vec3>& values, bool root)
{
    Image out(width, 2 * height, 3);
    const std::size_t below = 3 * values.size();
    for (std::size_t i = 0; i < values.size(); ++i) {
        const vec3 v = root ? vec3(std::sqrt(values[i].x), std::sqrt(values[i].y), std::sqrt(values[i].z)) : values[i];
        const float largest = std::max({v.x, v.y, v.z});
        if (!std::isfinite(v.x + v.y + v.z)) {
            out.values[below + 3 * i] = 1;
            continue;
        }
        int exponent = 0;
        if (!(largest > 0)) continue;
        std::frexp(largest, &exponent);
        if (exponent <= -128 || exponent >= 127) continue;
        out.values[below + 3 * i] = static_cast<float>(exponent + 128) / 255.0f;
        for (int c = 0; c < 3; ++c)
            out.values[3 * i + std::size_t(c)] =
                std::clamp(std::floor(std::ldexp(v[c], 8 - exponent) + 0.5f), 0.0f, 255.0f) / 255.0f;
    }
    return out;
}

std::string json_string(const std::string& text)
{
    std::string out = "\"";
    for (const char c : text)
        // '<' is coded so that no name can close the script element.
        if (c == '"' || c == '\\' || c == '<' || static_cast<unsigned char>(c) < 0x20)
            out += fmt::format("\\u{:04x}", static_cast<unsigned>(static_cast<unsigned char>(c)));
        else
            out += c;
    return out + "\"";
}

std::string verdict_span(const Comparison& comparison)
{
    const bool tested = comparison.verdict != Verdict::not_tested;
    return fmt::format("<span class=\"{}\">{}</span>",
                       !tested                      ? ""
                       : passed(comparison.verdict) ? "good"
                                                    : "bad",
                       name(comparison.verdict));
}

std::string renderers_table(const Report& report)
{
    std::string out =
        "<h2>Renderers</h2>\n<div "
        "class=\"scroll\"><table><thead><tr><th>renderer</th><th>device</th><th>samples</th><th>relative "
        "standard error "
        "(95% interval)</th><th>time</th></tr></thead><tbody>\n";
    for (const RendererRun& run : report.runs) {
        std::string times;
        for (const StageTime& stage : run.stages)
            times += fmt::format("{}{} {}", times.empty() ? "" : "<br>", html_escape(stage.stage),
                                 seconds_text(stage.seconds));
        const FilmCheck checked = check(run.film);
        std::string error = run.film.variance.empty() ? "error not measured" : error_text(run.film);
        if (checked.nan_pixels + checked.inf_pixels > 0)
            error += fmt::format("<br><span class=\"bad\">{} NaN, {} Inf pixels</span>", checked.nan_pixels,
                                 checked.inf_pixels);
        if (checked.single_colour) error += "<br><span class=\"bad\">one single colour</span>";
        out += fmt::format("<tr><td>{}</td><td>{}</td><td>{}</td><td>{}</td><td>{}</td></tr>\n", html_escape(run.label),
                           html_escape(run.device), run.film.variance.empty() ? "–" : std::to_string(run.film.samples),
                           error, times);
    }
    return out + "</tbody></table></div>\n";
}

/// What the pictures of all renderers are off by, and where.
std::string errors_section(const Report& report)
{
    std::string rows, maps;
    const auto cell = [](const Estimate& e, double scale, const char* unit) {
        return fmt::format("{:.3g}{} ({:.3g} … {:.3g})", scale * e.value, unit, scale * e.low, scale * e.high);
    };
    for (const RendererRun& run : report.runs) {
        if (!run.error) continue;
        const PictureError& e = *run.error;
        rows += fmt::format("<tr><td>{}</td><td>{}</td><td>{}</td><td>{}</td><td>{}</td><td>{}</td></tr>\n",
                            html_escape(run.label), cell(e.relative, 100, "%"),
                            e.systematic ? cell(*e.systematic, 100, "%") : "all of it", cell(e.brightness, 100, "%"),
                            cell(e.relmse, 1, ""), cell(e.display, 1, ""));
        maps += picture(picture_error_map(e), "Map of the error of " + run.label,
                        fmt::format("<strong>{}</strong>: error by place, black 0.1% or less, white 100% or more",
                                    html_escape(run.name)));
    }
    if (rows.empty()) return {};
    const PictureError& first = *report.runs.front().error;
    return fmt::format(
        "<h2>Error of each picture</h2>\n<p>Against {} pixels at random, traced by the reference with {} samples of "
        "up to {} segments each{}; its noise is taken off. 95% intervals.</p>\n<div class=\"scroll\"><table><thead>"
        "<tr><th>picture</th><th>RMSE / mean</th><th>of it not noise</th><th>brightness</th><th>relMSE</th><th>steps "
        "of 255 on the display</th></tr></thead><tbody>\n{}</tbody></table></div>\n<div class=\"grid\">{}</div>\n",
        first.pixels, first.samples, first.depth, first.cut ? " (as many as time allowed)" : "", rows, maps);
}

std::string comparisons_table(const Report& report)
{
    if (report.comparisons.empty()) return {};
    std::string out =
        "<h2>Comparisons</h2>\n<div class=\"scroll\"><table><thead><tr><th>A</th><th>B</th><th>mean "
        "difference</th><th>RMSE</th><th>relMSE</th><th>PSNR</th><th>SSIM</th><th>FLIP</th><th>verdict</th></tr></"
        "thead><tbody>\n";
    for (const RunComparison& pair : report.comparisons) {
        const PictureMetrics& m = pair.comparison.metrics;
        std::string why;
        for (const std::string& reason : pair.comparison.reasons) why += "<br>" + html_escape(reason);
        out += fmt::format(
            "<tr><td>{}</td><td>{}</td><td>{}</td><td>{:.4g}</td><td>{:.4g}</td><td>{}</td><td>{:.4f}</td><td>{:.4f}</"
            "td><td>{}{}</"
            "td></tr>\n",
            html_escape(report.runs[pair.a].name), html_escape(report.runs[pair.b].name), percent(m.mean_relative),
            m.rmse, m.relmse, m.psnr ? fmt::format("{:.1f} dB", *m.psnr) : "identical", m.ssim, m.flip,
            verdict_span(pair.comparison), why);
    }
    return out + "</tbody></table></div>\n";
}

/// Bars of the counts; the line is what equal renderers would show on average.
std::string histogram_svg(const std::array<std::uint64_t, 20>& counts, const std::string& what)
{
    const std::uint64_t largest = std::max<std::uint64_t>(*std::max_element(counts.begin(), counts.end()), 1);
    std::uint64_t total = 0;
    for (const std::uint64_t count : counts) total += count;
    std::string bars;
    for (std::size_t k = 0; k < counts.size(); ++k) {
        const double height = 90.0 * static_cast<double>(counts[k]) / static_cast<double>(largest);
        bars += fmt::format(
            "<rect x=\"{}\" y=\"{:.1f}\" width=\"13\" height=\"{:.1f}\"><title>p {:.2f} to {:.2f}: {}</title></rect>",
            15 * k + 1, 100 - height, height, 0.05 * static_cast<double>(k), 0.05 * static_cast<double>(k + 1),
            counts[k]);
    }
    const double expected = 100 - 90.0 * static_cast<double>(total) / 20.0 / static_cast<double>(largest);
    return fmt::format(
        "<figure><svg viewBox=\"0 0 300 100\" width=\"300\" height=\"100\" role=\"img\" aria-label=\"{0}\">{1}<line "
        "x1=\"0\" x2=\"300\" "
        "y1=\"{2:.1f}\" y2=\"{2:.1f}\" stroke=\"#d33\" stroke-dasharray=\"4\"/></svg><figcaption>{0}; p from 0 to "
        "1</figcaption></figure>\n",
        html_escape(what), bars, expected);
}

std::string test_section(const StatisticalTest& test)
{
    return fmt::format(
        "<p>Welch's test on {} tiles and channels: false alarms in {} of equal pairs, all tests together (Šidák, each "
        "at {:.2g}). "
        "It finds a difference of {} in a tile and of {} in the whole with probability {:g}. Worst tile: ({}, {}), z = "
        "{:+.2f}, "
        "p = {:.2g}. std(z) = {:.3f} of tiles, {:.3f} of pixels; largest |z| of a pixel {:.1f}. Uniformity of the "
        "tiles' p-values: p = "
        "{:.2g}.</p>\n"
        "<div class=\"grid\">{}{}</div>\n",
        test.tests, percent(test.false_alarm), test.level, percent(test.detectable_tile),
        percent(test.detectable_whole), test.power, test.worst_tile.x, test.worst_tile.y, test.worst_tile.z,
        test.worst_tile.p, test.tile_z_std, test.pixel_z_std, test.pixel_z_max, test.uniformity_p,
        histogram_svg(test.tile_p_histogram, "p-values of tiles"),
        histogram_svg(test.pixel_p_histogram, "p-values of pixels"));
}

std::string comparison_sections(const Report& report, const std::vector<Film>& films)
{
    std::string out;
    for (const RunComparison& pair : report.comparisons) {
        const std::string a = html_escape(report.runs[pair.a].name);
        const std::string b = html_escape(report.runs[pair.b].name);
        const Film& film_a = films[pair.a];
        const Film& film_b = films[pair.b];
        out += fmt::format("<section><h2>{} against {}: {}</h2>\n<div class=\"grid\">\n", a, b,
                           verdict_span(pair.comparison));
        out +=
            picture(relative_difference_picture(film_a, film_b), fmt::format("relative difference of {} and {}", a, b),
                    "relative difference, logarithmic: black 10⁻⁴ or less, white 1 or more");
        if (pair.comparison.test)
            out += picture(
                z_picture(film_a, film_b), fmt::format("difference of {} and {} in standard errors", a, b),
                fmt::format("in standard errors: red where {} is brighter by 4 or more, blue where {} is", a, b));
        out += "</div>\n";
        if (pair.comparison.test) out += test_section(*pair.comparison.test);
        out += "</section>\n";
    }
    return out;
}

std::string values_table(const char* title, const NamedValues& values)
{
    if (values.empty()) return {};
    std::string out = fmt::format("<details><summary>{}</summary><table>\n", title);
    for (const auto& [key, value] : values)
        out += fmt::format("<tr><th>{}</th><td>{}</td></tr>\n", html_escape(key), html_escape(value));
    return out + "</table></details>\n";
}

std::string script_data(const Report& report, const std::vector<Film>& films)
{
    std::string runs;
    for (std::size_t i = 0; i < films.size(); ++i) {
        const Film& film = films[i];
        runs += fmt::format("{}{{\"name\":{},\"radiance\":\"{}\"", i == 0 ? "" : ",", json_string(report.runs[i].name),
                            data_uri(shared_exponent(film.width, film.height, film.mean, false)));
        if (!film.variance.empty())
            runs += fmt::format(",\"deviation\":\"{}\"",
                                data_uri(shared_exponent(film.width, film.height, film.variance, true)));
        runs += "}";
    }
    return fmt::format(
        "<script type=\"application/json\" "
        "id=\"data\">{{\"width\":{},\"height\":{},\"exposure\":{:.6g},\"runs\":[{}]}}</script>\n",
        films[0].width, films[0].height, std::isfinite(report.develop.exposure) ? report.develop.exposure : 0.0, runs);
}

int shrink_factor(const Report& report)
{
    std::size_t pixels = 0;
    for (const RendererRun& run : report.runs) pixels = std::max(pixels, run.film.pixel_count());
    return static_cast<int>(std::ceil(std::sqrt(static_cast<double>(pixels) / static_cast<double>(kMostPixels))));
}

std::string pictures_section(const Report& report, const std::vector<Film>& films, int factor)
{
    std::string out = "<h2>Pictures</h2>\n";
    if (factor > 1)
        out += fmt::format("<p>Shown at 1/{} of the size; the files beside this page have it all.</p>\n", factor);
    out += "<div class=\"grid\">\n";
    for (std::size_t i = 0; i < films.size(); ++i)
        out += picture(develop(films[i], report.develop), report.runs[i].label,
                       fmt::format("<strong>{}</strong>: {}", html_escape(report.runs[i].name),
                                   html_escape(report.runs[i].label)));
    return out + "</div>\n";
}

}  // namespace

std::string report_html(const Report& report)
{
    const int factor = std::max(1, shrink_factor(report));
    std::vector<Film> films;
    for (const RendererRun& run : report.runs) films.push_back(smaller(run.film, factor));
    const bool fine = passed(report);

    std::string out =
        "<!DOCTYPE html>\n<html lang=\"en\"><head><meta charset=\"utf-8\">\n<meta name=\"viewport\" "
        "content=\"width=device-width\">\n";
    out +=
        "<meta http-equiv=\"Content-Security-Policy\" content=\"default-src 'none'; img-src data:; style-src "
        "'unsafe-inline'; script-src 'unsafe-inline'\">\n";
    out += fmt::format("<title>{}: Etalon</title>\n<style>{}</style></head><body>\n", html_escape(report.scene),
                       page::kStyle);
    out += fmt::format("<h1>{}: <span class=\"{}\">{}</span>{}</h1>\n", html_escape(report.scene),
                       fine ? "good" : "bad", summary(report), report.interrupted ? " (interrupted)" : "");
    if (!report.command.empty()) out += fmt::format("<p><code>{}</code></p>\n", html_escape(report.command));
    out += comparisons_table(report) + renderers_table(report) + errors_section(report);
    if (!films.empty()) {
        out += pictures_section(report, films, factor);
        out += page::kInspector;
        out += comparison_sections(report, films);
    }
    if (!report.notes.empty()) {
        out += "<h2>Notes</h2><ul>\n";
        for (const std::string& note : report.notes) out += fmt::format("<li>{}</li>\n", html_escape(note));
        out += "</ul>\n";
    }
    out += values_table("Settings", report.settings) + values_table("Versions", report.versions);
    if (!films.empty()) out += script_data(report, films) + fmt::format("<script>{}</script>\n", page::kScript);
    return out + "</body></html>\n";
}

}  // namespace etalon
