#include <array>
#include <cmath>
#include <iostream>

#include "engine/reference/reference.h"
#include "tests/gpu/raster_stage.h"

namespace etalon::test {
namespace {

class RasterDepth : public DeviceTest {};

constexpr int kDecades = 10;     // from the near plane to a thousand million times as far
constexpr double kNear = 1e-3;   // metres
constexpr double kApart = 1e-4;  // of their distance

/// One column of the picture for each decade: a red wall, and a green one before it, drawn after it.
Scene walls()
{
    SceneBuilder scene("walls");
    const Index red = scene.material(unlit({1, 0, 0, 1})), green = scene.material(unlit({0, 1, 0, 1}));
    for (int i = 0; i < kDecades; ++i) {
        const double front = 2 * kNear * std::pow(10.0, i * 8.69 / (kDecades - 1));
        for (const bool near : {false, true}) {
            const double d = near ? front : front * (1 + kApart);
            // The view is square and 90 degrees wide: at distance d it is 2 d wide.
            const double half = d / kDecades, middle = d * ((2.0 * i + 1) / kDecades - 1);
            scene.show(near ? "front" : "back", make_rectangle({middle, 0, -d}, {0.9 * half, 0, 0}, {0, d, 0}),
                       near ? green : red);
        }
    }
    Camera camera;
    camera.yfov = kPi / 2;
    camera.znear = kNear;
    scene.camera(camera, dmat4(1));
    return std::move(scene).finish();
}

/// Of each decade, the share of pixels where the near wall does not show.
std::array<double, kDecades> wrong(const Film& film)
{
    std::array<double, kDecades> out{};
    for (int i = 0; i < kDecades; ++i) {
        int red = 0, all = 0;
        for (int y = 0; y < film.height; ++y)
            for (int x = film.width * (10 * i + 2) / (10 * kDecades); x < film.width * (10 * i + 8) / (10 * kDecades);
                 ++x) {
                const vec3 pixel = film.mean[std::size_t(y * film.width + x)];
                red += pixel.y < 0.5f;  // red, or nothing at all where depth rounds to that of nothing
                ++all;
            }
        out[std::size_t(i)] = double(red) / all;
    }
    return out;
}

TEST_F(RasterDepth, G7_surfaces_near_one_another_keep_their_order_as_far_as_the_theory_has_it)
{
    const Scene scene = walls();
    PoseSettings view{.size = ivec2(100)};
    view.no_environment = true;
    const PosedScene posed = pose(scene, view);
    struct Kind {
        DepthKind depth;
        const char* name;
        double step;  // of depth near 1
    };
    for (const Kind& kind :
         {Kind{DepthKind::reversed_32, "reversed-32", 0}, Kind{DepthKind::forward_32, "forward-32", std::exp2(-24)},
          Kind{DepthKind::forward_24, "forward-24", std::exp2(-24)},
          Kind{DepthKind::forward_16, "forward-16", std::exp2(-16)}}) {
        RenderSettings settings;
        settings.depth = kind.depth;
        settings.msaa = 1;
        const Requirements required = require(posed, settings);
        const auto device = wrong(render_raster(this->device(), posed, required, settings, {}));
        const auto reference = wrong(reference::render_raster(posed, required, settings, {}));
        int blind = 0,
            mixed = 0;  // decades beyond the theory's reach, and those of them where the nearer wall does not show
        std::cout << kind.name << ": share of pixels in which the nearer wall does not show, by decade:";
        for (int i = 0; i < kDecades; ++i) {
            const double distance = 2 * kNear * std::pow(10.0, i * 8.69 / (kDecades - 1));
            const double between = kNear * kApart / distance;  // (TF-7)
            const auto at = std::size_t(i);
            std::cout << ' ' << device[at];
            for (const double share : {device[at], reference[at]}) {
                if (between > 8 * kind.step) {
                    EXPECT_EQ(share, 0) << kind.name << " at " << distance;
                }
                if (between < kind.step / 100) {
                    ++blind;
                    mixed += share > 0;
                }
            }
        }
        std::cout << std::endl;
        // Two depths a hundredth of a step apart are mostly, not always, rounded alike.
        EXPECT_GE(mixed, blind / 2) << kind.name;
        EXPECT_EQ(blind == 0, kind.depth == DepthKind::reversed_32);
    }
}

TEST_F(RasterDepth, forward_depth_draws_the_same_picture_where_it_is_fine_enough)
{
    for (const bool orthographic : {false, true}) {
        SceneBuilder scene("things");
        scene.show("wall", make_rectangle({0, 0, -1}, {3, 0, 0}, {0, 3, 0}), scene.lambert("wall", dvec3(0.5)));
        scene.sphere("ball", {0.3, 0, 0}, 0.5, scene.lambert("ball", dvec3(0.8)));
        scene.show("box", make_box({-0.5, 0, 0}, dvec3(0.3), 0.4), scene.lambert("box", dvec3(0.2)));
        scene.environment(constant_environment(dvec3(1)));
        Camera camera;
        camera.orthographic = orthographic;
        scene.camera(camera, translation({0, 0, 3}));
        const Scene whole = std::move(scene).finish();
        const PosedScene posed = pose(whole, {.size = ivec2(40, 30)});
        RenderSettings settings;
        const Film reversed = render_raster(device(), posed, require(posed, settings), settings, {});
        for (const DepthKind kind : {DepthKind::forward_32, DepthKind::forward_24, DepthKind::forward_16}) {
            settings.depth = kind;
            const Film forward = render_raster(device(), posed, require(posed, settings), settings, {});
            int differ = 0;
            for (std::size_t i = 0; i < forward.pixel_count(); ++i) differ += forward.mean[i] != reversed.mean[i];
            EXPECT_LE(differ, kind == DepthKind::forward_16 ? 12 : 2) << int(kind) << " orthographic " << orthographic;
        }
    }
}

}  // namespace
}  // namespace etalon::test
