#include "engine/math/robust.h"

#include <gmock/gmock.h>

#include <random>

#include "tests/support/nasty.h"
#include "tests/support/ulp.h"

namespace etalon {
namespace {

using test::same_bits;
using test::ulp_distance;
using test::WithinUlp;

using Wide = long double;  // 64 bits of significand: exact products of floats, 11 guard bits for doubles

TEST(Robust, A1_difference_of_products_keeps_two_units_where_the_plain_form_loses_all)
{
    // Integers of 2^53 scale whose products differ late: the truth in 128-bit integers.
    std::mt19937_64 random(1);
    double worst_plain = 0;
    for (int i = 0; i < 100000; ++i) {
        const auto a = std::int64_t(random() >> 12), b = std::int64_t(random() >> 12);
        const std::int64_t c = a + std::int64_t(random() % 5) - 2, d = b + std::int64_t(random() % 5) - 2;
        __extension__ typedef __int128 Int128;
        const Int128 truth = Int128(a) * b - Int128(c) * d;
        const double computed = difference_of_products(double(a), double(b), double(c), double(d));
        if (truth == 0) {
            ASSERT_EQ(computed, 0);
            continue;
        }
        ASSERT_LE(std::abs(computed / double(truth) - 1), 3e-16) << a << ' ' << b << ' ' << c << ' ' << d;
        worst_plain =
            std::max(worst_plain, std::abs((double(a) * double(b) - double(c) * double(d)) / double(truth) - 1));
    }
    EXPECT_GT(worst_plain, 1e-3) << "the exhibit should have failed";
}

TEST(Robust, A2_lerp_is_exact_at_the_ends_monotone_and_inside)
{
    EXPECT_EQ(1 + 1.0 * (1e17 - 1), 1e17);
    std::mt19937_64 random(2);
    std::uniform_real_distribution<double> exponent(-100, 100), unit_interval(0, 1);
    for (int i = 0; i < 100000; ++i) {
        const double a = std::ldexp(unit_interval(random) - 0.5, int(exponent(random)));
        const double b = std::ldexp(unit_interval(random) - 0.5, int(exponent(random)));
        const double x = unit_interval(random);
        ASSERT_EQ(lerp(a, b, 0), a);
        ASSERT_EQ(lerp(a, b, 1), b);
        ASSERT_EQ(lerp(a, a, x), a);
        const double value = lerp(a, b, x), next = lerp(a, b, std::nextafter(x, 1));
        ASSERT_TRUE(std::min(a, b) <= value && value <= std::max(a, b));
        ASSERT_TRUE(a < b ? value <= next : value >= next);
    }
}

TEST(Robust, A3_length_and_unit_hold_from_one_denormal_to_the_largest)
{
    const dvec3 v(0.3, -0.7, 0.648);
    const double length_1 = robust_length(v);
    for (const int k : {-1000, -300, -1, 1, 300, 1000}) {
        const dvec3 scaled(std::ldexp(v.x, k), std::ldexp(v.y, k), std::ldexp(v.z, k));
        EXPECT_TRUE(same_bits(robust_length(scaled), std::ldexp(length_1, k))) << k;
        EXPECT_EQ(unit(scaled), unit(v)) << k;
    }
    EXPECT_EQ(std::sqrt(dot(v * 1e-200, v * 1e-200)), 0) << "the plain form vanishes";
    EXPECT_EQ(robust_length(dvec3(5e-324, 0, 0)), 5e-324);
    EXPECT_EQ(robust_length(dvec3(3e300, 4e300, 0)), 5e300);
    EXPECT_EQ(robust_length(dvec3(0)), 0);
    EXPECT_EQ(robust_length(dvec3(1, -INFINITY, 0)), INFINITY);
    EXPECT_TRUE(std::isnan(robust_length(dvec3(1, NAN, 0))));
}

TEST(Robust, A3_unit_of_every_nasty_vector_is_unit_or_nothing)
{
    for (const auto& [why, x] : nasty::scalars<double>())
        for (const auto& [why_y, y] : nasty::scalars<double>()) {
            const dvec3 v(x, y, -x);
            const std::optional<dvec3> u = unit(v);
            ASSERT_EQ(u.has_value(), is_finite(v) && v != dvec3(0)) << why << ", " << why_y;
            if (u) {
                ASSERT_NEAR(dot(*u, *u), 1, 4e-16) << why << ", " << why_y;
            }
        }
}

TEST(Robust, A4_rounding_dust_gives_no_nan)
{
    for (int ulps = 0; ulps <= 8; ++ulps) {
        const double cosine = 1 + ulps * 2.220446049250313e-16;
        EXPECT_EQ(safe_acos(cosine), 0);
        EXPECT_EQ(safe_acos(-cosine), kPi);
        EXPECT_EQ(safe_sqrt(1 - cosine * cosine), 0);
    }
    EXPECT_EQ(safe_sqrt(4), 2);
    EXPECT_EQ(safe_acos(0), kPi / 2);
}

TEST(RobustDeathTest, A4_more_than_dust_is_our_bug)
{
    GTEST_FLAG_SET(death_test_style, "threadsafe");
    EXPECT_DEATH(safe_sqrt(-0.01), "assumption broken");
    EXPECT_DEATH(safe_acos(1.01), "assumption broken");
    EXPECT_DEATH(safe_acos(NAN), "assumption broken");
}

TEST(Robust, A5_angles_are_right_from_tiny_to_nearly_opposite)
{
    for (double angle = 1e-20; angle < kPi; angle *= 3) {
        const dvec3 a(1, 0, 0), b(std::cos(angle), std::sin(angle), 0);
        EXPECT_THAT(angle_between(a, b), WithinUlp(angle, 6)) << angle;
        EXPECT_NEAR(angle_between(a, -b), kPi - angle, 1e-15) << angle;
    }
    const double plain = std::acos(std::cos(1e-9));
    EXPECT_GT(std::abs(plain / 1e-9 - 1), 0.1) << "the exhibit should have failed";
    EXPECT_EQ(angle_between(dvec3(0, 1, 0), dvec3(0, 1, 0)), 0);
    EXPECT_DOUBLE_EQ(angle_between(dvec3(0, 1, 0), dvec3(0, -1, 0)), kPi);
}

TEST(Robust, A6_quadratics_solve_their_equation)
{
    std::mt19937_64 random(3);
    std::uniform_real_distribution<double> mantissa(-1, 1), exponent(-15, 15);
    int solved = 0;
    for (int i = 0; i < 100000; ++i) {
        const double a = mantissa(random) * std::pow(10, exponent(random)),
                     b = mantissa(random) * std::pow(10, exponent(random)),
                     c = mantissa(random) * std::pow(10, exponent(random));
        const std::optional<Roots> roots = solve_quadratic(a, b, c);
        if (!roots) {
            ASSERT_LT(Wide(b) * b - 4 * Wide(a) * c, 0);
            continue;
        }
        ++solved;
        ASSERT_LE(roots->first, roots->second);
        for (const double t : {roots->first, roots->second}) {
            const Wide residual = (Wide(a) * t + b) * t + c;
            const Wide size = std::abs(Wide(a) * t * t) + std::abs(Wide(b) * t) + std::abs(Wide(c));
            ASSERT_LE(std::abs(residual), 1e-15L * size) << a << ' ' << b << ' ' << c;
        }
    }
    EXPECT_GT(solved, 50000);
}

TEST(Robust, A6_degenerate_quadratics)
{
    const auto roots = [](double a, double b, double c) {
        const std::optional<Roots> r = solve_quadratic(a, b, c);
        return r ? std::vector{r->first, r->second} : std::vector<double>{};
    };
    using ::testing::ElementsAre;
    using ::testing::IsEmpty;
    EXPECT_THAT(roots(0, 2, -4), ElementsAre(2, 2));
    EXPECT_THAT(roots(0, 0, 1), IsEmpty());
    EXPECT_THAT(roots(0, 0, 0), IsEmpty());
    EXPECT_THAT(roots(1, 0, 0), ElementsAre(0, 0));
    EXPECT_THAT(roots(1, 0, 1), IsEmpty());
    EXPECT_THAT(roots(1, -2, 1), ElementsAre(1, 1));
    EXPECT_THAT(roots(-1, 0, 4), ElementsAre(-2, 2));
    EXPECT_THAT(roots(1, NAN, 1), IsEmpty());
    // 1e8: the small root cancels to 1.49e-8 in the plain form, an error of 49%.
    EXPECT_DOUBLE_EQ(roots(1, -1e8, 1).front(), 1e-8);
}

void expect_orthonormal(const dvec3& n, const char* why)
{
    constexpr double kFourUlp = 4 * 2.22e-16;
    const auto [t, b] = tangents_of(n);
    EXPECT_NEAR(dot(t, t), 1, kFourUlp) << why;
    EXPECT_NEAR(dot(b, b), 1, kFourUlp) << why;
    EXPECT_NEAR(dot(t, b), 0, kFourUlp) << why;
    EXPECT_NEAR(dot(t, n), 0, kFourUlp) << why;
    EXPECT_NEAR(dot(b, n), 0, kFourUlp) << why;
    EXPECT_NEAR(dot(cross(t, b), n), 1, kFourUlp) << why;
}

TEST(Robust, G34_tangents_are_orthonormal_all_over_the_sphere)
{
    for (const auto& [why, n] : nasty::unit_vectors()) expect_orthonormal(n, why);
    std::mt19937_64 random(4);
    std::normal_distribution<double> normal;
    for (int i = 0; i < 20000; ++i)
        expect_orthonormal(*unit(dvec3(normal(random), normal(random), normal(random))), "random");
}

}  // namespace
}  // namespace etalon
