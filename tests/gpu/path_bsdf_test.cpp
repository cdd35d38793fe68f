// The BSDFs' samplers draw what their densities say, and carry the light that the BSDFs reflect. Statistical tests with
// fixed seeds; the false-alarm rate of each is stated.
#include "tests/gpu/path_bsdf.h"

#include <cmath>

#include "path_shaders.h"
#include "shaders/shared/material.h"
#include "tests/gpu/device_test.h"
#include "tests/gpu/direction_bins.h"

namespace etalon::test {
namespace {

using shared::BsdfCall;
using shared::BsdfResult;

struct Case {
    const char* why;
    BsdfCall bsdf;
};

vec3 towards(double cosine, double turns)
{
    const double sine = std::sqrt(1 - cosine * cosine);
    return vec3(dvec3(sine * std::cos(2 * kPi * turns), sine * std::sin(2 * kPi * turns), cosine));
}

BsdfCall call_of(shared::uint model, double alpha, double cosine)
{
    BsdfCall out{};
    out.model = model;
    out.alpha = float(alpha);
    out.diffuse = vec3(0.7f, 0.5f, 0.2f);
    out.f0 = vec3(0.04f, 0.3f, 0.9f);
    out.eta = vec3(0.2f, 1.1f, 1.5f);
    out.k = vec3(3.9f, 2.5f, 1.9f);
    out.wo = towards(cosine, 0.1);
    return out;
}

std::vector<Case> cases()
{
    std::vector<Case> out;
    for (const double cosine : {0.95, 0.3}) {
        out.push_back({"lambert", call_of(shared::kModelLambert, 1, cosine)});
        out.push_back({"metallic-roughness, rough", call_of(shared::kModelMetallicRoughness, 0.5, cosine)});
        out.push_back({"metallic-roughness, glossy", call_of(shared::kModelMetallicRoughness, 0.15, cosine)});
        out.push_back({"rough conductor", call_of(shared::kModelRoughConductor, 0.3, cosine)});
        out.push_back({"rough dielectric from outside", call_of(shared::kModelRoughDielectric, 0.3, cosine)});
        out.back().bsdf.excess = 0.5f;
        out.push_back({"rough dielectric from inside", call_of(shared::kModelRoughDielectric, 0.3, cosine)});
        out.back().bsdf.excess = -1.f / 3;
    }
    return out;
}

class PathBsdf : public DeviceTest {
 protected:
    std::vector<BsdfResult> call(const std::vector<BsdfCall>& rows)
    {
        return run_kernel<BsdfResult>(device(), path_shaders::find("path_bsdf.comp"), rows);
    }
    std::vector<BsdfResult> draw(BsdfCall bsdf, shared::uint count)
    {
        bsdf.sampled = 1;
        std::vector<BsdfCall> rows(count, bsdf);
        for (shared::uint i = 0; i < count; ++i) rows[i].index = i;
        return call(rows);
    }
    /// Values at the centres of `side` × `side` cells of equal solid angle: cosine up, azimuth across.
    std::vector<BsdfResult> evaluate_on_grid(BsdfCall bsdf, int side)
    {
        bsdf.sampled = 0;
        std::vector<BsdfCall> rows;
        for (int y = 0; y < side; ++y)
            for (int x = 0; x < side; ++x) {
                bsdf.wi = towards(2 * (y + 0.5) / side - 1, (x + 0.5) / side);
                rows.push_back(bsdf);
            }
        return call(rows);
    }
};

constexpr int kFine = 250;  // cells of the quadrature in each direction
constexpr shared::uint kDraws = 50000;

TEST_F(PathBsdf, S15_S16_samples_follow_their_density)
{
    for (const Case& c : cases()) {
        DirectionBins bins;
        double drawn = 0;
        for (const BsdfResult& r : draw(c.bsdf, kDraws)) {
            if (r.value == vec3(0)) continue;
            bins.add_draw(r.wi);
            ++drawn;
        }
        const std::vector<BsdfResult> grid = evaluate_on_grid(c.bsdf, kFine);
        double total = 0;
        for (int y = 0; y < kFine; ++y)
            for (int x = 0; x < kFine; ++x) {
                const double p = grid[std::size_t(y * kFine + x)].pdf * 4 * kPi / (kFine * kFine);
                bins.add_expected(x, y, kFine, p * kDraws);
                total += p;
            }
        EXPECT_LT(total, 1.002) << c.why;
        // Samples below the surface are not drawn again: their share is missing from both.
        EXPECT_NEAR(drawn / kDraws, total, 0.006) << c.why << " " << c.bsdf.wo.z;
        // False alarms: one in 10^5 for each of the twelve cases.
        EXPECT_GT(bins.p_value(), 1e-5) << c.why << " at cosine " << c.bsdf.wo.z;
    }
}

TEST_F(PathBsdf, sampled_weights_carry_what_the_bsdf_reflects)
{
    for (const Case& c : cases()) {
        dvec3 sum(0), square(0), exact(0);
        for (const BsdfResult& r : draw(c.bsdf, kDraws)) {
            sum += dvec3(r.value);
            square += dvec3(r.value) * dvec3(r.value);
        }
        for (const BsdfResult& r : evaluate_on_grid(c.bsdf, kFine))
            exact += dvec3(r.value) * (4 * kPi / (kFine * kFine));
        for (int i = 0; i < 3; ++i) {
            const double mean = sum[i] / kDraws;
            const double error = std::sqrt(std::max(square[i] / kDraws - mean * mean, 0.0) / kDraws);
            // Five standard errors, and the quadrature's own error: 1e-3.
            EXPECT_NEAR(mean, exact[i], 5 * error + 1e-3 * exact[i]) << c.why << " at cosine " << c.bsdf.wo.z;
            // Out of the denser side radiance grows by the squared index.
            const double most = std::max(1.0, std::pow(1 + double(c.bsdf.excess), -2));
            EXPECT_LE(exact[i], 1.001 * most) << c.why << " reflects more than it gets";
        }
    }
}

TEST_F(PathBsdf, S10_delta_lobes_share_the_light_and_index_one_bends_nothing)
{
    BsdfCall glass = call_of(shared::kModelDielectric, 0, 0.6);
    glass.excess = 0.5f;
    double reflected = 0;
    for (const BsdfResult& r : draw(glass, 20000)) {
        EXPECT_EQ(r.pdf, 0);
        reflected += r.wi.z > 0;
        if (r.wi.z > 0) continue;
        EXPECT_NEAR(r.value.x, 1 / 2.25, 1e-6) << "radiance is scaled by the squared index";
        EXPECT_NEAR(length(vec3(r.wi.x, r.wi.y, 0)), 0.8 / 1.5, 1e-6) << "Snell";
    }
    const double c = 0.6, ct = std::sqrt(1 - 0.64 / 2.25);
    const double s = (c - 1.5 * ct) / (c + 1.5 * ct), p = (1.5 * c - ct) / (1.5 * c + ct);
    const double truth = (s * s + p * p) / 2;
    EXPECT_NEAR(reflected / 20000, truth, 5 * std::sqrt(truth * (1 - truth) / 20000));

    for (const shared::uint model : {shared::kModelDielectric, shared::kModelRoughDielectric}) {
        BsdfCall air = call_of(model, 0.2, 0.6);
        for (const BsdfResult& r : draw(air, 100)) {
            EXPECT_LT(length(r.wi + air.wo), 1e-6);
            EXPECT_EQ(r.value, vec3(1));
        }
    }
    for (const BsdfResult& r : draw(call_of(shared::kModelMirror, 0, 0.6), 100)) {
        EXPECT_NEAR(r.wi.z, 0.6, 1e-7);
        EXPECT_EQ(r.value, vec3(0.7f, 0.5f, 0.2f));
    }
}

TEST_F(PathBsdf, S9_values_are_finite_at_grazing_angles_and_for_sharp_peaks)
{
    std::vector<BsdfCall> rows;
    for (const shared::uint model : {shared::kModelMetallicRoughness, shared::kModelLambert,
                                     shared::kModelRoughConductor, shared::kModelRoughDielectric})
        for (const double alpha : {1e-4, 1e-3, 0.1, 1.0})
            for (const double cosine : {1e-7, 1e-3, 0.5, 1.0})
                for (const double other : {-1.0, -1e-7, 1e-7, 0.5, 1.0}) {
                    BsdfCall bsdf = call_of(model, alpha, cosine);
                    bsdf.excess = 0.5f;
                    bsdf.wi = towards(other, 0.6);
                    rows.push_back(bsdf);
                    bsdf.sampled = 1;
                    bsdf.index = static_cast<shared::uint>(rows.size());
                    rows.push_back(bsdf);
                }
    const std::vector<BsdfResult> got = call(rows);
    for (std::size_t i = 0; i < rows.size(); ++i) {
        EXPECT_TRUE(is_finite(dvec3(got[i].value)) && std::isfinite(got[i].pdf)) << i;
        EXPECT_TRUE(got[i].value.x >= 0 && got[i].pdf >= 0) << i;
        if (rows[i].sampled == 1) {
            EXPECT_LE(got[i].value.x, 20) << "no sample outweighs the others";
        }
    }
}

}  // namespace
}  // namespace etalon::test
