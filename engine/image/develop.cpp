#include "engine/image/develop.h"

#include <algorithm>
#include <cmath>

#include "engine/base/error.h"

namespace etalon {
namespace {

/// (x (x + a) - b) / (x (c x + d) + e), Stephen Hill's fit of the ACES reference and output transforms. Above 1
/// numerator and denominator are divided by x² first: x·x would be Inf/Inf from 1e154 on (I8).
double aces_curve(double x)
{
    constexpr double kA = 0.0245786, kB = 0.000090537, kC = 0.983729, kD = 0.4329510, kE = 0.238081;
    if (x <= 1) return (x * (x + kA) - kB) / (x * (kC * x + kD) + kE);
    const double r = 1 / x;
    return (1 + r * (kA - r * kB)) / (kC + r * (kD + r * kE));
}

dvec3 tone_aces(const dvec3& exposed)
{
    // Columns; each row of the sRGB -> ACES direction sums to 1, so that white stays white.
    constexpr double kMiddleGrey = 0.6;
    const dmat3 aces_from_srgb(dvec3(0.59719, 0.07600, 0.02840), dvec3(0.35458, 0.90834, 0.13383),
                               dvec3(0.04823, 0.01566, 0.83777));
    const dmat3 srgb_from_aces(dvec3(1.60475, -0.10208, -0.00327), dvec3(-0.53108, 1.10813, -0.07276),
                               dvec3(-0.07367, -0.00605, 1.07602));
    const dvec3 v = aces_from_srgb * (exposed / kMiddleGrey);
    return srgb_from_aces * dvec3(aces_curve(v.x), aces_curve(v.y), aces_curve(v.z));
}

/// Khronos PBR Neutral (2024): colours below 0.8 only lose their 4% of Fresnel; above, the peak is compressed and then
/// desaturated.
dvec3 tone_neutral(const dvec3& exposed)
{
    constexpr double kFresnel = 0.04, kStart = 0.8 - kFresnel, kDesaturation = 0.15;
    const double least = std::min({exposed.x, exposed.y, exposed.z});
    const double offset = least < 2 * kFresnel ? least - least * least / (4 * kFresnel) : kFresnel;
    const dvec3 color = exposed - offset;
    const double peak = std::max({color.x, color.y, color.z});
    if (peak < kStart) return color;
    const double room = 1 - kStart;
    const double compressed = 1 - room * room / (peak + room - kStart);
    const double to_white = 1 - 1 / (kDesaturation * (peak - compressed) + 1);
    return color * (compressed / peak) * (1 - to_white) + dvec3(compressed) * to_white;
}

dvec3 apply(Tone tone, const dvec3& exposed)
{
    switch (tone) {
        case Tone::aces:
            return tone_aces(exposed);
        case Tone::neutral:
            return tone_neutral(exposed);
        case Tone::none:
            break;
    }
    return exposed;
}

/// 2^EV; for whole EV a power of two, so that EV and -EV undo each other bit for bit (I9).
double exposure_factor(double ev)
{
    if (!(std::abs(ev) <= 1000))
        throw Error(Blame::input, "the exposure must be a number of EV between -1000 and 1000");
    return ev == std::trunc(ev) ? std::ldexp(1.0, int(ev)) : std::exp2(ev);
}

}  // namespace

double srgb_from_linear(double linear)
{
    if (linear < 0) return -srgb_from_linear(-linear);
    return linear <= 0.0031308 ? 12.92 * linear : 1.055 * std::pow(linear, 1 / 2.4) - 0.055;
}

double linear_from_srgb(double coded)
{
    if (coded < 0) return -linear_from_srgb(-coded);
    return coded <= 0.04045 ? coded / 12.92 : std::pow((coded + 0.055) / 1.055, 2.4);
}

Image develop(const Film& film, const DevelopSettings& settings)
{
    assume(film.mean.size() == film.pixel_count() && film.alpha.size() == film.pixel_count());
    const double factor = exposure_factor(settings.exposure);
    Image image(film.width, film.height, 4);
    for (std::size_t i = 0; i < film.mean.size(); ++i) {
        float* pixel = &image.values[4 * i];
        const dvec3 radiance(film.mean[i]);
        const auto alpha = double(film.alpha[i]);
        if (!is_finite(radiance) || !std::isfinite(alpha)) {
            std::copy_n(std::begin({1.0f, 0.0f, 1.0f, 1.0f}), 4, pixel);
            continue;
        }
        const double coverage = std::clamp(alpha, 0.0, 1.0);
        // The film is premultiplied; a pixel without coverage has no colour to speak of beyond what it holds.
        const dvec3 color = coverage > 0 ? radiance / coverage : radiance;
        const dvec3 toned = apply(settings.tone, glm::max(color * factor, dvec3(0)));
        for (int c = 0; c < 3; ++c) pixel[c] = float(srgb_from_linear(std::clamp(toned[c], 0.0, 1.0)));
        pixel[3] = float(coverage);
    }
    return image;
}

}  // namespace etalon
