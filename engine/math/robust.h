#pragma once
#include <cmath>

#include "engine/math/types.h"

namespace etalon {

// Elementary operations in the form that keeps its accuracy at the extremes: promises A1, A3 and A5. In double; the
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

/// ‖v‖ without overflow or underflow on the way: scaling v by 2^k scales the result by 2^k, bit for bit. A3.
double robust_length(const dvec3& v);

/// The angle between two unit vectors, 0 … π, to a few ulp also where it is tiny or near π (Kahan). A5.
double angle_between(const dvec3& a, const dvec3& b);

}  // namespace etalon
