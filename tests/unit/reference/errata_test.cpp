// Where the notes are wrong: for each erratum what we compute passes, and the form that the notes print fails.
// docs/errata.md.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <functional>

#include "engine/reference/pixel_sums.h"
#include "engine/reference/raster_geometry.h"
#include "engine/reference/reference.h"
#include "engine/reference/texture.h"
#include "engine/scene/builder.h"

namespace etalon::reference {
namespace {

using Corners = std::array<FixedPoint, 3>;

/// How often the two triangles of every cell of a 16×16 grid on pixel centres cover each centre: {never, once, more
/// often}.
std::array<int, 3> coverage_of_grid(const std::function<bool(const Corners&, const FixedPoint&)>& covers_sample)
{
    std::array<int, 3> counts{};
    constexpr std::int64_t kCells = 16;
    for (std::int64_t y = 0; y < kCells; ++y)
        for (std::int64_t x = 0; x < kCells; ++x) {
            const FixedPoint sample{256 * x + 128, 256 * y + 128};
            int count = 0;
            for (std::int64_t v = y - 1; v <= y; ++v)  // cells whose corners are the centres around it
                for (std::int64_t u = x - 1; u <= x; ++u) {
                    const FixedPoint a{256 * u + 128, 256 * v + 128}, b{a.x + 256, a.y}, c{a.x + 256, a.y + 256},
                        d{a.x, a.y + 256};
                    count += covers_sample({a, b, c}, sample) + covers_sample({a, c, d}, sample);
                }
            ++counts[std::size_t(std::min(count, 2))];
        }
    return counts;
}

bool covers_with(const Corners& c, const FixedPoint& p, const std::function<bool(std::int64_t)>& inside)
{
    return inside(edge(c[0], c[1], p)) && inside(edge(c[1], c[2], p)) && inside(edge(c[2], c[0], p));
}

TEST(Errata, E1_shared_edges_need_the_top_left_rule_not_at_least_0)
{
    EXPECT_EQ(coverage_of_grid(covers), (std::array{0, 256, 0}));
    const auto notes = [](const Corners& c, const FixedPoint& p) {
        return covers_with(c, p, [](std::int64_t e) { return e >= 0; });
    };
    EXPECT_EQ(coverage_of_grid(notes), (std::array{0, 0, 256}));  // every centre drawn more than once
    const auto strict = [](const Corners& c, const FixedPoint& p) {
        return covers_with(c, p, [](std::int64_t e) { return e > 0; });
    };
    EXPECT_EQ(coverage_of_grid(strict), (std::array{256, 0, 0}));  // and with > 0 never
}

TEST(Errata, E2_half_the_sampling_rate_is_the_limit_not_the_highest_frequency_twice_over)
{
    // 0.6 of the rate lies below "twice the highest frequency present" of the notes' frequency, yet its samples are
    // those of 0.4.
    for (int i = 0; i < 32; ++i) EXPECT_NEAR(std::cos(2 * kPi * 0.6 * i), std::cos(2 * kPi * 0.4 * i), 1e-12);
    double difference = 0;  // below half the rate two frequencies are told apart
    for (int i = 0; i < 32; ++i) difference += std::abs(std::cos(2 * kPi * 0.4 * i) - std::cos(2 * kPi * 0.3 * i));
    EXPECT_GT(difference, 10);
}

View view_of(double yfov, int width, int height, double znear)
{
    Camera camera;
    camera.yfov = yfov;
    camera.znear = znear;
    return {.width = width, .height = height, .world_from_camera = dmat4(1), .camera = camera};
}

TEST(Errata, E3_homogeneous_w_is_neither_0_nor_1_after_projection)
{
    const dmat4 m = projection(view_of(1, 64, 64, 0.1), 1);
    for (const double z : {-0.5, -2.0, -7.0}) {
        const double w = (m * dvec4(0, 0, z, 1)).w;
        EXPECT_EQ(w, -z);
        EXPECT_TRUE(w != 0 && w != 1);  // the notes allow these two alone
    }
}

// The notes' rotation about unit axis n, whose cross-product matrix has its signs turned.
dmat3 rotation(const dvec3& n, double angle, double sign)
{
    const double c = std::cos(angle), s = sign * std::sin(angle);
    dmat3 m;
    for (int i = 0; i < 3; ++i) {
        dvec3 e(0);
        e[i] = 1;
        m[i] = c * e + (1 - c) * dot(n, e) * n + s * cross(n, e);
    }
    return m;
}

TEST(Errata, E4_a_quarter_turn_about_z_takes_x_to_y)
{
    const auto x_turned = [](double sign) { return rotation({0, 0, 1}, kPi / 2, sign) * dvec3(1, 0, 0); };
    EXPECT_NEAR(length(x_turned(1) - dvec3(0, 1, 0)), 0, 1e-15);
    EXPECT_NEAR(length(x_turned(-1) - dvec3(0, -1, 0)), 0, 1e-15);  // as printed: the other way
    // The engine's own turns agree with the right form.
    for (const double angle : {0.3, 2.0}) {
        const dmat3 y = dmat3(rotation_y(angle)), x = dmat3(rotation_x(angle));
        for (int i = 0; i < 3; ++i) {
            EXPECT_NEAR(length(y[i] - rotation({0, 1, 0}, angle, 1)[i]), 0, 1e-15);
            EXPECT_NEAR(length(x[i] - rotation({1, 0, 0}, angle, 1)[i]), 0, 1e-15);
            if (i != 1) {
                EXPECT_GT(length(y[i] - rotation({0, 1, 0}, angle, -1)[i]), 0.1);
            }
        }
    }
}

TEST(Errata, E5_the_top_of_the_view_is_near_times_the_tangent_of_half_the_angle)
{
    const dmat4 m = projection(view_of(kPi / 2, 64, 64, 1), 1);
    const auto top = [&](double height) {
        const dvec4 c = m * dvec4(0, height, -1, 1);
        return c.y / c.w;  // -1 at the upper edge
    };
    EXPECT_NEAR(top(std::tan(kPi / 4)), -1, 1e-15);
    EXPECT_LT(top(std::tan(kPi / 2)), -1e15);  // the notes: 90 degrees would be infinitely high
}

TEST(Errata, E6_the_corner_of_the_far_plane_is_wider_than_that_of_the_near_plane)
{
    const double near = 1, far = 100, right = near * std::tan(kPi / 4);
    const dmat4 m = projection(view_of(kPi / 2, 64, 64, near), far);
    const auto x_ndc = [&](const dvec3& p) {
        const dvec4 c = m * dvec4(p, 1);
        return c.x / c.w;
    };
    EXPECT_NEAR(x_ndc({right * far / near, 0, -far}), 1, 1e-15);
    EXPECT_NEAR(x_ndc({right, 0, -far}), 0.01, 1e-15);  // the notes' (right, top, -far) lands here, not on 1
}

struct Checker {
    Texels texels;
    Checker()
    {
        texels.width = texels.height = 8;
        for (int i = 0; i < 64; ++i) {
            const auto v = static_cast<std::uint8_t>((i + i / 8) % 2 == 0 ? 0 : 255);
            texels.bytes.insert(texels.bytes.end(), {v, v, v, 255});
        }
    }
};

TEST(Errata, E7_magnified_textures_read_level_0_trilinear_or_not)
{
    const Checker checker;
    const MipChain mips(checker.texels, Coding::linear, true);
    const Sampler trilinear, bilinear{.mipmapped = false};
    const double magnified = mip_level({0.1, 0}, {0, 0.1}, mips.levels());  // ten pixels a texel
    for (int i = 0; i < 100; ++i) {
        const dvec2 uv(0.37 * i, 0.011 * i * i);
        EXPECT_EQ(sample_mips(mips, trilinear, uv, magnified), sample_mips(mips, bilinear, uv, magnified));
    }
    const double minified = mip_level({4, 0}, {0, 4}, mips.levels());  // here alone the levels act
    EXPECT_NE(sample_mips(mips, trilinear, {0.06, 0.06}, minified),
              sample_mips(mips, bilinear, {0.06, 0.06}, minified));
}

TEST(Errata, E8_levels_are_whole_numbers_blended_by_the_fraction)
{
    const Checker checker;
    const MipChain mips(checker.texels, Coding::linear, true);
    const Sampler sampler;
    const dvec2 uv(1.0 / 16, 1.0 / 16);  // the centre of a black texel; level 1 is grey
    for (const double d : {0.25, 0.5, 0.75}) EXPECT_NEAR(sample_mips(mips, sampler, uv, d).x, 0.5 * d, 1e-15);
    // The notes blend D and D + 1. At D = 0.75 those are 0.75 and 1.75, which no image is; taken as the next images, 1
    // and 2, every blend is the same grey.
    const double first = sample_mips(mips, sampler, uv, 1).x, second = sample_mips(mips, sampler, uv, 2).x;
    EXPECT_EQ(first, second);
    EXPECT_GT(std::abs(first - 0.5 * 0.75), 0.1);
    EXPECT_EQ(sample_mips(mips, sampler, uv, 99),
              sample_mips(mips, sampler, uv, 3));  // nor is there one beyond the last
}

TEST(Errata, E10_the_first_cubic_Bernstein_weight_is_1_minus_t_cubed)
{
    const double t = 0.5, rest = 3 * t * (1 - t) * (1 - t) + 3 * t * t * (1 - t) + t * t * t;
    EXPECT_EQ(std::pow(1 - t, 3) + rest, 1);
    EXPECT_EQ(1 - std::pow(t, 3) + rest, 1.75);  // as printed: (1 - t³)
}

/// Mean radiance of a grey Lambert plane under a point light, in the middle of a picture taken from `eye`.
double lit_plane_from(const dvec3& eye)
{
    SceneBuilder builder("plane");
    builder.show("plane", make_rectangle(dvec3(0), {0, 0, 5}, {5, 0, 0}), builder.lambert("grey", dvec3(0.5)));
    builder.light({.type = LightType::directional, .intensity = 10}, rotation_x(-kPi / 2 + 0.5));
    builder.camera("camera", 1, eye, dvec3(0));
    const Scene scene = std::move(builder).finish();
    PoseSettings pose_settings;
    pose_settings.size = ivec2(3, 3);
    const PosedScene posed = pose(scene, pose_settings);
    const RenderSettings settings{.renderer = Renderer::reference, .spp = 4, .max_depth = 2};
    return render_path(posed, require(posed, settings), settings, {}).mean[4].x;
}

TEST(Errata, E12_E13_a_Lambertian_plane_is_as_bright_from_everywhere_and_its_exitance_is_pi_times_that)
{
    const double head_on = lit_plane_from({0.01, 10, 0}), slanted = lit_plane_from({9.8, 2, 0});
    const double irradiance = 10 * std::cos(0.5);  // one cosine: where the light arrives
    EXPECT_NEAR(head_on, 0.5 * irradiance / kPi, 1e-6);
    EXPECT_NEAR(slanted, head_on, 1e-6);
    EXPECT_GT(std::abs(slanted - head_on * 2 / 10), 0.1);  // read as "observed intensity": a fifth
    EXPECT_NEAR(kPi * head_on, 0.5 * irradiance, 1e-5);    // leaves in lm/m² [lux]; luminance itself is nit
}

TEST(Errata, E14_explicit_steps_are_stable_when_they_are_short_enough)
{
    // x'' = -ω² x - 2ζω x' by explicit Euler: the notes call it unstable at any step; its bound is dt < 2ζ/ω.
    const auto amplitude_after = [](double dt) {
        const double omega = 10, zeta = 1;
        double x = 1, v = 0;
        for (int i = 0; i < 2000; ++i) {
            const double a = -omega * omega * x - 2 * zeta * omega * v;
            x += dt * v;
            v += dt * a;
        }
        return std::abs(x);
    };
    EXPECT_LT(amplitude_after(0.19), 1e-6);
    EXPECT_GT(amplitude_after(0.21), 1e6);
}

TEST(Errata, E16_variance_is_the_mean_of_the_squared_deviation)
{
    PixelSum constant, dice;
    double notes_constant = 0, mean = 0, squares = 0;
    for (int i = 0; i < 6; ++i) {
        constant.add(dvec3(3), 1);
        dice.add(dvec3(i + 1), 1);
        mean += (i + 1) / 6.0;
        squares += (i + 1) * (i + 1) / 6.0;
        notes_constant += (3 - 3 * 3) / 6.0;  // E[X - E[X]²] of X ≡ 3
    }
    EXPECT_EQ(constant.variance_of_mean(), dvec3(0));
    EXPECT_NEAR(dice.variance_of_mean().x, (squares - mean * mean) * 6 / 5 / 6, 1e-15);
    EXPECT_EQ(notes_constant, -6);
}

TEST(Errata, E18_a_sphere_of_radius_r_is_an_ellipsoid_of_semi_axes_r)
{
    const dvec3 on_sphere = 2.5 * normalize(dvec3(1, 2, 3));
    const auto ellipsoid = [&](double a) { return dot(on_sphere / a, on_sphere / a); };  // x²/a² + y²/b² + z²/c² = 1
    EXPECT_NEAR(ellipsoid(2.5), 1, 1e-15);
    EXPECT_NEAR(ellipsoid(2 * 2.5), 0.25, 1e-15);  // with whole axis lengths the point lies inside
}

TEST(Errata, E19_chromaticity_is_of_XYZ_not_of_cone_responses)
{
    const auto chromaticity = [](const dvec3& v) { return dvec2(v.x, v.y) / (v.x + v.y + v.z); };
    const dvec3 equal_energy(1, 1, 1);
    EXPECT_NEAR(length(chromaticity(equal_energy) - dvec2(1.0 / 3)), 0, 1e-15);
    // Hunt-Pointer-Estermez responses of D65, which are near (1, 1, 1), would call it equal-energy white; its XYZ does
    // not.
    const dvec3 d65(0.95047, 1, 1.08883);
    EXPECT_NEAR(chromaticity(d65).x, 0.3127, 1e-4);
    EXPECT_NEAR(chromaticity(d65).y, 0.3290, 1e-4);
    const dvec3 lms(0.4002 * d65.x + 0.7076 * d65.y - 0.0808 * d65.z, -0.2263 * d65.x + 1.1653 * d65.y + 0.0457 * d65.z,
                    0.9182 * d65.z);
    EXPECT_GT(length(chromaticity(lms) - chromaticity(d65)), 0.01);
}

}  // namespace
}  // namespace etalon::reference
