// The layers of docs/shading.md §2b on the device against their equations in double, written here anew; their samplers
// by chi-square and by what the samples carry. Fixed seeds; false-alarm rates are stated.
#include "tests/gpu/path_glossy.h"

#include <cmath>
#include <functional>

#include "engine/render/albedo.h"
#include "path_shaders.h"
#include "shaders/shared/albedo.h"
#include "tests/gpu/device_test.h"
#include "tests/gpu/direction_bins.h"

namespace etalon::test {
namespace {

using shared::GlossyCall;
using shared::GlossyResult;

/// A surface in the terms of the equations.
struct Layered {
    const char* why = "";
    double cosine = 0.7;  ///< of wo
    dvec3 b{0.8, 0.5, 0.3};
    double m = 0.3;
    dvec3 f0_d{0.04};
    double f90_d = 1;
    double alpha_t = 0.3, alpha_b = 0.3;
    dvec3 boost{1};
    double film = 0, film_ior = 1.3, film_nanometres = 400;
    double t = 0, g = 0;
    dvec3 g_color{1};
    dvec3 eta{0};  ///< of the body, per channel; 0: none
    bool inside = false;
    dvec3 sheen{0};
    double sheen_roughness = 0.5;
    double coat = 0;  ///< K
    double coat_alpha = 0.1;
    dvec3 coat_n{0, 0, 1}, ng{0, 0, 1};
};

double max_of(const dvec3& v)
{
    return std::max({v.x, v.y, v.z});
}

dvec3 mixed(const dvec3& a, const dvec3& b, double x)
{
    return (1 - x) * a + x * b;
}

double schlick(double f0, double f90, double c)
{
    return f0 + (f90 - f0) * std::pow(1 - std::clamp(c, 0.0, 1.0), 5);
}

dvec3 schlick(const dvec3& f0, double f90, double c)
{
    return {schlick(f0.x, f90, c), schlick(f0.y, f90, c), schlick(f0.z, f90, c)};
}

/// I of (SH-51).
dvec3 film_truth(const Layered& s, double c1, const dvec3& f0)
{
    const double x = std::min(s.film_nanometres / 0.03, 1.0);
    const double n2 = 1 + (s.film_ior - 1) * x * x * (3 - 2 * x);
    const double sine2 = (1 - c1 * c1) / (n2 * n2);
    if (sine2 >= 1) return dvec3(1);
    const double c2 = std::sqrt(1 - sine2);
    const double r12 = schlick(std::pow((n2 - 1) / (n2 + 1), 2), 1, c1), t = 1 - r12;
    const double phi21 = n2 < 1 ? 0 : kPi, opd = 2 * n2 * s.film_nanometres * c2;
    dvec3 phi(0), r23(0), r(0), rs(0);
    for (int i = 0; i < 3; ++i) {
        const double root = std::sqrt(std::clamp(f0[i], 0.0, 0.9999)), n3 = (1 + root) / (1 - root);
        r23[i] = schlick(std::pow((n3 - n2) / (n3 + n2), 2), 1, c2);
        phi[i] = phi21 + (n3 < n2 ? kPi : 0);
        const double both = std::clamp(r12 * r23[i], 1e-5, 0.9999);
        r[i] = std::sqrt(both);
        rs[i] = t * t * r23[i] / (1 - both);
    }
    dvec3 value = r12 + rs;
    for (int k = 1; k <= 2; ++k) {
        const double p = 2 * kPi * k * opd * 1e-9;
        const dvec3 v = 1e-13 * dvec3(5.4856, 4.4201, 5.2481), mu = 1e6 * dvec3(1.6810, 1.7953, 2.2084),
                    sigma = 1e9 * dvec3(4.3278, 9.3046, 6.6121);
        dvec3 xyz;
        for (int j = 0; j < 3; ++j)
            xyz[j] =
                v[j] * std::sqrt(2 * kPi * sigma[j]) * std::cos(mu[j] * p + k * phi[j]) * std::exp(-sigma[j] * p * p);
        xyz.x += 9.7470e-14 * std::sqrt(2 * kPi * 4.5282e9) * std::cos(2.2399e6 * p + k * phi.x) *
                 std::exp(-4.5282e9 * p * p);
        xyz /= 1.0685e-7;
        const dvec3 rgb(dot(dvec3(3.2404542, -1.5371385, -0.4985314), xyz),
                        dot(dvec3(-0.9692660, 1.8760108, 0.0415560), xyz),
                        dot(dvec3(0.0556434, -0.2040259, 1.0572252), xyz));
        value += (rs - t) * glm::pow(r, dvec3(k)) * 2.0 * rgb;
    }
    return glm::clamp(value, dvec3(0), dvec3(1));
}

/// F and F̂ (SH-50, SH-51, SH-58).
void reflectances(const Layered& s, double c, dvec3& f, dvec3& hat)
{
    if (s.inside) {
        const double square = 1 - s.eta.y * s.eta.y * (1 - c * c);
        if (square < 0) {
            f = hat = dvec3(s.f90_d + s.m * (1 - s.f90_d));
            return;
        }
        c = std::sqrt(square);
    }
    dvec3 d = schlick(s.f0_d, s.f90_d, c), metal = schlick(s.b, 1, c);
    if (s.film > 0) {
        d = mixed(d, film_truth(s, c, s.f0_d), s.film);
        metal = mixed(metal, film_truth(s, c, s.b), s.film);
    }
    f = mixed(d, metal, s.m);
    hat = mixed(dvec3(max_of(d)), metal, s.m);
}

double ggx(double at, double ab, const dvec3& h)
{
    const double q = std::pow(h.x / at, 2) + std::pow(h.y / ab, 2) + h.z * h.z;
    return 1 / (kPi * at * ab * q * q);
}

double smith(double at, double ab, const dvec3& i, const dvec3& o)
{
    const auto stretched = [&](const dvec3& w) { return length(dvec3(at * w.x, ab * w.y, w.z)); };
    return 0.5 / (std::abs(i.z) * stretched(o) + std::abs(o.z) * stretched(i));
}

double sheen_truth(const Layered& s, const dvec3& wo, const dvec3& wi)
{
    const double alpha = std::pow(std::max(s.sheen_roughness, 0.07), 2), w = (1 - alpha) * (1 - alpha);
    const dvec3 h = normalize(wo + wi);
    const auto l = [&](double x) {
        const auto at = [&](double p1, double p0) { return p1 + w * (p0 - p1); };
        return at(21.5473, 25.3245) / (1 + at(3.82987, 3.32435) * std::pow(x, at(0.19823, 0.16801))) +
               at(-1.97760, -1.27393) * x + at(-4.32054, -4.85967);
    };
    const auto lambda = [&](double c) { return std::exp(c < 0.5 ? l(c) : 2 * l(0.5) - l(1 - c)); };
    const double d = (2 + 1 / alpha) * std::pow(1 - h.z * h.z, 0.5 / alpha) / (2 * kPi);
    return d / ((1 + lambda(wi.z) + lambda(wo.z)) * 4 * wo.z * wi.z);
}

/// f |n·wi| of (SH-50 … SH-62), the coat by its own cosine; E_s as path_glossy.comp has it.
dvec3 truth(const Layered& s, const dvec3& wo, const dvec3& wi)
{
    const bool up = dot(s.ng, wi) > 0;
    dvec3 value(0), f, hat;
    if (up == (wi.z > 0)) {
        const dvec3 folded(wi.x, wi.y, std::abs(wi.z)), h = normalize(wo + folded);
        reflectances(s, dot(wo, h), f, hat);
        const double facets = ggx(s.alpha_t, s.alpha_b, h) * smith(s.alpha_t, s.alpha_b, folded, wo);
        const dvec3 c = s.b * (1 - s.m);
        if (up) {
            value = ((1.0 - hat) * (1 - s.t) * (1 - s.g) * c / kPi + f * s.boost * facets) * wi.z;
        } else {
            value = (1.0 - hat) * (1 - s.t) * s.g * s.g_color * (1 - s.m) / kPi * -wi.z;
            if (s.eta.y == 0) value += (1.0 - hat) * s.t * c * facets * -wi.z;
            for (int i = 0; i < 3 && s.eta.y != 0; ++i) {
                const double n = s.inside ? 1 / s.eta[i] : s.eta[i];
                dvec3 ht = normalize(wo + n * wi);
                if (ht.z < 0) ht = -ht;
                const double oh = dot(wo, ht), ih = dot(wi, ht);
                if (oh <= 0 || ih >= 0) continue;
                reflectances(s, oh, f, hat);
                value[i] += (1 - hat[i]) * s.t * c[i] * ggx(s.alpha_t, s.alpha_b, ht) * 4 *
                            smith(s.alpha_t, s.alpha_b, wi, wo) * -wi.z * oh * -ih / std::pow(oh + n * ih, 2);
            }
        }
    }
    if (max_of(s.sheen) > 0) {
        const double e = shared::kTestAlbedo / s.sheen_roughness;
        value *= 1 - max_of(s.sheen) * std::min(e, 1.0);
        if (up && wi.z > 0) value += s.sheen * sheen_truth(s, wo, wi) / std::max(e, 1.0) * wi.z;
    }
    value *= 1 - s.coat;
    const double coat_i = dot(s.coat_n, wi), coat_o = dot(s.coat_n, wo);
    if (s.coat > 0 && up && coat_i > 0) {
        const double a2 = s.coat_alpha * s.coat_alpha, ch = dot(s.coat_n, normalize(wo + wi));
        const double d = a2 / (kPi * std::pow(ch * ch * (a2 - 1) + 1, 2));
        const double v = 0.5 / (coat_i * std::sqrt(coat_o * coat_o * (1 - a2) + a2) +
                                coat_o * std::sqrt(coat_i * coat_i * (1 - a2) + a2));
        value += s.coat * d * v * coat_i;
    }
    return value;
}

vec3 towards(double cosine, double turns)
{
    const double sine = std::sqrt(std::max(0.0, 1 - cosine * cosine));
    return vec3(dvec3(sine * std::cos(2 * kPi * turns), sine * std::sin(2 * kPi * turns), cosine));
}

GlossyCall call_of(const Layered& s)
{
    const dvec3 c = s.b * (1 - s.m);
    dvec3 excess(0);
    if (s.eta.y != 0) excess = s.inside ? 1.0 / s.eta - 1.0 : s.eta - 1.0;
    return {.wo = towards(s.cosine, 0.1),
            .diffuse = vec3((1 - s.t) * (1 - s.g) * c),
            .f0 = vec3(mixed(s.f0_d, s.b, s.m)),
            .hat0 = vec3(mixed(dvec3(max_of(s.f0_d)), s.b, s.m)),
            .f90 = float(s.f90_d + s.m * (1 - s.f90_d)),
            .boost = vec3(s.boost),
            .alpha = float(std::sqrt(s.alpha_t * s.alpha_b)),
            .alphas = vec2(dvec2(s.alpha_t, s.alpha_b)),
            .film = float(s.film),
            .film_ior = float(s.film_ior),
            .film_nanometres = float(s.film_nanometres),
            .film_base = vec3(s.f0_d),
            .film_specular = float(s.f90_d),
            .film_metal = vec3(s.b),
            .metallic = float(s.m),
            .diffuse_through = vec3((1 - s.t) * s.g * (1 - s.m) * s.g_color),
            .through = vec3(s.t * c),
            .body = s.eta.y != 0 ? 1u : 0u,
            .excess = vec3(excess),
            .inner = s.inside ? float(s.eta.y) : 0.f,
            .sheen = vec3(s.sheen),
            .sheen_roughness = float(s.sheen_roughness),
            .coat = float(s.coat),
            .coat_alpha = float(s.coat_alpha),
            .coat_n = vec3(s.coat_n),
            .ng = vec3(s.ng)};
}

std::vector<Layered> surfaces()
{
    std::vector<Layered> out;
    for (const double cosine : {0.9, 0.35}) {
        out.push_back({.why = "plain, with the energy of rough reflection", .boost = dvec3(1.1, 1.2, 1.3)});
        out.push_back({.why = "specular", .m = 0, .f0_d = dvec3(0.1, 0.3, 0.02), .f90_d = 0.6});
        out.push_back({.why = "anisotropy", .m = 1, .alpha_t = 0.6, .alpha_b = 0.15});
        out.push_back({.why = "iridescence", .m = 0.4, .film = 0.8, .film_ior = 1.4, .film_nanometres = 420});
        out.push_back({.why = "thin wall", .m = 0, .t = 0.7});
        out.push_back({.why = "leaf", .m = 0.1, .g = 0.6, .g_color = dvec3(0.2, 0.8, 0.1)});
        out.push_back({.why = "body from outside", .m = 0, .t = 0.9, .eta = dvec3(1.5)});
        out.push_back({.why = "body from inside", .m = 0, .t = 0.9, .eta = dvec3(1.5), .inside = true});
        out.push_back({.why = "dispersion", .m = 0, .t = 1, .eta = dvec3(1.45, 1.5, 1.55)});
        out.push_back({.why = "dispersion from inside", .m = 0, .t = 1, .eta = dvec3(1.45, 1.5, 1.55), .inside = true});
        out.push_back({.why = "sheen", .m = 0, .sheen = dvec3(0.4, 0.6, 0.2), .sheen_roughness = 0.5});
        out.push_back({.why = "sheen that gives back too much", .m = 0, .sheen = dvec3(0.3), .sheen_roughness = 0.2});
        out.push_back({.why = "coat", .coat = 0.3, .coat_alpha = 0.2});
        const dvec3 tilted = normalize(dvec3(0.3, -0.2, 1)), ground = normalize(dvec3(-0.2, 0.1, 1));
        out.push_back(
            {.why = "coat over another normal", .coat = 0.3, .coat_alpha = 0.2, .coat_n = tilted, .ng = ground});
        out.push_back({.why = "all at once",
                       .m = 0.2,
                       .f0_d = dvec3(0.1, 0.05, 0.2),
                       .f90_d = 0.8,
                       .alpha_t = 0.5,
                       .alpha_b = 0.3,
                       .boost = dvec3(1.1),
                       .film = 0.5,
                       .t = 0.4,
                       .g = 0.5,
                       .eta = dvec3(1.4, 1.5, 1.6),
                       .sheen = dvec3(0.2, 0.1, 0.3),
                       .coat = 0.2,
                       .coat_alpha = 0.3});
        for (Layered& s : out) s.cosine = s.cosine == 0.7 ? cosine : s.cosine;
    }
    return out;
}

class PathGlossy : public DeviceTest {
 protected:
    std::vector<GlossyResult> call(const std::vector<GlossyCall>& rows)
    {
        return run_kernel<GlossyResult>(device(), path_shaders::find("path_glossy.comp"), rows);
    }
    std::vector<GlossyResult> draw(const Layered& s, shared::uint count)
    {
        std::vector<GlossyCall> rows(count, call_of(s));
        for (shared::uint i = 0; i < count; ++i) {
            rows[i].sampled = 1;
            rows[i].index = i;
        }
        return call(rows);
    }
    /// Values at the centres of `side` × `side` cells of equal solid angle: cosine up, azimuth across.
    std::vector<GlossyResult> evaluate_on_grid(const Layered& s, int side)
    {
        std::vector<GlossyCall> rows;
        GlossyCall row = call_of(s);
        for (int y = 0; y < side; ++y)
            for (int x = 0; x < side; ++x) {
                row.wi = towards(2 * (y + 0.5) / side - 1, (x + 0.5) / side);
                rows.push_back(row);
            }
        return call(rows);
    }
};

TEST_F(PathGlossy, SH50_to_SH62_values_are_those_of_the_equations)
{
    for (const Layered& s : surfaces()) {
        std::vector<GlossyCall> rows;
        GlossyCall row = call_of(s);
        for (int y = 0; y < 40; ++y)
            for (int x = 0; x < 40; ++x) {
                row.wi = towards(2 * (y + 0.5) / 40 - 1, (x + 0.5) / 40);
                rows.push_back(row);
            }
        const std::vector<GlossyResult> got = call(rows);
        for (std::size_t i = 0; i < rows.size(); ++i) {
            const dvec3 expected = truth(s, dvec3(row.wo), dvec3(rows[i].wi));
            for (int c = 0; c < 3; ++c)
                ASSERT_NEAR(got[i].value[c], expected[c], 2e-5 + 2e-4 * expected[c])
                    << s.why << " at " << s.cosine << ", wi " << rows[i].wi.x << " " << rows[i].wi.y << " "
                    << rows[i].wi.z;
        }
    }
}

constexpr int kFine = 150;  // cells of the quadrature in each direction
constexpr shared::uint kDraws = 30000;

TEST_F(PathGlossy, SH64_samples_follow_their_density_and_carry_what_the_surface_gives_back)
{
    for (const Layered& s : surfaces()) {
        DirectionBins bins;
        dvec3 sum(0), square(0), exact(0);
        for (const GlossyResult& r : draw(s, kDraws)) {
            sum += dvec3(r.value);
            square += dvec3(r.value) * dvec3(r.value);
            if (!(r.pdf > 0)) continue;
            bins.add_draw(r.wi);
        }
        const std::vector<GlossyResult> grid = evaluate_on_grid(s, kFine);
        double total = 0;
        for (int y = 0; y < kFine; ++y)
            for (int x = 0; x < kFine; ++x) {
                const GlossyResult& r = grid[std::size_t(y * kFine + x)];
                const double p = r.pdf * 4 * kPi / (kFine * kFine);
                bins.add_expected(x, y, kFine, p * kDraws);
                total += p;
                exact += dvec3(r.value) * (4 * kPi / (kFine * kFine));
            }
        EXPECT_LT(total, 1.003) << s.why;
        // False alarms: one in 10^5 for each of the surfaces.
        EXPECT_GT(bins.p_value(), 1e-5) << s.why << " at " << s.cosine;
        for (int i = 0; i < 3; ++i) {
            const double mean = sum[i] / kDraws;
            const double error = std::sqrt(std::max(square[i] / kDraws - mean * mean, 0.0) / kDraws);
            // Five standard errors, and the quadrature's own error.
            EXPECT_NEAR(mean, exact[i], 5 * error + 3e-3 * exact[i]) << s.why << " at " << s.cosine;
        }
    }
}

TEST_F(PathGlossy, S29_a_body_of_index_one_lets_light_go_straight)
{
    const Layered s{.m = 0, .f0_d = dvec3(0), .t = 0.75, .eta = dvec3(1)};
    dvec3 straight(0);
    for (const GlossyResult& r : draw(s, 20000)) {
        if (r.pdf > 0 || r.value == vec3(0)) continue;
        EXPECT_LT(length(r.wi + towards(s.cosine, 0.1)), 1e-6);
        straight += dvec3(r.value) / 20000.0;
    }
    const double f = std::pow(1 - s.cosine, 5);
    for (int i = 0; i < 3; ++i) EXPECT_NEAR(straight[i], (1 - f) * 0.75 * s.b[i], 0.02 * s.b[i]);
}

TEST_F(PathGlossy, S9_values_are_finite_at_the_extremes)
{
    std::vector<GlossyCall> rows;
    for (Layered s : surfaces())
        for (const double alpha : {1e-3, 1.0})
            for (const double f0 : {0.0, 1.0})
                for (const double eta : {1.0, 1.0001, 2.5})
                    for (const double cosine : {1e-7, 1e-3, 1.0})
                        for (const double other : {-1.0, -1e-7, 0.0, 1e-30, 1e-7, 1.0}) {
                            s.alpha_t = s.alpha_b = s.coat_alpha = alpha;
                            s.f0_d = dvec3(f0);
                            s.cosine = cosine;
                            s.film_nanometres = alpha == 1 ? 1e30 : 1e-3;
                            s.sheen_roughness = alpha == 1 ? 1 : 0.07;
                            if (s.eta.y != 0) s.eta = dvec3(eta);
                            GlossyCall row = call_of(s);
                            row.wi = towards(other, 0.6);
                            rows.push_back(row);
                            row.sampled = 1;
                            row.index = static_cast<shared::uint>(rows.size());
                            rows.push_back(row);
                        }
    const std::vector<GlossyResult> got = call(rows);
    for (std::size_t i = 0; i < rows.size(); ++i) {
        ASSERT_TRUE(is_finite(dvec3(got[i].value)) && std::isfinite(got[i].pdf)) << i;
        ASSERT_TRUE(got[i].value.x >= 0 && got[i].pdf >= 0) << i;
    }
}

/// Finer quadratures than those that fill the tables, by other variables.
double ggx_albedo_truth(double c, double alpha)
{
    double sum = 0;
    constexpr int kU = 500, kPhi = 64;
    const double so = std::sqrt(1 - c * c);
    const auto lambda = [&](double x) { return (std::sqrt(1 + alpha * alpha * (1 / (x * x) - 1)) - 1) / 2; };
    for (int i = 0; i < kU; ++i)
        for (int j = 0; j < kPhi; ++j) {
            const double v = (i + 0.5) / kU, u = 1 - v * v, phi = 2 * kPi * (j + 0.5) / kPhi;
            dvec3 o(alpha * so, 0, c);
            o /= length(o);
            const double z = 1 - u * (1 + o.z), r = std::sqrt(std::max(0.0, 1 - z * z));
            const dvec3 cap = dvec3(r * std::cos(phi), r * std::sin(phi), z) + o;
            const dvec3 h = normalize(dvec3(alpha * cap.x, alpha * cap.y, cap.z));
            const double cos_i = 2 * (so * h.x + c * h.z) * h.z - c;
            if (cos_i > 0) sum += 2 * v * (1 + lambda(c)) / (1 + lambda(c) + lambda(cos_i));
        }
    return sum / (kU * kPhi);
}

double sheen_albedo_truth(double c, double r)
{
    Layered s;
    s.sheen_roughness = r;
    double sum = 0;
    constexpr int kV = 200, kPhi = 64;
    const dvec3 wo(std::sqrt(1 - c * c), 0, c);
    for (int i = 0; i < kV; ++i)
        for (int j = 0; j < kPhi; ++j) {
            const double v = (i + 0.5) / kV, z = v * v, phi = 2 * kPi * (j + 0.5) / kPhi, sine = std::sqrt(1 - z * z);
            sum += 2 * v * z * sheen_truth(s, wo, dvec3(sine * std::cos(phi), sine * std::sin(phi), z));
        }
    return sum * 2 * kPi / (kV * kPhi);
}

TEST_F(PathGlossy, SH53_SH61_tables_are_exact_to_one_thousandth)
{
    const std::vector<vec4> cells = make_albedo_cells(true, 2);
    ASSERT_EQ(cells.size(), std::size_t{shared::kAlbedoCells});
    std::vector<vec4> rows = cells;
    for (double c : {1e-4, 4e-4, 1.7e-3, 6e-3, 0.013, 0.04, 0.09, 0.17, 0.31, 0.53, 0.77, 0.94, 1.0})
        for (const double y : {0.0, 0.013, 0.049, 0.11, 0.23, 0.37, 0.61, 0.83, 1.0})
            rows.push_back(vec4(dvec4(c, 1e-3 + 0.999 * y, 0.07 + 0.93 * y, 0)));
    const std::vector<vec4> got = run_kernel<vec4>(device(), path_shaders::find("path_albedo.comp"), rows);
    for (std::size_t i = cells.size(); i < rows.size(); ++i) {
        EXPECT_NEAR(got[i].x, ggx_albedo_truth(rows[i].x, rows[i].y), 1e-3) << rows[i].x << " " << rows[i].y;
        const double sheen = sheen_albedo_truth(rows[i].x, rows[i].z);
        EXPECT_NEAR(got[i].y, sheen, 1e-3 * std::max(1.0, sheen)) << rows[i].x << " " << rows[i].z;
    }
}

}  // namespace
}  // namespace etalon::test
