#include "engine/image/develop.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>

#include "engine/base/error.h"
#include "engine/base/parallel.h"

namespace etalon {
namespace {

/// (IP-2)
double luminance(const dvec3& c)
{
    return 0.2126 * c.x + 0.7152 * c.y + 0.0722 * c.z;
}

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

/// L/(1 + L) of luminance L, hue and saturation kept (Reinhard et al. 2002, equation 3). Divided by the greater of 1
/// and L first: L itself may be as large as a double (I8).
dvec3 tone_reinhard(const dvec3& exposed)
{
    const double scale = std::max(1.0, std::max({exposed.x, exposed.y, exposed.z}));
    const dvec3 c = exposed / scale;
    return c / (1 / scale + luminance(c));
}

/// Troy Sobotka's AgX: log2 of light between -12.47 and 4.03 EV in narrowed primaries, Benjamin Wrensch's polynomial
/// for the curve of its default look, and back.
dvec3 tone_agx(const dvec3& exposed)
{
    const dmat3 rec2020_from_srgb(dvec3(0.6274, 0.0691, 0.0164), dvec3(0.3293, 0.9195, 0.0880),
                                  dvec3(0.0433, 0.0113, 0.8956));
    const dmat3 srgb_from_rec2020(dvec3(1.6605, -0.1246, -0.0182), dvec3(-0.5876, 1.1329, -0.1006),
                                  dvec3(-0.0728, -0.0083, 1.1187));
    const dmat3 inset(dvec3(0.856627153315983, 0.137318972929847, 0.11189821299995),
                      dvec3(0.0951212405381588, 0.761241990602591, 0.0767994186031903),
                      dvec3(0.0482516061458583, 0.101439036467562, 0.811302368396859));
    const dmat3 outset(dvec3(1.1271005818144368, -0.1413297634984383, -0.14132976349843826),
                       dvec3(-0.11060664309660323, 1.157823702216272, -0.11060664309660294),
                       dvec3(-0.016493938717834573, -0.016493938717834257, 1.2519364065950405));
    constexpr double kLeast = -12.47393, kMost = 4.026069;
    constexpr double kCurve[] = {-0.00232, 0.1191, 0.4298, -6.868, 31.96, -40.14, 15.5};
    dvec3 curved = inset * (rec2020_from_srgb * exposed);
    for (int c = 0; c < 3; ++c) {
        const double x = std::clamp((std::log2(std::max(curved[c], 1e-10)) - kLeast) / (kMost - kLeast), 0.0, 1.0);
        curved[c] = 0;
        for (auto factor = std::rbegin(kCurve); factor != std::rend(kCurve); ++factor)
            curved[c] = curved[c] * x + *factor;
    }
    dvec3 linear = outset * curved;
    for (int c = 0; c < 3; ++c) linear[c] = std::pow(std::max(linear[c], 0.0), 2.2);
    return srgb_from_rec2020 * linear;
}

void develop_pixel(const dvec3& radiance, double alpha, double factor, Tone tone, float* out)
{
    if (!is_finite(radiance) || !std::isfinite(alpha)) {
        std::copy_n(std::begin({1.0f, 0.0f, 1.0f, 1.0f}), 4, out);
        return;
    }
    const double coverage = std::clamp(alpha, 0.0, 1.0);
    // The film is premultiplied; a pixel without coverage has no colour to speak of beyond what it holds.
    const dvec3 color = coverage > 0 ? radiance / coverage : radiance;
    const dvec3 toned = apply_tone(tone, glm::max(color * factor, dvec3(0)));
    for (int c = 0; c < 3; ++c) out[c] = float(srgb_from_linear(std::clamp(toned[c], 0.0, 1.0)));
    out[3] = float(coverage);
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

double exposure_factor(double ev)
{
    if (!(std::abs(ev) <= 1000))
        throw Error(Blame::input, "the exposure must be a number of EV between -1000 and 1000");
    return ev == std::trunc(ev) ? std::ldexp(1.0, int(ev)) : std::exp2(ev);
}

dvec3 apply_tone(Tone tone, const dvec3& exposed)
{
    switch (tone) {
        case Tone::aces:
            return tone_aces(exposed);
        case Tone::neutral:
            return tone_neutral(exposed);
        case Tone::reinhard:
            return tone_reinhard(exposed);
        case Tone::agx:
            return tone_agx(exposed);
        case Tone::none:
            break;
    }
    return exposed;
}

double automatic_exposure(const Film& film)
{
    // Sixteen bins an octave, split evenly: scaling the light by a power of two moves every count alike.
    constexpr int kBins = 16;
    std::map<int, double> counts;  // by 16 · exponent + bin
    double total = 0;
    for (std::size_t i = 0; i < film.mean.size(); ++i) {
        const dvec3 radiance(film.mean[i]);
        if (!is_finite(radiance) || !std::isfinite(film.alpha[i])) continue;
        const double y = luminance(radiance);
        if (!(y >= double(std::numeric_limits<float>::min()))) continue;
        int exponent = 0;
        const double mantissa = 2 * std::frexp(y, &exponent);  // [1, 2)
        counts[kBins * (exponent - 1) + int((mantissa - 1) * kBins)] += 1;
        total += 1;
    }
    if (total == 0) return 0;
    const double low = 0.1 * total, high = 0.9 * total;
    double before = 0, sum = 0;
    for (const auto& [bin, count] : counts) {
        const int exponent = int(std::floor(bin / double(kBins)));
        const double middle = exponent + std::log2(1 + (bin - kBins * exponent + 0.5) / kBins);
        sum += middle * std::max(0.0, std::min(before + count, high) - std::max(before, low));
        before += count;
    }
    return std::clamp(std::log2(0.18) - sum / (high - low), -100.0, 100.0);
}

Image develop(const Film& film, const DevelopSettings& settings)
{
    assume(film.mean.size() == film.pixel_count() && film.alpha.size() == film.pixel_count());
    const double factor = exposure_factor(settings.exposure);
    Image image(film.width, film.height, 4);
    const auto row = [&](std::size_t y) {
        for (std::size_t i = y * std::size_t(film.width); i < (y + 1) * std::size_t(film.width); ++i)
            develop_pixel(dvec3(film.mean[i]), film.alpha[i], factor, settings.tone, &image.values[4 * i]);
    };
    parallel_for(std::size_t(film.height), row);
    return image;
}

}  // namespace etalon
