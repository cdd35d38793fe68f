#pragma once
#include <cstdint>
#include <span>

namespace etalon {

// Tails and levels for the tests that decide whether two pictures are the same (ST-1 … ST-4). Tails are computed as
// tails, never as 1 - Φ, and their logarithms (natural) stay finite where the probability itself has underflowed (K8).
// NaN in, NaN out. Degrees of freedom ("dof") are > 0 and may be fractional or +Inf (then the normal distribution).

/// P(Z > z) of a standard normal Z.
double normal_tail(double z);
double log_normal_tail(double z);
/// P(|Z| > |z|).
double normal_two_sided_p(double z);
double log_normal_two_sided_p(double z);
/// The z for which P(Z < z) = p, p in [0, 1]; ±Inf at the ends.
double normal_quantile(double p);

/// P(|T| > |t|) of Student's t.
double student_two_sided_p(double t, double dof);
double log_student_two_sided_p(double t, double dof);
/// The normal deviate of t's probability, for statements of scatter: t itself has no variance where its degrees of
/// freedom are few. From 30 of them on t as it is.
double standard_score(double t, double dof);
/// The t for which P(T < t) = p, p in [0, 1].
double student_quantile(double p, double dof);
/// Welch & Satterthwaite: degrees of freedom of a difference of two means whose variances (of the mean) are
/// `variance_a` and `variance_b`. +Inf when both are 0.
double welch_dof(double variance_a, double dof_a, double variance_b, double dof_b);

/// The level of each of `tests` ≥ 1 independent tests for which the chance of any false alarm is `family`, in [0, 1).
/// Šidák 1967, by expm1 and log1p: the plain form is 0 for 10⁸ tests (K7).
double sidak_level(double family, double tests);

/// P(X > statistic) of a χ² with `dof` degrees of freedom.
double chi_square_p(double statistic, double dof);

/// Two-sided Kolmogorov-Smirnov p-value of `values` (any order, each in [0, 1]) against the uniform distribution; 1 for
/// none. Asymptotic with Stephens' 1970 correction: good to 1% of p for 10 values or more.
double ks_uniform_p(std::span<const double> values);

struct Interval {
    double low = 0;
    double high = 0;
};
/// Where the success probability lies after `successes` of `trials`, with at least `confidence` in (0, 1): Clopper &
/// Pearson 1934.
Interval binomial_interval(std::uint64_t successes, std::uint64_t trials, double confidence);
/// P(X ≥ successes) for `trials` of probability p.
double binomial_upper_tail(std::uint64_t successes, std::uint64_t trials, double p);

}  // namespace etalon
