#pragma once
#include "engine/image/film.h"
#include "engine/image/image.h"

namespace etalon {

/// The curve between exposed radiance and the display's [0, 1].
enum class Tone { none, aces, neutral, reinhard, agx };

struct DevelopSettings {
    double exposure = 0;  ///< EV: radiance is multiplied by 2^exposure (exactly, by ldexp for whole EV)
    Tone tone = Tone::none;
};

/// Exposure, tone, clamp, then the sRGB transfer function (IEC 61966-2-1): 4 channels, unassociated alpha, in [0, 1].
/// Not finite pixels become magenta (1, 0, 1) and are counted by check(film).
Image develop(const Film& film, const DevelopSettings& settings);

/// Exposed radiance, each channel at least 0, by a tone curve (IP-15): `none` leaves it, `aces` is Stephen Hill's
/// RRT+ODT fit with exposure /0.6 as three.js has it, `neutral` Khronos PBR Neutral, `reinhard` Reinhard et al. 2002 on
/// luminance, `agx` Sobotka's AgX by Wrensch's polynomial with Rec.2020 primaries. Not clamped. Promise I8.
dvec3 apply_tone(Tone tone, const dvec3& exposed);

/// 2^ev; for whole EV a power of two, so that EV and -EV undo each other bit for bit (I9). Error(input) beyond ±1000.
double exposure_factor(double ev);

/// The EV that brings the mean of log luminance to 18% grey, without the darkest and the brightest tenth of the pixels
/// (IP-3), between -100 and 100. Pixels without light or not finite do not count; 0 when none is left. Promise I10.
double automatic_exposure(const Film& film);

/// The sRGB transfer function and its inverse, exact piecewise. Promise T10.
double srgb_from_linear(double linear);
double linear_from_srgb(double coded);

}  // namespace etalon
