// Functions of shaders/lib on the device over tables of inputs, against double precision.
#include "tests/gpu/path_lib.h"

#include <cmath>
#include <complex>
#include <limits>
#include <random>

#include "path_shaders.h"
#include "tests/gpu/device_test.h"

namespace etalon::test {
namespace {

using shared::LibCall;

class PathLib : public DeviceTest {
 protected:
    std::vector<vec4> call(const std::vector<LibCall>& rows)
    {
        return run_kernel<vec4>(device(), path_shaders::find("path_lib.comp"), rows);
    }
};

LibCall row(shared::uint function, vec4 a, vec4 b = vec4(0), vec4 c = vec4(0), vec4 d = vec4(0))
{
    return {function, a, b, c, d};
}

double relative(double value, double truth)
{
    return std::abs(value - truth) / std::abs(truth);
}

TEST_F(PathLib, S21_atan_turns_is_within_1e_7_everywhere)
{
    std::vector<LibCall> rows;
    for (int i = 0; i <= 4000; ++i) {
        const double angle = (i - 2000) * kPi / 2000;
        for (const double length : {1e-30, 1.0, 1e30})
            rows.push_back(
                row(shared::kAtanTurns, vec4(float(std::sin(angle) * length), float(std::cos(angle) * length), 0, 0)));
    }
    rows.push_back(row(shared::kAtanTurns, vec4(0)));
    const std::vector<vec4> got = call(rows);
    for (std::size_t i = 0; i + 1 < rows.size(); ++i) {
        const double truth = std::atan2(double(rows[i].a.x), double(rows[i].a.y)) / (2 * kPi);
        // Half a turn and minus half a turn are the same direction.
        const double error = std::abs(got[i].x - truth);
        EXPECT_LT(std::min(error, 1 - error), 1e-7) << rows[i].a.x << " " << rows[i].a.y;
    }
    EXPECT_EQ(got.back().x, 0);
}

TEST_F(PathLib, cos_sin_turns_is_within_2e_7)
{
    std::vector<LibCall> rows;
    for (int i = 0; i < 10000; ++i) rows.push_back(row(shared::kCosSinTurns, vec4(float(i) / 10000.f, 0, 0, 0)));
    rows.push_back(row(shared::kCosSinTurns, vec4(1 - 0x1p-24f, 0, 0, 0)));
    const std::vector<vec4> got = call(rows);
    for (std::size_t i = 0; i < rows.size(); ++i) {
        EXPECT_NEAR(got[i].x, std::cos(2 * kPi * rows[i].a.x), 2e-7);
        EXPECT_NEAR(got[i].y, std::sin(2 * kPi * rows[i].a.x), 2e-7);
    }
}

TEST_F(PathLib, T10_srgb_codes_decode_to_within_4e_7_relative)
{
    std::vector<LibCall> rows;
    for (int i = 0; i < 256; ++i) rows.push_back(row(shared::kDecodeSrgb, vec4(float(i) / 255.f, 0, 0, 0)));
    const std::vector<vec4> got = call(rows);
    EXPECT_EQ(got[0].x, 0);
    EXPECT_EQ(got[255].x, 1);  // white is no texture
    for (std::size_t i = 1; i < 256; ++i) {
        const double c = double(i) / 255;
        const double truth = c <= 0.04045 ? c / 12.92 : std::pow((c + 0.055) / 1.055, 2.4);
        EXPECT_LT(relative(got[i].x, truth), 4e-7) << i;
        EXPECT_GT(got[i].x, got[i - 1].x);
    }
}

TEST_F(PathLib, A3_lengths_and_unit_vectors_hold_from_1e_30_to_1e_30)
{
    std::mt19937 random(1);
    std::uniform_real_distribution<double> exponent(-30, 30), sign(-1, 1);
    std::vector<LibCall> rows;
    for (int i = 0; i < 3000; ++i) {
        const double scale = std::pow(10, exponent(random));
        const dvec3 v = dvec3(sign(random), sign(random), sign(random)) * scale;
        rows.push_back(row(shared::kNormalize, vec4(vec3(v), 0)));
    }
    rows.push_back(row(shared::kNormalize, vec4(0)));
    const std::vector<vec4> got = call(rows);
    for (std::size_t i = 0; i + 1 < rows.size(); ++i) {
        const dvec3 v(rows[i].a);
        EXPECT_LT(relative(got[i].w, length(v)), 3e-7);
        EXPECT_LT(length(dvec3(got[i]) - v / length(v)), 4e-7);
    }
    EXPECT_EQ(got.back(), vec4(0)) << "zero stays zero";
}

double dielectric_truth(double cosine, double eta)
{
    const double sine2 = (1 - cosine * cosine) / (eta * eta);
    if (sine2 >= 1) return 1;
    const double cos_t = std::sqrt(1 - sine2);
    const double s = (cosine - eta * cos_t) / (cosine + eta * cos_t);
    const double p = (eta * cosine - cos_t) / (eta * cosine + cos_t);
    return (s * s + p * p) / 2;
}

TEST_F(PathLib, S10_S11_dielectric_reflectance_keeps_its_digits_near_index_one_and_at_total_reflection)
{
    std::vector<LibCall> rows;
    for (const float excess : {1e-6f, 1e-4f, 0.01f, 0.33f, 0.5f, 1.4f, -1e-4f, -0.01f, -1.f / 3, -0.5f})
        for (const float cosine : {1e-3f, 0.05f, 0.3f, 0.5f, 0.8f, 0.99f, 1.f})
            rows.push_back(row(shared::kDielectric, vec4(cosine, excess, 0, 0)));
    const std::size_t regular = rows.size();
    rows.push_back(row(shared::kDielectric, vec4(0.7f, 0, 0, 0)));
    rows.push_back(row(shared::kDielectric, vec4(0, 0.5f, 0, 0)));
    const std::vector<vec4> got = call(rows);
    for (std::size_t i = 0; i < regular; ++i) {
        const double truth = dielectric_truth(rows[i].a.x, 1 + double(rows[i].a.y));
        EXPECT_NEAR(got[i].x, truth, 2e-6 * truth + 1e-18) << rows[i].a.x << " " << rows[i].a.y;
        EXPECT_EQ(truth == 1 && rows[i].a.x > 0, got[i].y == 0) << "one number decides";
    }
    EXPECT_EQ(got[regular].x, 0) << "index 1 reflects nothing";
    EXPECT_NEAR(got[regular + 1].x, 1, 1e-6) << "grazing reflects all";
}

TEST_F(PathLib, S13_conductors_are_exact_and_finite_up_to_k_of_1e18)
{
    std::vector<LibCall> rows;
    for (const float k : {0.f, 0.5f, 3.9f, 100.f, 1e4f, 1e10f, 1e18f})
        for (const float eta : {0.f, 0.2f, 1.5f, 10.f})
            for (const float cosine : {1e-3f, 0.1f, 0.5f, 1.f})
                if (eta + k > 0.4f) rows.push_back(row(shared::kConductor, vec4(cosine, eta, k, 0)));
    const std::vector<vec4> got = call(rows);
    for (std::size_t i = 0; i < rows.size(); ++i) {
        const double c = rows[i].a.x, eta = rows[i].a.y, k = rows[i].a.z;
        const std::complex<long double> m(eta, k);
        const std::complex<long double> root = std::sqrt(m * m - std::complex<long double>(1 - c * c));
        const std::complex<long double> cosine(c);
        const long double s = std::norm((cosine - root) / (cosine + root));
        const long double p = std::norm((m * m * cosine - root) / (m * m * cosine + root));
        EXPECT_NEAR(got[i].x, double((s + p) / 2), 4e-6) << c << " " << eta << " " << k;
    }
    const std::vector<vec4> perfect = call({row(shared::kConductor, vec4(0.3f, 0, 1, 0))});
    EXPECT_FLOAT_EQ(perfect[0].x, 1) << "eta 0, k 1 reflects all";
}

TEST_F(PathLib, S14_schlick_stays_between_f0_and_one)
{
    const std::vector<vec4> got =
        call({row(shared::kSchlick, vec4(0.04f, 0.5f, 1, 1 + 0x1p-22f)), row(shared::kSchlick, vec4(0.04f, 0.5f, 1, 0)),
              row(shared::kSchlick, vec4(0.04f, 0.5f, 1, 0.5f))});
    EXPECT_EQ(vec3(got[0]), vec3(0.04f, 0.5f, 1));
    EXPECT_EQ(vec3(got[1]), vec3(1));
    EXPECT_NEAR(got[2].x, 0.04 + 0.96 / 32, 1e-7);
}

TEST_F(PathLib, S25_weights_of_two_techniques_add_up_to_one)
{
    std::vector<LibCall> rows;
    for (const float p : {1e-38f, 1e-25f, 1.f, 3.f, 1e20f, 1e38f})
        for (const float q : {0.f, 1e-38f, 1e-25f, 1.f, 2.f, 1e20f, 1e38f})
            rows.push_back(row(shared::kPowerHeuristic, vec4(p, q, 0, 0)));
    const std::vector<vec4> got = call(rows);
    for (std::size_t i = 0; i < rows.size(); ++i) {
        EXPECT_NEAR(got[i].x + got[i].y, 1, 2e-7) << rows[i].a.x << " " << rows[i].a.y;
        EXPECT_NEAR(got[i].x, 1 / (1 + std::pow(double(rows[i].a.y) / rows[i].a.x, 2)), 2e-7);
    }
    EXPECT_EQ(call({row(shared::kPowerHeuristic, vec4(0))})[0].x, 0) << "a density of zero has no weight";
}

TEST_F(PathLib, S19_the_cone_of_a_far_sphere_keeps_its_solid_angle)
{
    std::vector<LibCall> rows;
    for (double ratio = 1; ratio > 1e-13; ratio /= 3)
        rows.push_back(row(shared::kConeSolidAngle, vec4(float(ratio * ratio), 0, 0, 0)));
    const std::vector<vec4> got = call(rows);
    for (std::size_t i = 0; i < rows.size(); ++i) {
        const double s2 = rows[i].a.x;
        EXPECT_LT(relative(got[i].x, 2 * kPi * s2 / (1 + std::sqrt(1 - s2))), 3e-7);
    }
}

TEST_F(PathLib, G34_frames_are_orthonormal_over_the_sphere)
{
    std::mt19937 random(2);
    std::normal_distribution<double> normal;
    std::vector<vec3> normals{{0, 0, 1}, {0, 0, -1}, {-0.f, -0.f, -1}, {1, 0, -0.f}, {1e-9f, 0, -1}, {0, 1, 0}};
    for (int i = 0; i < 3000; ++i)
        normals.push_back(vec3(normalize(dvec3(normal(random), normal(random), normal(random)))));
    std::vector<LibCall> rows;
    for (const vec3& n : normals) {
        rows.push_back(row(shared::kFrameX, vec4(n, 0)));
        rows.push_back(row(shared::kFrameY, vec4(n, 0)));
    }
    const std::vector<vec4> got = call(rows);
    for (std::size_t i = 0; i < normals.size(); ++i) {
        const dvec3 x(got[2 * i]), y(got[2 * i + 1]), n(normals[i]);
        EXPECT_LT(length(cross(x, y) - n), 1e-6);
        EXPECT_NEAR(length(x), 1, 5e-7);
        EXPECT_NEAR(dot(x, n), 0, 5e-7);
    }
}

TEST_F(PathLib, G14_G15_spheres_hold_far_away_and_when_huge)
{
    std::vector<LibCall> rows;
    std::mt19937 random(3);
    std::uniform_real_distribution<double> unit(-0.9, 0.9);
    for (const double distance : {3.0, 1e2, 1e3, 1e4}) {
        for (int i = 0; i < 500; ++i) {
            const dvec3 target(unit(random) * 0.7, unit(random) * 0.7, 0);
            const vec3 origin(0, 0, float(-distance));
            const vec3 direction(normalize(target - dvec3(origin)));
            rows.push_back(row(shared::kSphere, vec4(origin, 0), vec4(direction, 0), vec4(0, 0, 0, 1)));
        }
    }
    rows.push_back(row(shared::kSphere, vec4(0, 2, 0, 0), vec4(0.6f, -0.8f, 0, 0), vec4(0, -1e6f, 0, 1e6f)));
    const std::vector<vec4> got = call(rows);
    for (std::size_t i = 0; i + 1 < rows.size(); ++i) {
        const dvec3 o(rows[i].a), d(rows[i].b);
        const double b = dot(o, d), c = dot(o, o) - 1, dd = dot(d, d), root = b * b - dd * c;
        ASSERT_GT(root, 0);
        EXPECT_EQ(got[i].z, 1);
        const double truth = (-b - std::sqrt(root)) / dd;
        // Promise G14: 0.003 radii at distance 10^4, where b² - 4ac is off by radii.
        EXPECT_NEAR(got[i].x, truth, 1e-6 + 4e-7 * truth) << truth;
    }
    EXPECT_NEAR(got.back().x, 2.5, 0.2) << "the ground as a sphere of 1000 km, seen from 2 m";
}

TEST_F(PathLib, G10_rays_at_edges_and_vertices_of_a_closed_mesh_do_not_pass)
{
    // An icosahedron seen from inside, from points off its centre; rays at its vertices and along its edges.
    const float phi = 1.618034f;
    std::vector<vec3> corners;
    for (const float a : {-1.f, 1.f})
        for (const float b : {-phi, phi}) {
            corners.push_back({0, a, b});
            corners.push_back({a, b, 0});
            corners.push_back({b, 0, a});
        }
    std::vector<std::array<std::size_t, 3>> faces;
    const auto adjacent = [&](std::size_t i, std::size_t j) {
        return std::abs(length(corners[i] - corners[j]) - 2) < 1e-3f;
    };
    for (std::size_t i = 0; i < 12; ++i)
        for (std::size_t j = i + 1; j < 12; ++j)
            for (std::size_t k = j + 1; k < 12; ++k)
                if (adjacent(i, j) && adjacent(j, k) && adjacent(i, k)) faces.push_back({i, j, k});
    ASSERT_EQ(faces.size(), 20u);

    std::mt19937 random(4);
    std::uniform_real_distribution<float> unit(0, 1);
    for (const float offset : {0.f, 10.f, 1000.f}) {
        std::vector<LibCall> rows;
        constexpr std::size_t kRays = 3000;
        for (std::size_t r = 0; r < kRays; ++r) {
            const auto& face = faces[r % 20];
            const vec3 shift(offset, -offset, offset);
            const vec3 eye = shift + vec3(unit(random), unit(random), unit(random)) * 0.5f;
            const vec3 a = corners[face[0]] + shift, b = corners[face[1]] + shift;
            const vec3 target = r % 3 == 0 ? a : a + unit(random) * (b - a);
            for (const auto& f : faces)
                rows.push_back(row(shared::kTriangle, vec4(corners[f[0]] + shift, eye.x),
                                   vec4(corners[f[1]] + shift, eye.y), vec4(corners[f[2]] + shift, eye.z),
                                   vec4(target - eye, 0)));
        }
        const std::vector<vec4> got = call(rows);
        std::size_t leaks = 0;
        for (std::size_t r = 0; r < kRays; ++r) {
            bool met = false;
            for (std::size_t f = 0; f < 20; ++f) {
                const vec4& hit = got[20 * r + f];
                met = met || (std::fmod(hit.w, 2.f) == 1 && hit.x > 0);
            }
            leaks += !met;
        }
        EXPECT_EQ(leaks, 0u) << "at offset " << offset;
    }
}

TEST_F(PathLib, triangles_give_the_distance_the_barycentrics_and_the_side)
{
    std::mt19937 random(5);
    std::uniform_real_distribution<double> unit(-1, 1);
    std::vector<LibCall> rows;
    for (int i = 0; i < 3000; ++i) {
        const auto point = [&] { return dvec3(unit(random), unit(random), unit(random)); };
        const vec3 p0(point()), p1(point()), p2(point()), o(point() * 3.0);
        const vec3 d(0.3 * dvec3(p0) + 0.4 * dvec3(p1) + 0.3 * dvec3(p2) + 0.3 * point() - dvec3(o));
        rows.push_back(row(shared::kTriangle, vec4(p0, o.x), vec4(p1, o.y), vec4(p2, o.z), vec4(d, 0)));
    }
    const std::vector<vec4> got = call(rows);
    std::size_t met = 0;
    for (std::size_t i = 0; i < rows.size(); ++i) {
        const LibCall& r = rows[i];
        const dvec3 p0(r.a), e1 = dvec3(r.b) - p0, e2 = dvec3(r.c) - p0, o(r.a.w, r.b.w, r.c.w), d(r.d);
        const dvec3 n = cross(e1, e2);
        if (std::abs(dot(n, d)) < 0.02 * length(n) * length(d)) continue;  // nearly edge-on
        const dvec3 s = o - p0, p = cross(d, e2), q = cross(s, e1);
        const double det = dot(e1, p);
        const double u = dot(s, p) / det, v = dot(d, q) / det, t = dot(e2, q) / det;
        const double margin = std::min({u, v, 1 - u - v});
        if (std::abs(margin) < 1e-4) continue;
        EXPECT_EQ(std::fmod(got[i].w, 2.f) == 1, margin > 0) << i;
        if (margin < 0) continue;
        ++met;
        EXPECT_EQ(got[i].w >= 2, det > 0) << "front: the ray comes from where the normal points";
        EXPECT_NEAR(got[i].x, t, 3e-5);
        EXPECT_NEAR(got[i].y, u, 3e-4);
        EXPECT_NEAR(got[i].z, v, 3e-4);
    }
    EXPECT_GT(met, 500u);
}

TEST_F(PathLib, S6_S9_ggx_is_exact_at_its_peak_and_finite_at_grazing_angles)
{
    std::vector<LibCall> rows;
    for (const double alpha : {1e-4, 1e-3, 1e-2, 0.1, 0.5, 1.0})
        for (const double tangent : {0.0, 0.1, 1.0, 10.0}) {
            const double theta = std::atan(alpha * tangent);
            for (const double cosine : {1e-20, 1e-3, 0.4, 1.0})
                rows.push_back(row(shared::kGgx, vec4(float(std::sin(theta)), 0, float(std::cos(theta)), float(alpha)),
                                   vec4(float(cosine), 0.3f, 0, 0)));
        }
    const std::vector<vec4> got = call(rows);
    for (std::size_t i = 0; i < rows.size(); ++i) {
        const double s = rows[i].a.x, c = rows[i].a.z, a = rows[i].a.w, ci = rows[i].b.x, co = rows[i].b.y;
        const double k = a / (s * s + c * c * a * a);
        EXPECT_LT(relative(got[i].x, k * k / kPi), 2e-6);
        const double v =
            0.5 / (ci * std::sqrt(co * co * (1 - a * a) + a * a) + co * std::sqrt(ci * ci * (1 - a * a) + a * a));
        EXPECT_LT(relative(got[i].y, v), 2e-6);
        EXPECT_LT(relative(got[i].z, 2 * ci / (ci + std::sqrt(a * a + (1 - a * a) * ci * ci))), 2e-6);
    }
}

TEST_F(PathLib, S15_visible_normals_are_unit_upright_and_seen_from_wo)
{
    std::mt19937 random(6);
    std::uniform_real_distribution<float> unit(0, 1);
    std::vector<LibCall> rows;
    for (const float alpha : {1e-4f, 1e-2f, 0.3f, 1.f})
        for (const float cosine : {1e-7f, 1e-3f, 0.2f, 0.7f, 1.f})
            for (int i = 0; i < 400; ++i) {
                const float sine = std::sqrt(std::max(0.f, 1 - cosine * cosine));
                // The ends of the unit interval first.
                const vec2 u = i == 0 ? vec2(0) : i == 1 ? vec2(1 - 0x1p-24f) : vec2(unit(random), unit(random));
                rows.push_back(row(shared::kVndf, vec4(sine, 0, cosine, alpha), vec4(u, 0, 0)));
            }
    const std::vector<vec4> got = call(rows);
    for (std::size_t i = 0; i < rows.size(); ++i) {
        const dvec3 h(got[i]);
        ASSERT_TRUE(is_finite(h));
        EXPECT_NEAR(length(h), 1, 1e-6);
        EXPECT_GE(h.z, 0);
        EXPECT_GT(dot(h, dvec3(rows[i].a)), -1e-7);
    }
}

// 3 of 2.5 million samples of the Khronos asset TransmissionRoughnessTest were NaN: rays that leaked out of a body
// which absorbs nothing, towards the sky. Their distance times exp's log2(e) is infinite.
TEST_F(PathLib, SH_59_what_absorbs_nothing_does_so_infinitely_far)
{
    std::vector<LibCall> rows{
        row(shared::kAbsorbed, vec4(0.f, -0.f, 0.f, 0)), row(shared::kAbsorbed, vec4(0.f, 0.f, 0.f, 3e38f)),
        row(shared::kAbsorbed, vec4(1e-30f, 1e30f, 0.f, 0)), row(shared::kAbsorbed, vec4(0.5f, 2.f, 0.f, 1.5f))};
    const std::vector<vec4> got = call(rows);
    EXPECT_EQ(got[0], vec4(1));
    EXPECT_EQ(got[1], vec4(1));
    EXPECT_EQ(got[2], vec4(0));
    EXPECT_NEAR(got[3].x, std::exp(-0.75), 1e-5);
    EXPECT_NEAR(got[3].y, std::exp(-3.0), 1e-5);
    EXPECT_EQ(got[3].z, 0);
}

TEST_F(PathLib, S18_cosine_samples_never_lie_on_the_horizon)
{
    std::vector<LibCall> rows;
    for (int i = 1; i <= 4096; ++i)
        rows.push_back(row(shared::kCosine, vec4(float(0x1000000 - i) * 0x1p-24f, 0.3f, 0, 0)));
    rows.push_back(row(shared::kCosine, vec4(0)));
    for (const vec4& w : call(rows)) {
        EXPECT_GT(w.z, 0);
        EXPECT_NEAR(length(dvec3(w)), 1, 5e-7);
    }
}

}  // namespace
}  // namespace etalon::test
