// What the path tracer's options change and what they leave alone: samplers, glass in shadows.
#include "path_shaders.h"
#include "shaders/shared/sobol.h"
#include "tests/gpu/path_picture.h"

namespace etalon::test {
namespace {

TEST_F(PathPicture, MC_8_sobol_points_are_the_same_integers_on_host_and_device)
{
    std::vector<uvec4> inputs = {uvec4(0), uvec4(0xffffffffu), uvec4(1, 0, 0, 0), uvec4(0, 0x80000000u, 0, 1)};
    for (std::uint32_t i = 0; i < 3000; ++i) inputs.push_back(shared::pcg4d(uvec4(i, 3, 5, 7)));
    const auto drawn = run_kernel<uvec4>(device(), path_shaders::find("path_sobol.comp"), inputs);
    for (std::size_t i = 0; i < inputs.size(); ++i) {
        const uvec4& in = inputs[i];
        ASSERT_EQ(drawn[i], shared::sobol_bits(in.x, in.y, in.z, in.w)) << "row " << i;
    }
}

/// A lit floor with a ball on it: edges, shadows and smooth light, in colours without fireflies.
Scene ball_under_sky()
{
    SceneBuilder b = above_floor(half_grey);
    b.sphere("ball", dvec3(0, 0.5, 0), 0.5, b.lambert("red", dvec3(0.8, 0.3, 0.2)));
    Environment sky;
    Image map(8, 4, 3);
    for (std::size_t i = 0; i < map.values.size(); ++i) map.values[i] = i < 48 ? 1.0f + float(i % 5) : 0.2f;
    sky.map = std::make_shared<const Image>(std::move(map));
    b.environment(sky);
    return std::move(b).finish();
}

/// Squared difference of two pictures, and the variance that `film` says, both a pixel and channel on average.
double squared_difference(const Film& film, const Film& truth)
{
    double sum = 0;
    for (std::size_t i = 0; i < film.mean.size(); ++i) {
        const dvec3 d = dvec3(film.mean[i]) - dvec3(truth.mean[i]);
        sum += dot(d, d) / 3 / double(film.mean.size());
    }
    return sum;
}

double estimated(const Film& film)
{
    double sum = 0;
    for (const vec3& v : film.variance) sum += double(v.x + v.y + v.z) / 3 / double(film.variance.size());
    return sum;
}

TEST_F(PathPicture, MC_10_sobol_points_have_the_same_mean_a_steeper_slope_and_the_estimated_error)
{
    // A squared error over 576 pixels is known to some 8% (one standard deviation), a slope over 4 octaves to 0.02;
    // the limits leave five times that. The truth is far nearer to itself than the pictures are to it. The estimated
    // error has one degree of freedom a pixel, known to some 8% too: four pictures halve both.
    for (const auto& [name, scene] :
         {std::pair{"ball", ball_under_sky()}, std::pair{"cornell", make_builtin("cornell")}}) {
        const auto film = [&](Sequence sampler, std::uint64_t spp, std::uint64_t seed) {
            RenderSettings how = settings(spp);
            how.sampler = sampler;
            how.seed = seed;
            how.max_depth = 3;
            return render(scene, how, ivec2(24));
        };
        const Film truth = film(Sequence::sobol, 512, 7);
        const Film pcg = film(Sequence::pcg, 128, 1), sobol = film(Sequence::sobol, 128, 1);
        expect_equal(measure(pcg), measure(sobol), name);
        const double many_pcg = squared_difference(pcg, truth), many = squared_difference(sobol, truth);
        const double slope_pcg = std::log2(many_pcg / squared_difference(film(Sequence::pcg, 8, 1), truth)) / 4;
        const double slope = std::log2(many / squared_difference(film(Sequence::sobol, 8, 1), truth)) / 4;
        std::printf(
            "%s: log2 squared error per doubling of samples: pcg %.3f, sobol %.3f; at 128 spp sobol has %.3f of the "
            "squared error\n",
            name, slope_pcg, slope, many / many_pcg);
        EXPECT_NEAR(slope_pcg, -1, 0.2) << name;
        EXPECT_NEAR(many_pcg / estimated(pcg), 1, 0.3) << name;
        EXPECT_LT(slope, slope_pcg - 0.1) << name;
        EXPECT_LT(many, 0.5 * many_pcg) << name;
        double found = many, said = estimated(sobol);
        for (const std::uint64_t seed : {2u, 3u, 4u}) {
            const Film other = film(Sequence::sobol, 128, seed);
            found += squared_difference(other, truth);
            said += estimated(other);
        }
        said += 4 * estimated(truth);  // its own error is in every difference
        std::printf("%s: squared error %.3f of the estimated one\n", name, found / said);
        EXPECT_NEAR(found / said, 1, 0.25) << name;
    }
}

/// A lamp in a bulb of thin glass over a floor, beside the picture. The glass has outsides alone: from within, it would
/// mirror the lamp onto the floor, and mirror images are found by chance.
Scene lamp_in_a_bulb(double roughness)
{
    SceneBuilder b = above_floor(half_grey);
    Material lamp;
    lamp.model = BsdfModel::lambert;
    lamp.emission = dvec3(100, 75, 50);
    b.sphere("lamp", dvec3(2, 1, 0), 0.2, b.material(lamp));
    Material glass;
    glass.base_color = dvec4(0.9, 0.8, 1, 1);
    glass.metallic = 0;
    glass.roughness = roughness;
    glass.layers.emplace();
    glass.layers->transmission = 1;
    b.show("bulb", make_box(dvec3(2, 1, 0), dvec3(0.3, 0.25, 0.3), 0.3), b.material(glass));
    return std::move(b).finish();
}

TEST_F(PathPicture, SH_70_looking_for_lights_through_glass_keeps_the_mean_and_takes_the_noise)
{
    const Scene scene = lamp_in_a_bulb(0);
    RenderSettings by_chance = settings(1024), through = settings(64);
    through.glass_shadows = true;
    through.max_depth = by_chance.max_depth = 12;
    const Film a = render(scene, by_chance, ivec2(24)), b = render(scene, through, ivec2(24));
    const Measured slow = measure(a), fast = measure(b);
    EXPECT_GT(fast.mean.x, 0.05);
    EXPECT_LT(slow.error.x, 0.05 * slow.mean.x) << "too weak to mean anything";
    expect_equal(slow, fast, "glass");
    // Variance times samples, that is the cost of a given error.
    const double gain = slow.error.x * slow.error.x * 1024 / (fast.error.x * fast.error.x * 64);
    std::printf("variance per sample: %.1f times less through glass\n", gain);
    EXPECT_GT(gain, 10);
}

TEST_F(PathPicture, SH_70_rough_glass_is_not_looked_through)
{
    const Scene scene = lamp_in_a_bulb(0.3);
    RenderSettings off = settings(8), on = settings(8);
    on.glass_shadows = true;
    EXPECT_TRUE(same_film(render(scene, off), render(scene, on)));
}

}  // namespace
}  // namespace etalon::test
