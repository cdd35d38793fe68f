#pragma once
#include "engine/image/film.h"
#include "engine/image/image.h"

namespace etalon {

/// The curve between exposed radiance and the display's [0, 1].
enum class Tone { none, aces, neutral };

struct DevelopSettings {
    double exposure = 0;  ///< EV: radiance is multiplied by 2^exposure (exactly, by ldexp for whole EV)
    Tone tone = Tone::none;
};

/// Exposure, tone, clamp, then the sRGB transfer function (IEC 61966-2-1): 4 channels, unassociated alpha, in [0, 1].
/// Tone curves: `none` clamps; `aces` is Stephen Hill's RRT+ODT fit with exposure /0.6 as three.js has it; `neutral` is
/// Khronos PBR Neutral. Not finite pixels become magenta (1, 0, 1) and are counted by check(film).
Image develop(const Film& film, const DevelopSettings& settings);

/// The sRGB transfer function and its inverse, exact piecewise. Promise T10.
double srgb_from_linear(double linear);
double linear_from_srgb(double coded);

}  // namespace etalon
