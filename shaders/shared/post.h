// What each post pass is told (push constants), one definition for C++ and GLSL (scalar layout). Numbers in brackets
// are of docs/equations.md. An inverse of a width that is infinite is 0.
#ifndef ETALON_SHADERS_SHARED_POST_H
#define ETALON_SHADERS_SHARED_POST_H
#include "shaders/shared/types.h"
ETALON_SHARED_BEGIN

#ifndef __cplusplus
#define PostSize ivec2
#else
using PostSize = ivec2;
#endif

/// scale.comp: exposure (IP-3) and vignette (IP-4).
struct PostScale {
    PostSize size;  // of the picture, pixels; first in every block
    uint factor;    // index of the exposure's factor in the table
    float falloff;  // squared tangent at the corners
    uint squared;   // 1: of a variance, by the squares
};

/// histogram.comp and meter.comp: automatic exposure (IP-3).
struct PostMeter {
    PostSize size;
    uint factor;  // index in the table where meter.comp leaves it
};
ETALON_CONSTANT uint kPostBins = 4096u;         // of luminance: 16 an octave
ETALON_CONSTANT uint kPostBinShift = 19u;       // from the bits of a float to its bin
ETALON_CONSTANT float kPostMiddleGrey = 0.18f;  // what the mean of the middle is brought to
ETALON_CONSTANT float kPostTail = 0.1f;         // share of pixels left out at each end

/// gaussian.comp (IP-5): one axis.
struct PostGaussian {
    PostSize size;
    PostSize step;  // (1, 0) or (0, 1)
    int radius;
    uint kernel;  // index of the weight at distance 0 in the table; the others follow
};

/// median.comp (IP-6).
struct PostMedian {
    PostSize size;
    int radius;
};

/// bilateral.comp (IP-7): the whole window, or one axis of it (IP-8).
struct PostBilateral {
    PostSize size;
    PostSize reach;  // taps to each side
    float inverse_s;
    float inverse_r;
};

/// grid_splat.comp, grid_blur.comp and grid_slice.comp (IP-9).
struct PostGrid {
    PostSize size;
    PostSize cells;  // of the grid in x and y
    float spacing;   // pixels between cells
    float inverse_r;
    int axis;     // that grid_blur.comp blurs along: 0, 1, 2
    uint kernel;  // index of its weights in the table
};
ETALON_CONSTANT int kPostGridLevels = 32;  // cells along luminance
ETALON_CONSTANT int kPostGridRadius = 4;   // of the blur, cells

/// atrous.comp (IP-10): one level.
struct PostAtrous {
    PostSize size;
    int step;     // pixels between taps
    uint guided;  // 1: the width in luminance comes from the variance
    float inverse_c;
    float inverse_n;
    float inverse_z;
    float inverse_a;
};

/// variance.comp (IP-10): the variance of luminance from those of the channels.
struct PostVariance {
    PostSize size;
};

/// bright.comp and scatter.comp (IP-11).
struct PostBloom {
    PostSize size;
    float threshold;
    float share;  // of each Gaussian
};

/// sobel.comp (IP-12).
struct PostSobel {
    PostSize size;
    float gain;
};

/// outline.comp (IP-13).
struct PostOutline {
    PostSize size;
    float inverse_depth;
    float inverse_normal;
    float strength;
};

/// fxaa.comp (IP-14).
struct PostFxaa {
    PostSize size;
    float threshold;
    float least;
    float subpixel;
    int reach;
};

/// tone.comp (IP-15).
struct PostTone {
    PostSize size;
    uint curve;  // of enum class Tone
};

ETALON_SHARED_END
#endif
