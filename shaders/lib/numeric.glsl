// Elementary functions whose accuracy is ours, not the driver's: lavapipe's atan and acos err by up to 1e-4, Vulkan allows
// sin and cos 2^-11. The polynomials are Chebyshev fits; their bounds are tested on the device (tests/gpu/path_lib_test.cpp).
#ifndef ETALON_LIB_NUMERIC_GLSL
#define ETALON_LIB_NUMERIC_GLSL

const float kPi = 3.14159265358979;
const float kMaxFloat = 3.402823466e38;

float max_component(vec3 v) { return max(v.x, max(v.y, v.z)); }
bool is_finite(float x) { return (floatBitsToUint(x) & 0x7f800000u) != 0x7f800000u; }
bool is_finite(vec3 v) { return is_finite(v.x) && is_finite(v.y) && is_finite(v.z); }

// The largest magnitude; as integers, which float maxima with their rules for NaN are dearer than on CPUs.
float largest_of(vec3 v)
{
    ivec3 bits = floatBitsToInt(v) & 0x7fffffff;
    return intBitsToFloat(max(bits.x, max(bits.y, bits.z)));
}

// The power of two that brings x to 1 … 2 (denormals to less): scaling by it is exact, and needs no division.
float inverse_scale(float x) { return intBitsToFloat(max(0x7f000000 - (floatBitsToInt(x) & 0x7f800000), 0x00800000)); }

// |v|, also where v·v would underflow or overflow (A3).
float robust_length(vec3 v)
{
    float largest = largest_of(v);
    float scale = inverse_scale(largest);
    vec3 unit = v * scale;
    return largest > 0.0 ? sqrt(dot(unit, unit)) / scale : 0.0;
}

// v / |v|; the zero vector stays zero (A3).
vec3 robust_normalize(vec3 v)
{
    float largest = largest_of(v);
    vec3 unit = v * inverse_scale(largest);
    return largest > 0.0 ? unit * (1.0 / sqrt(dot(unit, unit))) : vec3(0.0);
}

// (cos, sin) of 2π x for 0 ≤ x < 1; absolute error under 2e-7.
vec2 cos_sin_turns(float x)
{
    float quarter = floor(4.0 * x + 0.5);
    float r = x - 0.25 * quarter;
    float s = r * r;
    float sine = r * (6.28318548 + s * (-41.3417015 + s * (81.6052017 + s * (-76.6978683 + s * 41.4728317))));
    float cosine = 1.0 + s * (-19.7392082 + s * (64.9393921 + s * (-85.4567642 + s * (60.2381897 - s * 26.0582886))));
    int turn = int(quarter) & 3;
    vec2 swapped = (turn & 1) != 0 ? vec2(-sine, cosine) : vec2(cosine, sine);
    return (turn & 2) != 0 ? -swapped : swapped;
}

// atan(y, x) / 2π in [-1/2, 1/2]; absolute error under 1e-7, exact on the axes; 0 for (0, 0).
float atan_turns(float y, float x)
{
    float ay = abs(y);
    float ax = abs(x);
    float larger = max(ax, ay);
    float t = larger > 0.0 ? min(ax, ay) / larger : 0.0;
    float s = t * t;
    float p = t * (0.159154937 + s * (-0.0530515574 + s * (0.0318279266 + s * (-0.0226955209 + s * (0.0173993614 +
              s * (-0.0132889999 + s * (0.00908608455 + s * (-0.00483064912 + s * (0.00166916114 - s * 0.000270749617)))))))));
    float octant = ay > ax ? 0.25 - p : p;
    float half_turn = x < 0.0 ? 0.5 - octant : octant;
    return y < 0.0 ? -half_turn : half_turn;
}

// Linear value of an sRGB code 0 … 1 (TX-5); relative error of 8-bit codes under 4e-7, and 1 is 1 to the bit: white is
// no texture.
float decode_srgb(float code)
{
    float x = (code + 0.055) / 1.055;
    float q = sqrt(sqrt(max(x, 0.0)));
    float q16 = -0.00807046052 + q * (0.202608719 + q * (1.21822703 + q * (-0.770100176 + q * (0.592526793 +
                q * (-0.328908086 + q * (0.110342398 - q * 0.0166262221))))));
    return code <= 0.04045 ? code / 12.92 : x * x * q16;
}

vec3 decode_srgb(vec3 code) { return vec3(decode_srgb(code.x), decode_srgb(code.y), decode_srgb(code.z)); }

#endif
