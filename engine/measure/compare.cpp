#include "engine/measure/compare.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <tuple>

#include "engine/base/error.h"
#include "engine/image/develop.h"
#include "engine/image/flip.h"
#include "engine/image/metrics.h"
#include "engine/measure/welch.h"

namespace etalon {
namespace {

void require_valid(const Film& film, const char* which)
{
    const std::size_t n = film.pixel_count();
    if (film.width < 1 || film.height < 1 || film.mean.size() != n ||
        (!film.variance.empty() && film.variance.size() != n) || (!film.alpha.empty() && film.alpha.size() != n))
        throw Error(Blame::input,
                    fmt::format("picture {} has {} x {} pixels, but {} means, {} variances and {} alphas", which,
                                film.width, film.height, film.mean.size(), film.variance.size(), film.alpha.size()));
}

void require_comparable(const Film& a, const Film& b, const CompareSettings& s)
{
    require_valid(a, "A");
    require_valid(b, "B");
    if (a.width != b.width || a.height != b.height)
        throw Error(
            Blame::input,
            fmt::format("the pictures have different sizes: {}x{} and {}x{}", a.width, a.height, b.width, b.height),
            "render both with the same --size");
    if (!(s.false_alarm > 0 && s.false_alarm < 1))
        throw Error(Blame::input, fmt::format("a false-alarm rate of {} is not between 0 and 1", s.false_alarm));
    if (!(s.power > 0 && s.power < 1))
        throw Error(Blame::input, fmt::format("a power of {} is not between 0 and 1", s.power));
    if (s.tile < 1) throw Error(Blame::input, fmt::format("a tile of {} pixels is empty", s.tile));
    if (!(s.rounding >= 0 && s.rounding < 1))
        throw Error(Blame::input, fmt::format("a rounding of {} is not in [0, 1)", s.rounding));
}

Image linear_image(const Film& film)
{
    Image image(film.width, film.height, 3);
    for (std::size_t i = 0; i < film.mean.size(); ++i)
        for (int c = 0; c < 3; ++c) image.values[3 * i + std::size_t(c)] = film.mean[i][c];
    return image;
}

double mean_relative_difference(const Image& a, const Image& b)
{
    double difference = 0;
    double magnitude = 0;
    for (std::size_t i = 0; i < a.values.size(); ++i) {
        const double x = a.values[i];
        const double y = b.values[i];
        if (!std::isfinite(x) || !std::isfinite(y)) continue;
        difference += std::abs(x - y);
        magnitude += 0.5 * (std::abs(x) + std::abs(y));
    }
    return difference == 0 ? 0 : difference / magnitude;
}

double largest_alpha_difference(const Film& a, const Film& b)
{
    double largest = 0;
    for (std::size_t i = 0; i < std::min(a.alpha.size(), b.alpha.size()); ++i)
        largest = std::max(largest, std::abs(double(a.alpha[i]) - double(b.alpha[i])));
    return largest;
}

PictureMetrics picture_metrics(const Film& a, const Film& b)
{
    const Image linear_a = linear_image(a);
    const Image linear_b = linear_image(b);
    const Metrics linear = measure_difference(linear_a, linear_b, 0);
    const Image shown_a = develop(a, {}), shown_b = develop(b, {});
    const Metrics shown = measure_difference(shown_a, shown_b);
    const double alpha = largest_alpha_difference(a, b);
    return {.identical = linear.identical && alpha == 0,
            .rmse = linear.rmse,
            .relmse = linear.relmse,
            .psnr = shown.psnr,
            .ssim = shown.ssim,
            .flip = mean_flip(shown_b, shown_a),
            .max = linear.max_abs,
            .mean_relative = mean_relative_difference(linear_a, linear_b),
            .alpha_max = alpha};
}

bool has_error(const Film& film)
{
    return !film.variance.empty() && film.samples >= 2;
}

bool finite_variance(const Film& film)
{
    return std::all_of(film.variance.begin(), film.variance.end(),
                       [](const vec3& v) { return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z); });
}

/// Adds a reason when `value` breaks `limit`; returns whether it does.
bool breaks(std::vector<std::string>& reasons, const char* what, double value, const std::optional<double>& limit,
            bool at_least)
{
    if (!limit) return false;
    const bool broken = at_least ? !(value >= *limit) : !(value <= *limit);
    reasons.push_back(fmt::format("{} {:.4g} is {} the budget of {} {:.4g}", what, value, broken ? "over" : "within",
                                  at_least ? "at least" : "at most", *limit));
    return broken;
}

bool over_budget(std::vector<std::string>& reasons, const PictureMetrics& m, const Budgets& budgets)
{
    bool over = false;
    over |= breaks(reasons, "RMSE", m.rmse, budgets.rmse, false);
    over |= breaks(reasons, "relMSE", m.relmse, budgets.relmse, false);
    over |= breaks(reasons, "PSNR", m.psnr.value_or(HUGE_VAL), budgets.psnr, true);
    over |= breaks(reasons, "SSIM", m.ssim, budgets.ssim, true);
    over |= breaks(reasons, "FLIP", m.flip, budgets.flip, false);
    over |= breaks(reasons, "largest difference", m.max, budgets.max, false);
    over |= breaks(reasons, "mean relative difference", m.mean_relative, budgets.mean_relative, false);
    return over;
}

const char* channel_name(int channel)
{
    constexpr const char* kNames[] = {"red", "green", "blue"};
    return kNames[channel];
}

/// A constant pixel that differs is proof only where chance cannot have made both sides constant: two sides of one
/// distribution with n samples each do so with at most 4^-n, 2e-10 at 16.
constexpr std::uint64_t kSamplesThatProveConstancy = 16;

bool is_different(std::vector<std::string>& reasons, const StatisticalTest& test, std::uint64_t samples)
{
    for (const TileFinding& whole : test.whole)
        if (whole.p < test.level)
            reasons.push_back(fmt::format("the whole picture's {} differs by {:+.3g}% (z = {:+.2f})",
                                          channel_name(whole.channel), 100 * whole.relative, whole.z));
    if (!test.failures.empty()) {
        const TileFinding& tile = test.failures.front();
        reasons.push_back(fmt::format(
            "{} of {} tests fail; worst: tile at ({}, {}), {} differs by {:+.3g}% (z = {:+.2f}, p = {:.2g})",
            test.failed, test.tests, tile.x, tile.y, channel_name(tile.channel), 100 * tile.relative, tile.z, tile.p));
    }
    const bool constants_differ = test.constant_unequal > 0 && samples >= kSamplesThatProveConstancy;
    if (constants_differ)
        reasons.push_back(fmt::format("{} of {} channel values that both sides hold to be without variance differ",
                                      test.constant_unequal, test.constant));
    return test.failed > 0 || constants_differ;
}

}  // namespace

std::string_view name(Verdict verdict)
{
    switch (verdict) {
        case Verdict::not_tested:
            return "not tested";
        case Verdict::indistinguishable:
            return "indistinguishable";
        case Verdict::different:
            return "different";
        case Verdict::within_budget:
            return "within budget";
        case Verdict::over_budget:
            return "over budget";
        case Verdict::not_finite:
            return "not finite";
    }
    return "";
}

bool passed(Verdict verdict)
{
    return verdict != Verdict::different && verdict != Verdict::over_budget && verdict != Verdict::not_finite;
}

Comparison compare(const Film& a, const Film& b, const CompareSettings& settings)
{
    require_comparable(a, b, settings);
    Comparison result;
    result.check_a = check(a);
    result.check_b = check(b);
    result.metrics = picture_metrics(a, b);

    const bool over = over_budget(result.reasons, result.metrics, settings.budgets);
    if (settings.budgets.any()) result.verdict = over ? Verdict::over_budget : Verdict::within_budget;
    if (has_error(a) && has_error(b)) {
        result.test = welch_test(a, b, settings);
        // Replicates may well have the same mean without being constant (MC-10).
        const bool replicated = a.replicates > 0 || b.replicates > 0;
        if (is_different(result.reasons, *result.test, replicated ? 0 : std::min(a.samples, b.samples)))
            result.verdict = Verdict::different;
        else if (!over)
            result.verdict = Verdict::indistinguishable;
    }
    for (const auto& [checked, film, which] :
         {std::tuple{&result.check_a, &a, "A"}, std::tuple{&result.check_b, &b, "B"}}) {
        const std::uint64_t bad = checked->nan_pixels + checked->inf_pixels;
        if (bad > 0 || !finite_variance(*film)) {
            result.reasons.push_back(fmt::format("{} has {} NaN and {} Inf pixels{}", which, checked->nan_pixels,
                                                 checked->inf_pixels,
                                                 finite_variance(*film) ? "" : " and a variance that is not finite"));
            result.verdict = Verdict::not_finite;
        }
        if (checked->single_colour) result.reasons.push_back(fmt::format("{} is one single colour", which));
        if (film->nonfinite > 0)
            result.reasons.push_back(
                fmt::format("{} left out {} samples that were not finite", which, film->nonfinite));
    }
    return result;
}

}  // namespace etalon
