#include "engine/math/stats.h"

#include <gmock/gmock.h>

#include <cmath>
#include <limits>
#include <vector>

#include "engine/math/types.h"
#include "tests/support/ulp.h"

namespace etalon {
namespace {

using test::WithinUlp;

constexpr double kInfinity = std::numeric_limits<double>::infinity();

/// |value / expected - 1|
double relative_error(double value, double expected)
{
    return std::abs(value / expected - 1);
}

TEST(Stats, K8_normal_tail_is_right_where_one_minus_phi_is_zero)
{
    // From the continued fraction of Mills' ratio with 50 digits.
    EXPECT_THAT(normal_tail(10), WithinUlp(7.6198530241605261e-24, 4));
    EXPECT_THAT(normal_tail(30), WithinUlp(4.9067139271481871e-198, 4));
    EXPECT_EQ(1 - 0.5 * std::erfc(-10 / std::sqrt(2.0)), 0) << "the naive form has nothing left at z = 10";
    EXPECT_LT(relative_error(normal_two_sided_p(1.9599639845400543), 0.05), 1e-14);
    EXPECT_EQ(normal_two_sided_p(0), 1);
}

TEST(Stats, K8_logarithm_of_the_tail_falls_all_the_way_to_a_thousand_sigma)
{
    double last = log_normal_tail(0);
    EXPECT_THAT(last, WithinUlp(std::log(0.5), 1));
    for (double z = 0.01; z <= 1000; z += 0.01) {
        const double now = log_normal_tail(z);
        ASSERT_LT(now, last) << z;
        last = now;
    }
    // Mills: φ(z)(1/z - 1/z³) < tail < φ(z)/z.
    const double log_density = -0.5e6 - 0.5 * std::log(2 * kPi);
    EXPECT_LT(last, log_density - std::log(1000));
    EXPECT_GT(last, log_density - std::log(1000) + std::log1p(-1.1e-6));
    EXPECT_EQ(log_normal_tail(kInfinity), -kInfinity);
    EXPECT_TRUE(std::isnan(log_normal_tail(NAN)));
}

TEST(Stats, log_tail_is_seamless_where_the_series_takes_over)
{
    const double below = std::nextafter(30.0, 0), above = std::nextafter(30.0, 31);
    EXPECT_NEAR(log_normal_tail(below), log_normal_tail(above), 1e-11);
}

TEST(Stats, normal_quantile_undoes_the_tail)
{
    for (const double p : {1e-300, 1e-100, 1e-12, 0.001, 0.025, 0.3, 0.4999})
        EXPECT_LT(relative_error(normal_tail(-normal_quantile(p)), p), 1e-11) << p;
    EXPECT_EQ(normal_quantile(0.5), 0);
    EXPECT_NEAR(normal_quantile(0.975), -normal_quantile(0.025), 1e-15);
    EXPECT_EQ(normal_quantile(0), -kInfinity);
    EXPECT_EQ(normal_quantile(1), kInfinity);
    EXPECT_TRUE(std::isnan(normal_quantile(-0.1)));
    EXPECT_TRUE(std::isnan(normal_quantile(NAN)));
}

/// P(|T| > t) in closed form for 1 … 4 degrees of freedom (Abramowitz & Stegun 26.7.3, 26.7.4).
double closed_student(double t, int dof)
{
    const double theta = std::atan2(std::sqrt(dof), t);  // the complement of atan(t/√dof), so that tails do not cancel
    switch (dof) {
        case 1:
            return 2 * theta / kPi;
        case 2:
            return 2 / (t * t + 2 + t * std::sqrt(t * t + 2));
        case 3:
            return 2 * (theta - std::sin(theta) * std::cos(theta)) / kPi;
        default: {
            const double s = t / std::sqrt(t * t + 4), rest = 4 / (t * t + 4) / (1 + s);  // 1 - s
            return rest * (1 - 0.5 * s * (1 - s * s) / rest);
        }
    }
}

TEST(Stats, student_p_equals_its_closed_forms)
{
    for (int dof = 1; dof <= 4; ++dof)
        for (const double t : {1e-6, 0.01, 0.5, 1.0, 3.0, 12.0, 40.0})
            EXPECT_LT(relative_error(student_two_sided_p(t, dof), closed_student(t, dof)), 1e-9)
                << dof << " dof, t = " << t;
    EXPECT_EQ(student_two_sided_p(-2, 7), student_two_sided_p(2, 7));
    EXPECT_EQ(student_two_sided_p(0, 3), 1);
    EXPECT_EQ(student_two_sided_p(kInfinity, 3), 0);
    EXPECT_THAT(student_two_sided_p(2, kInfinity), WithinUlp(normal_two_sided_p(2), 8));
    EXPECT_TRUE(std::isnan(student_two_sided_p(NAN, 3)));
    EXPECT_TRUE(std::isnan(student_two_sided_p(1, 0)));
    EXPECT_TRUE(std::isnan(student_two_sided_p(1, NAN)));
}

TEST(Stats, student_tends_to_the_normal_without_a_seam)
{
    for (const double t : {0.5, 2.0, 6.0}) {
        double last = student_two_sided_p(t, 1);
        for (double dof = 2; dof < 1e12; dof *= 1.7) {
            const double now = student_two_sided_p(t, dof);
            EXPECT_LE(now, last * (1 + 1e-9)) << "t = " << t << ", " << dof << " dof";
            last = now;
        }
        EXPECT_LT(relative_error(last, normal_two_sided_p(t)), 1e-8) << t;
        EXPECT_LT(relative_error(student_two_sided_p(t, 0.999e7), student_two_sided_p(t, 1.001e7)), 1e-7) << t;
    }
}

TEST(Stats, student_tails_have_logarithms_where_they_underflow)
{
    EXPECT_EQ(student_two_sided_p(1e5, 300), 0);
    const double log_p = log_student_two_sided_p(1e5, 300);
    EXPECT_TRUE(std::isfinite(log_p));
    EXPECT_LT(log_p, std::log(1e-308));
    // Far out the tail falls as t^-dof.
    EXPECT_NEAR(log_student_two_sided_p(1e6, 300) - log_p, -300 * std::log(10.0), 1e-3);
    EXPECT_TRUE(std::isfinite(log_student_two_sided_p(1e200, 5)));
}

TEST(Stats, student_quantile_undoes_p)
{
    for (const double dof : {1.0, 2.5, 30.0, 1e4, kInfinity})
        for (const double p : {0.6, 0.975, 0.9999})
            EXPECT_LT(relative_error(student_two_sided_p(student_quantile(p, dof), dof), 2 * (1 - p)), 1e-9)
                << p << ' ' << dof;
    EXPECT_LT(relative_error(student_quantile(0.975, 1), std::tan(0.475 * kPi)), 1e-12);
    EXPECT_EQ(student_quantile(0.5, 5), 0);
    EXPECT_EQ(student_quantile(0.1, 5), -student_quantile(0.9, 5));
    EXPECT_EQ(student_quantile(0, 5), -kInfinity);
    EXPECT_TRUE(std::isnan(student_quantile(2, 5)));
}

TEST(Stats, welch_degrees_of_freedom)
{
    EXPECT_DOUBLE_EQ(welch_dof(1, 10, 1, 10), 20);            // equal halves add up
    EXPECT_DOUBLE_EQ(welch_dof(3, 10, 0, 4), 10);             // an exact side adds nothing
    EXPECT_DOUBLE_EQ(welch_dof(3e-200, 10, 3e-200, 10), 20);  // squares would vanish
    EXPECT_DOUBLE_EQ(welch_dof(3e200, 10, 3e200, 10), 20);    // … or overflow
    EXPECT_EQ(welch_dof(0, 10, 0, 10), kInfinity);
    EXPECT_EQ(welch_dof(1, kInfinity, 1, kInfinity), kInfinity);
}

TEST(Stats, K7_sidak_level_does_not_vanish)
{
    const double naive = 1 - std::pow(1 - 0.01, 1 / 1e17);
    EXPECT_EQ(naive, 0);
    for (const double tests : {1.0, 100.0, 1e6, 1e10, 1e17}) {
        const double level = sidak_level(0.01, tests);
        EXPECT_LT(relative_error(std::expm1(tests * std::log1p(-level)), -0.01), 1e-12) << tests;
        EXPECT_LT(relative_error(level, 0.01 / tests), 0.03) << "Bonferroni";
    }
    EXPECT_EQ(sidak_level(0, 5), 0);
}

TEST(Stats, chi_square_p_equals_its_closed_forms)
{
    for (const double x : {1e-6, 0.5, 2.0, 10.0, 100.0, 700.0}) {
        EXPECT_LT(relative_error(chi_square_p(x, 1), std::erfc(std::sqrt(x / 2))), 1e-11) << x;
        EXPECT_LT(relative_error(chi_square_p(x, 2), std::exp(-x / 2)), 1e-11) << x;
        EXPECT_LT(relative_error(chi_square_p(x, 4), std::exp(-x / 2) * (1 + x / 2)), 1e-11) << x;
    }
    EXPECT_NEAR(chi_square_p(1e6, 1e6), 0.5, 1e-3);
    EXPECT_EQ(chi_square_p(0, 3), 1);
    EXPECT_EQ(chi_square_p(-1, 3), 1);
    EXPECT_EQ(chi_square_p(kInfinity, 3), 0);
    EXPECT_TRUE(std::isnan(chi_square_p(NAN, 3)));
}

TEST(Stats, ks_tells_uniform_values_from_others)
{
    std::vector<double> even, squared;
    for (int i = 0; i < 1000; ++i) {
        even.push_back((i * 617 % 1000 + 0.5) / 1000);
        squared.push_back(even.back() * even.back());
    }
    EXPECT_GT(ks_uniform_p(even), 0.999);
    EXPECT_LT(ks_uniform_p(squared), 1e-30);
    EXPECT_EQ(ks_uniform_p({}), 1);
    // Kolmogorov's 5% point of n = 100 is 0.13403 (Miller 1956): a distribution shifted by that much.
    std::vector<double> shifted;
    for (int i = 0; i < 100; ++i) shifted.push_back(std::min(1.0, (i + 0.5) / 100 + 0.13403 - 0.005));
    EXPECT_NEAR(ks_uniform_p(shifted), 0.05, 0.002);
}

TEST(Stats, binomial_tail_and_interval)
{
    EXPECT_NEAR(binomial_upper_tail(5, 10, 0.5), 638.0 / 1024, 1e-13);
    EXPECT_EQ(binomial_upper_tail(0, 10, 0.5), 1);
    EXPECT_EQ(binomial_upper_tail(11, 10, 0.5), 0);
    EXPECT_EQ(binomial_upper_tail(3, 10, 0), 0);
    EXPECT_EQ(binomial_upper_tail(3, 10, 1), 1);
    EXPECT_LT(relative_error(binomial_upper_tail(10, 10, 1e-9), 1e-90), 1e-11);

    const Interval none = binomial_interval(0, 10, 0.95);
    EXPECT_EQ(none.low, 0);
    EXPECT_NEAR(none.high, 1 - std::pow(0.025, 0.1), 1e-12);
    const Interval all = binomial_interval(10, 10, 0.95);
    EXPECT_NEAR(all.low, std::pow(0.025, 0.1), 1e-12);
    EXPECT_EQ(all.high, 1);
    const Interval some = binomial_interval(300, 1000000, 0.999);
    EXPECT_NEAR(binomial_upper_tail(300, 1000000, some.low), 0.0005, 1e-8);
    EXPECT_NEAR(1 - binomial_upper_tail(301, 1000000, some.high), 0.0005, 1e-8);
}

}  // namespace
}  // namespace etalon
