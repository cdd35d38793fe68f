#include "engine/reference/layers_lobes.h"

#include <gtest/gtest.h>

#include <cmath>

#include "engine/reference/bsdf.h"
#include "engine/reference/layers_albedo.h"
#include "tests/unit/reference/random.h"
#include "tests/unit/reference/sphere_integral.h"

namespace etalon::reference {
namespace {

using test::integrate;
using test::Random;

TEST(LayersLobes, SH_52_with_both_alphas_alike_it_is_the_isotropic_distribution)
{
    Random random(81);
    for (const double alpha : {1e-3, 0.1, 1.0})
        for (int i = 0; i < 200; ++i) {
            const dvec3 a = random.upper_direction(), b = random.upper_direction();
            EXPECT_NEAR(ggx_d(a, dvec2(alpha)) / ggx_d(a, alpha), 1, 1e-12);
            EXPECT_NEAR(ggx_v(a, b, dvec2(alpha)) / ggx_v(a.z, b.z, alpha), 1, 1e-12);
            EXPECT_NEAR(ggx_g1(a, dvec2(alpha)) / ggx_g1(a.z, alpha), 1, 1e-12);
        }
}

TEST(LayersLobes, SH_52_an_anisotropic_distribution_is_normalized_over_projected_area)
{
    for (const dvec2 alpha : {dvec2(0.5, 0.2), dvec2(1, 0.3), dvec2(0.3, 0.9)})
        EXPECT_NEAR(integrate({0, 0, 1}, [&](const dvec3& h) { return h.z > 0 ? ggx_d(h, alpha) * h.z : 0; }), 1, 2e-3);
    // Long along y: tilting the half vector towards y costs less.
    EXPECT_GT(ggx_d(normalize(dvec3(0, 0.3, 1)), {0.1, 0.5}), 10 * ggx_d(normalize(dvec3(0.3, 0, 1)), {0.1, 0.5}));
}

TEST(LayersLobes, SH_52_masking_is_what_projected_areas_ask_for)
{
    // Σ over the visible normals of their projected area is that of the plane: n·wo (Smith; Heitz 2014, eq. 35).
    Random random(82);
    const dvec2 alpha(0.7, 0.25);
    for (int i = 0; i < 5; ++i) {
        const dvec3 wo = random.upper_direction();
        const double visible = integrate({0, 0, 1}, [&](const dvec3& h) {
            return h.z > 0 ? ggx_g1(wo, alpha) * std::max(0.0, dot(wo, h)) * ggx_d(h, alpha) : 0;
        });
        EXPECT_NEAR(visible, wo.z, 3e-3);
    }
}

TEST(LayersLobes, SH_61_sheen_is_normalized_and_falls_off_towards_the_normal)
{
    for (const double alpha : {0.07 * 0.07, 0.25, 1.0}) {
        const double area = integrate({0, 0, 1}, [&](const dvec3& h) { return h.z > 0 ? sheen_d(h, alpha) * h.z : 0; });
        EXPECT_NEAR(area, 1, 2e-3) << alpha;
        EXPECT_EQ(sheen_d({0, 0, 1}, alpha), 0);
        EXPECT_TRUE(std::isfinite(sheen_v(1e-9, 1, alpha)));
        EXPECT_TRUE(std::isfinite(sheen_v(1, 1, alpha)));
        EXPECT_NEAR(sheen_v(0.2, 0.9, alpha), sheen_v(0.9, 0.2, alpha), 1e-14 * sheen_v(0.2, 0.9, alpha));
    }
}

TEST(LayersAlbedo, SH_53_the_share_is_the_integral_of_the_lobe)
{
    for (const double alpha : {0.15, 0.5, 1.0})
        for (const double c : {0.1, 0.5, 1.0}) {
            const dvec3 wo(std::sqrt(1 - c * c), 0, c);
            const double direct = integrate(wo, [&](const dvec3& wi) {
                if (wi.z <= 0) return 0.0;
                return ggx_d(normalize(wo + wi), alpha) * ggx_v(wo.z, wi.z, alpha) * wi.z;
            });
            EXPECT_NEAR(ggx_share(c, alpha), direct, 1e-3) << c << " " << alpha;
        }
    EXPECT_NEAR(ggx_share(1, 1e-3), 1, 1e-4);
}

TEST(LayersAlbedo, SH_61_the_share_of_sheen_is_the_integral_of_its_lobe)
{
    for (const double alpha : {0.07 * 0.07, 0.25, 1.0})
        for (const double c : {0.05, 0.4, 1.0}) {
            const dvec3 wo(std::sqrt(1 - c * c), 0, c);
            const double direct = integrate(wo, [&](const dvec3& wi) {
                return wi.z > 0 ? sheen_d(normalize(wo + wi), alpha) * sheen_v(wo.z, wi.z, alpha) * wi.z : 0;
            });
            EXPECT_NEAR(sheen_share(c, alpha), direct, 2e-3) << c << " " << alpha;
        }
}

TEST(LayersAlbedo, a_table_is_the_function_it_was_made_of_within_its_promise)
{
    Random random(83);
    for (const Tabulated* what : {&kGgxShare, &kSheenShare}) {
        const double low = what->lowest_alpha;
        const ShareTable sparse(*what, {low, low}), middle(*what, {0.3, 0.3});
        EXPECT_NEAR(middle(0.5, 0.3), what->function(0.5, 0.3), 1e-3);
        for (int i = 0; i < 60; ++i) {
            const double c = std::max(1e-3, random.uniform() * random.uniform());
            EXPECT_NEAR(sparse(c, low), what->function(c, low), 1e-3) << c;
            EXPECT_NEAR(middle(c, 0.3), what->function(c, 0.3), 1e-3) << c;
        }
        for (const double c : {0.0, 1.0}) EXPECT_TRUE(std::isfinite(sparse(c, low)));
    }
    EXPECT_EQ(ShareTable()(0.3, 0.5), 1);
}

}  // namespace
}  // namespace etalon::reference
