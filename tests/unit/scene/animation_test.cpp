// Interpolation of keys: promises G32 and G37, relation R28.
#include <gtest/gtest.h>

#include <array>
#include <random>

#include "engine/base/error.h"
#include "engine/scene/animation.h"

namespace etalon {
namespace {

using Exact = long double;  // 64 bits of mantissa: 11 more than what is tested

AnimationSampler sampler(Interpolation interpolation, std::vector<double> times, std::vector<double> values,
                         std::size_t width = 1)
{
    return {.interpolation = interpolation, .width = width, .times = std::move(times), .values = std::move(values)};
}

double at(const AnimationSampler& s, double time)
{
    return sample(s, time, false).at(0);
}

dquat turn(const dvec3& axis, double angle)
{
    const dvec3 v = std::sin(angle / 2) * normalize(axis);
    return dquat(std::cos(angle / 2), v.x, v.y, v.z);
}

// |a - b| of two unit quaternions as rotations: q and -q are one.
double distance(const dquat& a, const dquat& b)
{
    return std::min(glm::length(a - b), glm::length(a + b));
}

TEST(Animation, G37_holds_its_ends_and_takes_keys_as_they_are)
{
    const AnimationSampler line = sampler(Interpolation::linear, {1, 2, 4}, {10, 20, 0});
    EXPECT_EQ(at(line, -1e9), 10);
    EXPECT_EQ(at(line, 1), 10);
    EXPECT_EQ(at(line, 2), 20);
    EXPECT_EQ(at(line, 4), 0);
    EXPECT_EQ(at(line, 1e9), 0);
    EXPECT_EQ(at(line, 1.25), 12.5);
    EXPECT_EQ(at(line, 3), 10);
    EXPECT_EQ(at(sampler(Interpolation::linear, {5}, {7}), 0), 7) << "one key is a constant";
}

TEST(Animation, step_keeps_a_key_until_the_next_one)
{
    const AnimationSampler steps = sampler(Interpolation::step, {0, 1, 2}, {5, 6, 7});
    EXPECT_EQ(at(steps, std::nextafter(1.0, 0.0)), 5);
    EXPECT_EQ(at(steps, 1), 6);
    EXPECT_EQ(at(steps, 1.999), 6);
    EXPECT_EQ(at(steps, 2), 7);
}

TEST(Animation, G37_the_last_of_equal_times_counts)
{
    const AnimationSampler jump = sampler(Interpolation::linear, {0, 1, 1, 2}, {0, 10, 20, 30});
    EXPECT_EQ(at(jump, 0.5), 5);
    EXPECT_EQ(at(jump, 1), 20);
    EXPECT_EQ(at(jump, 1.5), 25);
}

TEST(Animation, G37_a_millionth_second_is_told_apart_after_a_million_seconds)
{
    const double start = 1e6;
    const AnimationSampler line = sampler(Interpolation::linear, {start, start + 1}, {0, 1});
    // The time itself has an ulp of 1.2e-10 s there.
    EXPECT_NEAR(at(line, start + 1e-6), 1e-6, 2e-10);
    EXPECT_NEAR(at(line, start + 0.75), 0.75, 2e-10);
}

TEST(Animation, cubic_is_the_hermite_curve_with_tangents_per_second)
{
    // p(t) = t³ on [0, 2]: slopes 0 and 12, and on [2, 3] to slope 27.
    const AnimationSampler cube = sampler(Interpolation::cubic, {0, 2, 3}, {-7, 0, 0, 12, 8, 12, 27, 27, -7});
    for (const double t : {0.0, 0.25, 1.0, 1.9, 2.0, 2.5, 2.75, 3.0}) EXPECT_NEAR(at(cube, t), t * t * t, 1e-14) << t;
    EXPECT_EQ(at(cube, 10), 27);
    EXPECT_EQ(at(sampler(Interpolation::cubic, {0, 1}, {0, 0.3, 0, 0, 0.3, 0}), 0.7), 0.3) << "constant to the bit";
}

TEST(Animation, a_constant_stays_constant_to_the_bit_and_a_line_never_leaves_its_keys)
{
    std::mt19937_64 random(1);
    std::uniform_real_distribution<double> any(-1e3, 1e3), unit(0, 1);
    for (int i = 0; i < 10000; ++i) {
        const double a = any(random), b = any(random), u = unit(random);
        EXPECT_EQ(at(sampler(Interpolation::linear, {0, 1}, {a, a}), u), a);
        const double value = at(sampler(Interpolation::linear, {0, 1}, {a, b}), u);
        EXPECT_GE(value, std::min(a, b));
        EXPECT_LE(value, std::max(a, b));
    }
}

TEST(Animation, R28_a_key_on_the_curve_and_another_clock_change_nothing)
{
    const AnimationSampler two = sampler(Interpolation::linear, {0, 1}, {3, 11});
    const AnimationSampler three = sampler(Interpolation::linear, {0, 0.25, 1}, {3, 5, 11});
    const AnimationSampler slow = sampler(Interpolation::linear, {0, 1e9}, {3, 11});
    for (double t = 0; t <= 1; t += 0.01) {
        EXPECT_NEAR(at(two, t), at(three, t), 8 * 0x1p-53 * 11) << t;
        EXPECT_NEAR(at(two, t), at(slow, t * 1e9), 8 * 0x1p-53 * 11) << t;
    }
}

// sin((1 - u) θ) / sin θ · a + sin(u θ) / sin θ · b with 64 bits of mantissa.
std::array<Exact, 4> exact_slerp(const dquat& a, const dquat& b, double u)
{
    const std::array<Exact, 4> p = {a.w, a.x, a.y, a.z};
    std::array<Exact, 4> q = {b.w, b.x, b.y, b.z};
    Exact dot = 0, pp = 0, qq = 0;
    for (std::size_t i = 0; i < 4; ++i) dot += p[i] * q[i], pp += p[i] * p[i], qq += q[i] * q[i];
    if (dot < 0)
        for (Exact& c : q) c = -c;
    Exact sum = 0, difference = 0;
    for (std::size_t i = 0; i < 4; ++i) {
        const Exact x = p[i] / std::sqrt(pp), y = q[i] / std::sqrt(qq);
        sum += (x + y) * (x + y), difference += (x - y) * (x - y);
    }
    const Exact angle = 2 * std::atan2(std::sqrt(difference), std::sqrt(sum));
    std::array<Exact, 4> out;
    for (std::size_t i = 0; i < 4; ++i)
        out[i] = angle == 0
                     ? p[i]
                     : (std::sin((1 - Exact(u)) * angle) * p[i] + std::sin(Exact(u) * angle) * q[i]) / std::sin(angle);
    return out;
}

TEST(Animation, G32_slerp_is_within_8u_of_extended_precision_from_angles_of_nothing_to_pi)
{
    std::mt19937_64 random(2);
    std::normal_distribution<double> normal;
    std::uniform_real_distribution<double> unit(0, 1);
    double worst = 0;
    for (const double angle : {0.0, 1e-300, 1e-12, 1e-8, 1e-4, 2e-4, 1e-2, 0.5, 1.0, 2.0, 3.0, kPi - 1e-4, kPi - 1e-9})
        for (int i = 0; i < 200; ++i) {
            const dquat a = glm::normalize(dquat(normal(random), normal(random), normal(random), normal(random)));
            const dquat b = glm::normalize(a * turn(dvec3(normal(random), normal(random), normal(random)), angle));
            const double u = unit(random);
            const dquat got = slerp(a, b, u);
            const std::array<Exact, 4> exact = exact_slerp(a, b, u);
            const std::array<double, 4> mine = {got.w, got.x, got.y, got.z};
            for (std::size_t c = 0; c < 4; ++c)
                worst = std::max(worst, static_cast<double>(std::abs(Exact(mine[c]) - exact[c])) * 0x1p53);
        }
    EXPECT_LE(worst, 8.0);
    RecordProperty("worst_u", std::to_string(worst));
}

TEST(Animation, G32_slerp_turns_at_constant_speed_the_short_way)
{
    for (const double angle : {1e-6, 1e-3, 0.3, 1.5, 3.0, kPi - 1e-4, kPi + 1e-4, 6.0}) {
        const dquat a = turn(dvec3(1, 2, 3), 0.4);
        const dquat b = a * turn(dvec3(-1, 0.5, 2), angle);
        const double shortest = angle > kPi ? angle - 2 * kPi : angle;
        for (double u = 0; u <= 1; u += 0.125)
            EXPECT_LT(distance(slerp(a, b, u), a * turn(dvec3(-1, 0.5, 2), u * shortest)), 1e-15) << angle;
        EXPECT_EQ(slerp(a, b, 0), a);
        EXPECT_LT(distance(slerp(a, b, 1), b), 1e-15);
        EXPECT_LT(distance(slerp(a, -b, 0.3), slerp(a, b, 0.3)), 1e-15) << "q and -q are one rotation (G31)";
    }
}

TEST(Animation, rotations_need_not_be_unit_and_a_zero_one_is_none)
{
    const AnimationSampler turns =
        sampler(Interpolation::linear, {0, 1, 2}, {0, 0, 0, 0, 0, 0, 3, 3, 0, 0, 1e-200, 1e-200}, 4);
    const std::vector<double> half = sample(turns, 0.5, true);
    EXPECT_LT(distance(dquat(half[3], half[0], half[1], half[2]), turn(dvec3(0, 0, 1), kPi / 4)), 1e-15);
    const std::vector<double> same = sample(turns, 1.5, true);
    EXPECT_LT(distance(dquat(same[3], same[0], same[1], same[2]), turn(dvec3(0, 0, 1), kPi / 2)), 1e-15);
    const AnimationSampler cubic = sampler(Interpolation::cubic, {0, 1}, {0, 0, 0, 0, 0, 0, 0, 1, 0, 0, 0, 0,  //
                                                                          0, 0, 0, 0, 0, 0, 1, 1, 0, 0, 0, 0},
                                           4);
    const std::vector<double> middle = sample(cubic, 0.5, true);
    EXPECT_NEAR(middle[2] * middle[2] + middle[3] * middle[3], 1, 1e-15);
}

TEST(Animation, is_found_by_name_then_by_index_and_the_error_lists_what_there_is)
{
    Scene scene;
    scene.name = "zoo.glb";
    scene.animations.resize(2);
    scene.animations[0].name = "1";
    scene.animations[1].name = "run";
    EXPECT_EQ(&find_animation(scene, "run"), &scene.animations[1]);
    EXPECT_EQ(&find_animation(scene, "1"), &scene.animations[0]) << "a name goes before an index";
    EXPECT_EQ(&find_animation(scene, "0"), &scene.animations[0]);
    for (const char* wrong : {"2", "walk", "", "-1", "1x", "99999999999999999999"})
        EXPECT_THROW(find_animation(scene, wrong), Error) << wrong;
}

}  // namespace
}  // namespace etalon
