// Pictures of chosen pixels, and samples dealt out by a pilot (MC-11).
#include <algorithm>
#include <atomic>
#include <cstdio>

#include "engine/base/error.h"
#include "tests/gpu/path_picture.h"

namespace etalon::test {
namespace {

TEST_F(PathPicture, MC_11_chosen_pixels_are_to_the_bit_those_of_the_whole_picture)
{
    const Scene scene = make_builtin("cornell");
    PoseSettings view;
    view.size = ivec2(24, 20);
    const PosedScene posed = pose(scene, view);
    std::vector<std::uint32_t> pixels;
    for (std::uint32_t i = 0; i < 24 * 20; i += 1 + i % 7) pixels.push_back(24 * 20 - 1 - i);
    for (const Sequence sampler : {Sequence::pcg, Sequence::sobol})
        for (const Traversal traversal : {Traversal::by_device, Traversal::queues, Traversal::exact}) {
            RenderSettings how = settings(9);
            how.sampler = sampler;
            how.aovs = true;
            const Requirements required = require(posed, how);
            const Film whole = render_path(device(), posed, required, how, {});
            PathTracer tracer(device(), posed, required, how, {}, traversal, PixelSet::chosen);
            tracer.start(posed.view, how.seed, pixels);
            while (tracer.samples() < how.spp) tracer.step(how.spp);
            const Film film = tracer.film();
            ASSERT_EQ(film.mean.size(), pixels.size());
            EXPECT_EQ(film.height, 1);
            for (std::size_t k = 0; k < pixels.size(); ++k) {
                ASSERT_EQ(film.mean[k], whole.mean[pixels[k]]) << k;
                ASSERT_EQ(film.variance[k], whole.variance[pixels[k]]) << k;
                ASSERT_EQ(film.alpha[k], whole.alpha[pixels[k]]) << k;
                ASSERT_EQ(film.aovs.normal[k], whole.aovs.normal[pixels[k]]) << k;
                ASSERT_EQ(film.aovs.object_id[k], whole.aovs.object_id[pixels[k]]) << k;
            }
        }
}

Film adaptively(gpu::Device& device, const Scene& scene, const RenderSettings& how, AdaptiveGoal goal, ivec2 size)
{
    PoseSettings view;
    view.size = size;
    const PosedScene posed = pose(scene, view);
    return render_path_adaptively(device, posed, require(posed, how), how, goal, {});
}

double mean_variance(const Film& film)
{
    double sum = 0;
    for (const vec3& v : film.variance) sum += double(v.x + v.y + v.z) / 3 / double(film.variance.size());
    return sum;
}

TEST_F(PathPicture, MC_11_adaptive_samples_keep_the_mean_and_lower_the_error)
{
    const Scene scene = make_builtin("glass");
    const ivec2 size(40);
    RenderSettings how = settings(128);
    how.max_depth = 6;
    const Film even = render(scene, how, size);
    how.seed = 5;
    const Film adaptive = adaptively(device(), scene, how, AdaptiveGoal::error, size);
    ASSERT_EQ(adaptive.counts.size(), adaptive.pixel_count());
    EXPECT_LE(adaptive.samples, 128u);
    EXPECT_GE(adaptive.samples, 90u);
    const auto [least, most] = std::minmax_element(adaptive.counts.begin(), adaptive.counts.end());
    EXPECT_LT(2 * *least, *most);
    expect_equal(measure(even), measure(adaptive), "glass");
    const double gain = mean_variance(even) * 128 / (mean_variance(adaptive) * double(adaptive.samples));
    std::printf("%u to %u samples; variance x samples: %.2f times less\n", *least, *most, gain);
    EXPECT_GT(gain, 1);
    EXPECT_TRUE(same_film(adaptive, adaptively(device(), scene, how, AdaptiveGoal::error, size))) << "not repeatable";
}

TEST_F(PathPicture, MC_11_a_stopped_adaptive_picture_has_the_pilot_where_it_was_not_yet)
{
    const Scene scene = make_builtin("cornell");
    PoseSettings view;
    view.size = ivec2(24);
    const PosedScene posed = pose(scene, view);
    RenderSettings how = settings(256);
    const std::atomic<bool> stop = true;
    const Film film =
        render_path_adaptively(device(), posed, require(posed, how), how, AdaptiveGoal::relmse, Progress({}, &stop));
    ASSERT_EQ(film.counts.size(), film.pixel_count());
    for (const std::uint32_t count : film.counts) {
        EXPECT_GE(count, 2u);
        EXPECT_LE(count, 16u);
    }
    EXPECT_TRUE(estimate_error(film).has_value());
    EXPECT_EQ(film.variance.size(), film.pixel_count());
}

TEST_F(PathPicture, MC_11_adaptive_samples_are_of_whole_pictures)
{
    const Scene scene = make_builtin("cornell");
    const PosedScene posed = pose(scene, {.size = ivec2(8)});
    RenderSettings how = settings(4);
    how.shard = {.number = 1, .count = 2};
    EXPECT_THROW(render_path_adaptively(device(), posed, require(posed, how), how, AdaptiveGoal::error, {}), Error);
}

}  // namespace
}  // namespace etalon::test
