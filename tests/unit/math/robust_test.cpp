#include "engine/math/robust.h"

#include <gmock/gmock.h>

#include <random>
#include <string>

#include "tests/support/nasty.h"
#include "tests/support/ulp.h"

namespace etalon {
namespace {

using test::same_bits;
using test::WithinUlp;

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

TEST(Robust, G12_normals_of_nasty_triangles_are_square_to_their_edges_or_nothing)
{
    for (const auto& [why, p] : nasty::triangles()) {
        const dvec3 ab = dvec3(p[1]) - dvec3(p[0]), ac = dvec3(p[2]) - dvec3(p[0]);
        const dvec3 normal = robust_cross(ab, ac);
        const bool degenerate = p[0] == p[1] || p[1] == p[2] || std::string(why) == "collinear";
        EXPECT_EQ(robust_length(normal) == 0, degenerate) << why;
        const double bound = 4e-16 * robust_length(normal);
        EXPECT_LE(std::abs(dot(normal, ab)), bound * robust_length(ab)) << why;
        EXPECT_LE(std::abs(dot(normal, ac)), bound * robust_length(ac)) << why;
    }
}

TEST(Robust, A3_length_holds_from_one_denormal_to_the_largest)
{
    const dvec3 v(0.3, -0.7, 0.648);
    const double length_1 = robust_length(v);
    for (const int k : {-1000, -300, -1, 1, 300, 1000}) {
        const dvec3 scaled(std::ldexp(v.x, k), std::ldexp(v.y, k), std::ldexp(v.z, k));
        EXPECT_TRUE(same_bits(robust_length(scaled), std::ldexp(length_1, k))) << k;
    }
    EXPECT_EQ(std::sqrt(dot(v * 1e-200, v * 1e-200)), 0) << "the plain form vanishes";
    EXPECT_EQ(robust_length(dvec3(5e-324, 0, 0)), 5e-324);
    EXPECT_EQ(robust_length(dvec3(3e300, 4e300, 0)), 5e300);
    EXPECT_EQ(robust_length(dvec3(0)), 0);
    EXPECT_EQ(robust_length(dvec3(1, -INFINITY, 0)), INFINITY);
    EXPECT_TRUE(std::isnan(robust_length(dvec3(1, NAN, 0))));
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

}  // namespace
}  // namespace etalon
