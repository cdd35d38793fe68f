#pragma once
#include <cstddef>
#include <span>
#include <vector>

#include "engine/image/film.h"

namespace etalon {

/// Repeated timings of one thing, seconds.
struct Timing {
    std::vector<double> seconds;  ///< in the order of the rounds

    double median() const;  ///< 0 without any
};

/// An interval for the median of the distribution that `values` were drawn from, by order statistics (binomial), with
/// at least `confidence` where there are enough of them; the whole range otherwise. `values` must not be empty.
struct MedianInterval {
    double low = 0;
    double high = 0;
    double confidence = 0;  ///< of this interval, exactly
};
MedianInterval median_interval(std::span<const double> values, double confidence = 0.95);

/// How far pictures are from a reference that has an error of its own.
struct ErrorMeasurement {
    double relmse = 0;  ///< mean over pixels and channels of (a - b)² / (b² + 0.01 mean(b)²), less `reference_share`;
                        ///< below 0 by chance where both are nearly equal
    double deviation = 0;        ///< standard error of relmse
    double reference_share = 0;  ///< what the reference's own noise adds to the raw figure, in expectation
    std::size_t pictures = 0;

    /// The reference's noise is at most a tenth of what is measured: the picture's own error dominates.
    bool resolved() const { return 10 * reference_share <= relmse; }
};

/// One picture against a reference with variance. For a value f(b) of a reference with a normal error of variance v,
/// E f = f + f'' v / 2 and Var f = f'² v + f''² v² / 2 to second order (the delta method): the first is taken off as
/// `reference_share`, the second makes `deviation`. Throws Error(input) when the sizes differ or the
/// reference has no variance.
ErrorMeasurement measure_error(const Film& film, const Film& reference);

/// Several pictures of the same settings, each with its own random numbers: mean, and the scatter joined to the
/// uncertainty that they share.
ErrorMeasurement mean_error(std::span<const ErrorMeasurement> pictures);

struct CostAndError {
    double seconds = 0;
    double error = 0;
};
/// For each point by how many others it is beaten in both (ties beat nobody): 0 is the frontier.
std::vector<std::size_t> times_beaten(std::span<const CostAndError> points);

}  // namespace etalon
