#pragma once
#include <algorithm>
#include <cmath>
#include <optional>

#include "engine/base/error.h"
#include "engine/math/types.h"

namespace etalon {

// Elementary operations in the form that keeps its accuracy at the extremes: promises A1-A6, G28, G34. In double; the
// device has its own (shaders/lib), and the reference its own again.

/// a·b − c·d within 2u, however much of it cancels (Kahan; Jeannerod et al. 2013). A1.
inline double difference_of_products(double a, double b, double c, double d)
{
    const double cd = c * d;
    const double error = std::fma(-c, d, cd);  // exactly what rounding took from cd
    return std::fma(a, b, -cd) + error;
}

/// The cross product by A1: nearly parallel vectors keep their digits.
inline dvec3 robust_cross(const dvec3& a, const dvec3& b)
{
    return dvec3(difference_of_products(a.y, b.z, a.z, b.y), difference_of_products(a.z, b.x, a.x, b.z),
                 difference_of_products(a.x, b.y, a.y, b.x));
}

/// From `a` (x = 0) to `b` (x = 1), x in [0, 1]: exact at both ends and for a = b, monotone, never outside. A2.
inline double lerp(double a, double b, double x)
{
    const double d = b - a;
    return x < 0.5 ? a + x * d : b - (1 - x) * d;
}

/// ‖v‖ without overflow or underflow on the way: scaling v by 2^k scales the result by 2^k, bit for bit. A3.
double robust_length(const dvec3& v);
/// v/‖v‖; nothing for 0 and for what is not finite. A3.
std::optional<dvec3> unit(const dvec3& v);

/// √x of an x that is ≥ 0 but for rounding (10⁻⁴ at most, anything below is our bug). A4.
inline double safe_sqrt(double x)
{
    assume(x >= -1e-4);
    return std::sqrt(std::max(0.0, x));
}
/// acos x of an x that is in [−1, 1] but for rounding. A4.
inline double safe_acos(double x)
{
    assume(std::abs(x) <= 1 + 1e-4);
    return std::acos(std::clamp(x, -1.0, 1.0));
}

/// The angle between two unit vectors, 0 … π, to a few ulp also where it is tiny or near π (Kahan). A5.
double angle_between(const dvec3& a, const dvec3& b);

/// Real solutions of a t² + b t + c = 0, first <= second; one of a linear equation or a double root is given twice;
/// nothing where there is none or where every t would do. A6.
struct Roots {
    double first = 0;
    double second = 0;
};
std::optional<Roots> solve_quadratic(double a, double b, double c);

/// Two tangents of a unit normal, orthonormal to 4u all over the sphere (Duff et al. 2017). G34.
struct Tangents {
    dvec3 t{0};
    dvec3 b{0};
};
Tangents tangents_of(const dvec3& normal);

}  // namespace etalon
