// What the viewer is made of, without a window: its camera, and developing on the device.
#include "engine/gpu/commands.h"
#include "engine/image/develop.h"
#include "samples/viewer/display.h"
#include "samples/viewer/orbit_camera.h"
#include "tests/gpu/device_test.h"

namespace etalon::test {
namespace {

const dvec3 kLow(-1, -2, -3);
const dvec3 kHigh(3, 2, 1);
const dvec3 kMiddle(1, 0, -1);

View first_view()
{
    View view{.width = 400, .height = 300};
    view.world_from_camera[3] = dvec4(1, 0, 9, 1);  // straight at the middle, 10 m away
    return view;
}

dvec3 eye(const View& view)
{
    return dvec3(view.world_from_camera[3]);
}
dvec3 forward(const View& view)
{
    return -dvec3(view.world_from_camera[2]);
}

TEST(OrbitCamera, starts_with_the_view_it_was_given)
{
    const OrbitCamera camera(first_view(), kLow, kHigh);
    const View view = camera.view(ivec2(400, 300));
    for (int column = 0; column < 4; ++column)
        EXPECT_LT(length(dvec3(view.world_from_camera[column] - first_view().world_from_camera[column])), 1e-12);
}

TEST(OrbitCamera, keeps_its_distance_and_its_axes_however_long_it_is_turned)
{
    OrbitCamera camera(first_view(), kLow, kHigh);
    for (int i = 0; i < 10'000; ++i) camera.orbit(0.013, 0.007 * (i % 5 - 2));
    const View view = camera.view(ivec2(400, 300));
    EXPECT_NEAR(length(eye(view) - kMiddle), 10, 1e-9);
    EXPECT_LT(length(normalize(kMiddle - eye(view)) - forward(view)), 1e-9);
    const dmat3 axes(view.world_from_camera);
    for (int i = 0; i < 3; ++i)
        for (int k = 0; k < 3; ++k) EXPECT_NEAR(dot(axes[i], axes[k]), i == k ? 1 : 0, 1e-12);
}

TEST(OrbitCamera, does_not_go_over_the_poles)
{
    OrbitCamera camera(first_view(), kLow, kHigh);
    for (int i = 0; i < 300; ++i) camera.orbit(0, 0.01);
    EXPECT_GE(camera.view(ivec2(400, 300)).world_from_camera[1].y, 0);
    EXPECT_GT(eye(camera.view(ivec2(400, 300))).y, 9.5) << "it went up to the pole";
    for (int i = 0; i < 300; ++i) camera.orbit(0, -0.01);
    EXPECT_GE(camera.view(ivec2(400, 300)).world_from_camera[1].y, 0);
    EXPECT_LT(eye(camera.view(ivec2(400, 300))).y, -9.5);
}

TEST(OrbitCamera, a_pan_follows_the_pointer)
{
    OrbitCamera camera(first_view(), kLow, kHigh);
    camera.pan(0.25, 0.5);
    const View view = camera.view(ivec2(400, 300));
    const double height = 2 * 10 * std::tan(view.camera.yfov / 2);  // metres seen where it looks at
    EXPECT_LT(length(eye(view) - (dvec3(1, 0, 9) + dvec3(-0.25 * height, 0.5 * height, 0))), 1e-12);
}

TEST(OrbitCamera, never_zooms_through_its_target_or_out_of_sight)
{
    OrbitCamera camera(first_view(), kLow, kHigh);
    for (int i = 0; i < 10'000; ++i) camera.zoom(1);
    EXPECT_GT(dot(kMiddle - eye(camera.view(ivec2(4, 3))), dvec3(0, 0, -1)), 0);
    for (int i = 0; i < 10'000; ++i) camera.zoom(-1);
    EXPECT_LT(length(eye(camera.view(ivec2(4, 3)))), 1e6);
}

TEST(OrbitCamera, frames_the_bounds_in_any_aspect)
{
    for (const bool orthographic : {false, true})
        for (const double aspect : {0.2, 1.0, 5.0}) {
            View start = first_view();
            start.camera.orthographic = orthographic;
            OrbitCamera camera(start, kLow, kHigh);
            camera.orbit(0.2, 0.1);
            camera.frame(aspect);
            const View view = camera.view(ivec2(int(1000 * aspect), 1000));
            const double radius = length(kHigh - kLow) / 2;
            const double tangent = std::tan(view.camera.yfov / 2);
            const double distance = length(kMiddle - eye(view));
            // The bounding sphere touches the nearer pair of the view's sides and crosses none.
            const double half = std::atan(tangent * std::min(aspect, 1.0));
            if (orthographic)
                EXPECT_NEAR(std::min(view.camera.xmag, view.camera.ymag), radius, 1e-9);
            else
                EXPECT_NEAR(distance * std::sin(half), radius, 1e-9) << aspect;
        }
}

using DeviceDisplay = DeviceTest;

TEST_F(DeviceDisplay, develops_as_the_host_does)
{
    constexpr int kWidth = 64;
    constexpr int kHeight = 33;
    Film film{.width = kWidth, .height = kHeight};
    std::vector<float> texels;
    for (int i = 0; i < kWidth * kHeight; ++i) {
        const float value = std::exp2(float(i % kWidth) / 4 - 12);  // 2^-12 … 2^4
        film.mean.push_back(value * vec3(1, 1 - float(i) / (kWidth * kHeight), float(i % 7) / 6));
        film.alpha.push_back(1);
        for (int c = 0; c < 3; ++c) texels.push_back(film.mean.back()[c]);
        texels.push_back(1);
    }
    gpu::Image picture(device(), {.format = VK_FORMAT_R32G32B32A32_SFLOAT,
                                  .width = kWidth,
                                  .height = kHeight,
                                  .usage = VK_IMAGE_USAGE_SAMPLED_BIT,
                                  .name = "film"});
    const gpu::ImagePart all{.texels = std::as_bytes(std::span(texels))};
    gpu::upload(device(), picture, std::span(&all, 1));
    for (const Tone tone : {Tone::none, Tone::aces, Tone::neutral, Tone::reinhard, Tone::agx})
        for (const double exposure : {-2.0, 0.0, 1.5}) {
            const DevelopSettings settings{.exposure = exposure, .tone = tone};
            const Image host = develop(film, settings);
            const Image shown = develop_on(device(), picture, settings);
            for (std::size_t i = 0; i < host.values.size(); ++i)  // half a code of rounding, and pow in float
                ASSERT_NEAR(shown.values[i], host.values[i], 0.6 / 255) << "value " << i << ", tone " << int(tone);
        }
}

TEST_F(DeviceDisplay, shows_what_is_not_finite_and_what_is_not_there)
{
    const float inf = std::numeric_limits<float>::infinity();
    const std::vector<float> texels = {inf, 0, 0, 1, 0, std::nanf(""), 0, 1, 0, 0, 0, 0, 0.5f, 0.5f, 0.5f, 0.5f};
    gpu::Image picture(device(), {.format = VK_FORMAT_R32G32B32A32_SFLOAT, .width = 4, .height = 1, .name = "film"});
    const gpu::ImagePart all{.texels = std::as_bytes(std::span(texels))};
    gpu::upload(device(), picture, std::span(&all, 1));
    const Image shown = develop_on(device(), picture, {});
    for (int x = 0; x < 2; ++x) {
        EXPECT_EQ(shown.at(x, 0, 0), 1);
        EXPECT_EQ(shown.at(x, 0, 1), 0);
        EXPECT_EQ(shown.at(x, 0, 2), 1);
    }
    EXPECT_NEAR(shown.at(2, 0, 0), 0.4, 1.0 / 255) << "the ground";
    EXPECT_NEAR(shown.at(3, 0, 0), 0.7, 1.0 / 255) << "half white over the ground";
}

}  // namespace
}  // namespace etalon::test
