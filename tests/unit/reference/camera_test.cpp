#include "engine/reference/camera.h"

#include <gtest/gtest.h>

#include "engine/math/stats.h"
#include "tests/unit/reference/random.h"

namespace etalon::reference {
namespace {

View view_of(const Camera& camera)
{
    return {.width = 200, .height = 100, .world_from_camera = dmat4(1), .camera = camera};
}

TEST(CameraRays, TF_9_equirectangular_pixels_see_every_direction_once)
{
    Camera camera;
    camera.equirectangular = true;
    camera.lens = ThinLens{.aperture_radius = 1};
    const CameraRays rays(view_of(camera));
    EXPECT_FALSE(rays.has_lens());
    const auto expect = [&](double x, double y, dvec3 direction) {
        const Ray ray = rays.pinhole({x, y});
        EXPECT_LT(length(ray.direction - direction), 1e-12) << x << " " << y;
        EXPECT_EQ(ray.origin, dvec3(0));
    };
    expect(100, 50, dvec3(0, 0, -1));
    expect(150, 50, dvec3(1, 0, 0));
    expect(50, 50, dvec3(-1, 0, 0));
    expect(0, 50, dvec3(0, 0, 1));
    expect(30, 0, dvec3(0, 1, 0));
    expect(70, 100, dvec3(0, -1, 0));
    expect(100, 25, normalize(dvec3(0, 1, -1)));
    EXPECT_NEAR(rays.depth(dvec3(0, 3, 4)), 5, 1e-12);
}

TEST(CameraRays, TF_8_apertures_are_filled_evenly)
{
    constexpr int kPoints = 60000;
    for (const int blades : {0, 3, 4, 5, 8}) {
        Camera camera;
        camera.lens = ThinLens{.aperture_radius = 0.1, .focus_distance = 2, .blades = blades};
        const CameraRays rays(view_of(camera));
        test::Random random(7);
        // Cells of a square; those that the edge cuts hold what is left of them, and are not counted.
        constexpr int kCells = 10;
        std::vector<double> counts(kCells * kCells);
        const double inner = blades < 3 ? 1 : std::cos(kPi / blades);
        for (int i = 0; i < kPoints; ++i) {
            const dvec2 p = rays.sample_aperture(random.square());
            for (int k = 0; k < blades; ++k) {  // the middle of each edge is `inner` away
                const double angle = 2 * kPi * (k + 0.5) / blades;
                ASSERT_LE(p.x * std::cos(angle) + p.y * std::sin(angle), inner + 1e-12) << blades;
            }
            ASSERT_LE(length(p), 1 + 1e-12);
            const int x = int((p.x + 1) / 2 * kCells), y = int((p.y + 1) / 2 * kCells);
            ++counts[std::size_t(y * kCells + x)];
        }
        const double area = blades < 3 ? kPi : blades * std::sin(2 * kPi / blades) / 2;
        const double expected = kPoints * (4.0 / (kCells * kCells)) / area;
        double sum = 0;
        int cells = 0;
        for (int y = 0; y < kCells; ++y)
            for (int x = 0; x < kCells; ++x) {
                const auto at = [&](int i) { return 2.0 * i / kCells - 1; };
                bool inside = true;
                for (const dvec2 corner : {dvec2(at(x), at(y)), dvec2(at(x + 1), at(y)), dvec2(at(x), at(y + 1)),
                                           dvec2(at(x + 1), at(y + 1))})
                    for (int k = 0; k < std::max(blades, 1); ++k) {
                        const double angle = 2 * kPi * (k + 0.5) / blades;
                        inside =
                            inside && (blades < 3 ? length(corner) < 1
                                                  : corner.x * std::cos(angle) + corner.y * std::sin(angle) < inner);
                    }
                if (!inside) continue;
                const double difference = counts[std::size_t(y * kCells + x)] - expected;
                sum += difference * difference / expected;
                ++cells;
            }
        EXPECT_GT(cells, 8) << blades;
        EXPECT_GT(chi_square_p(sum, cells), 1e-6) << blades;
    }
}

}  // namespace
}  // namespace etalon::reference
