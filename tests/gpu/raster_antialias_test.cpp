#include <cmath>
#include <complex>
#include <iostream>

#include <fmt/format.h>

#include "engine/scene/load.h"
#include "tests/gpu/raster_stage.h"

// What the rasterizer leaves of detail finer than a pixel, against the theory of sampling: a star of black and white
// spokes has one frequency at each radius.
namespace etalon::test {
namespace {

constexpr int kSize = 256;
constexpr double kSpokes = 72;

class RasterAntialias : public DeviceTest {
 protected:
    Film star(const RenderSettings& settings)
    {
        const Scene scene = make_builtin("siemens-star");
        PoseSettings view{.size = ivec2(kSize)};
        view.no_environment = true;
        const PosedScene posed = pose(scene, view);
        return render_raster(device(), posed, require(posed, settings), settings, {});
    }
};

struct Tap {
    double x, weight;  ///< pixels from the pixel's centre
};

/// (AA-2) along one axis, written down anew.
std::vector<Tap> taps(PixelFilter filter, int per_side)
{
    std::vector<Tap> all;
    for (int j = -3 * per_side; j < 4 * per_side; ++j) {
        const double x = (j + 0.5) / per_side - 0.5, d = std::abs(x);
        double w = 0;
        if (filter == PixelFilter::box) w = d < 0.5 ? 1 : 0;
        if (filter == PixelFilter::tent) w = std::max(0.0, 1 - d);
        if (filter == PixelFilter::gaussian) w = d < 2 ? std::exp(-2 * d * d) : 0;
        if (filter == PixelFilter::blackman_harris && d < 1.5) {
            const double t = kPi * d / 1.5;
            w = 0.35875 + 0.48829 * std::cos(t) + 0.14128 * std::cos(2 * t) + 0.01168 * std::cos(3 * t);
        }
        if (w != 0) all.push_back({x, w});
    }
    return all;
}

double response(const std::vector<Tap>& taps, double frequency)
{
    double sum = 0, total = 0;
    for (const Tap& tap : taps) {
        sum += tap.weight * std::cos(2 * kPi * frequency * tap.x);
        total += tap.weight;
    }
    return sum / total;
}

/// Of the coverage samples of one drawn pixel, frequency in cycles per drawn pixel.
double coverage_response(int msaa, dvec2 frequency)
{
    constexpr std::array<dvec2, 4> kFour{{{0.375, 0.125}, {0.875, 0.375}, {0.125, 0.625}, {0.625, 0.875}}};
    if (msaa == 1) return 1;
    std::complex<double> sum = 0;
    for (const dvec2& p : kFour) sum += std::polar(1.0, 2 * kPi * dot(frequency, p));
    return std::abs(sum) / 4;
}

/// Standard deviation of a ring of the star whose spokes have `frequency` cycles a pixel, as sampling theory has it: a
/// square wave has odd harmonics of amplitude 2/(πm), each passed by the samples and their weights. With few samples
/// this counts what high harmonics become, too.
double expected_contrast(const RenderSettings& settings, double frequency)
{
    const std::vector<Tap> line = taps(settings.pixel_filter, settings.ssaa);
    constexpr int kTurns = 64, kHarmonics = 199;
    double power = 0;
    for (int i = 0; i < kTurns; ++i) {
        const double turn = 2 * kPi * (i + 0.5) / kTurns;
        for (int m = 1; m <= kHarmonics; m += 2) {
            const dvec2 f = m * frequency * dvec2(std::cos(turn), std::sin(turn));
            const double amplitude = 2 / (kPi * m) * response(line, f.x) * response(line, f.y) *
                                     coverage_response(settings.msaa, f / double(settings.ssaa));
            power += amplitude * amplitude / 2;
        }
    }
    return std::sqrt(power / kTurns);
}

double measured_contrast(const Film& film, double frequency)
{
    const double radius = kSpokes / (2 * kPi * frequency);
    double sum = 0, squares = 0, count = 0;
    for (int y = 0; y < kSize; ++y)
        for (int x = 0; x < kSize; ++x) {
            const double r = std::hypot(x + 0.5 - kSize / 2, y + 0.5 - kSize / 2);
            if (std::abs(r - radius) > 0.06 * radius) continue;
            const auto value = double(film.mean[std::size_t(y * kSize + x)].x);
            sum += value;
            squares += value * value;
            ++count;
        }
    return std::sqrt(std::max(0.0, squares / count - sum * sum / (count * count)));
}

TEST_F(RasterAntialias, leaves_of_each_frequency_what_its_samples_and_filter_pass)
{
    // Cycles a pixel; 0.5 is Nyquist's: above it whatever is left is aliasing.
    constexpr std::array<double, 4> kFrequencies{0.15, 0.3, 0.6, 0.75};
    std::cout << "contrast left of each frequency in cycles per pixel (0.5 before sampling)\n"
              << "msaa ssaa filter            0.15  0.30 | 0.60  0.75\n";
    constexpr std::array kNames{"box", "tent", "gaussian", "blackman-harris"};
    struct Case {
        int msaa, ssaa;
        PixelFilter filter;
    };
    using F = PixelFilter;
    for (const Case& c :
         {Case{1, 1, F::box}, Case{4, 1, F::box}, Case{4, 1, F::gaussian}, Case{1, 3, F::box}, Case{4, 2, F::box},
          Case{4, 2, F::tent}, Case{4, 2, F::gaussian}, Case{4, 2, F::blackman_harris}}) {
        RenderSettings settings;
        settings.msaa = c.msaa;
        settings.ssaa = c.ssaa;
        settings.pixel_filter = c.filter;
        const Film film = star(settings);
        std::cout << fmt::format("{:4} {:4} {:16}", c.msaa, c.ssaa, kNames[std::size_t(c.filter)]);
        for (const double frequency : kFrequencies) {
            const double expected = expected_contrast(settings, frequency);
            const double found = measured_contrast(film, frequency);
            std::cout << fmt::format(" {:.3f}", found);
            // A ring is 12% of its radius wide, and holds a few hundred pixels.
            EXPECT_NEAR(found, expected, 0.12 * expected + 0.012)
                << "msaa " << c.msaa << " ssaa " << c.ssaa << " filter " << int(c.filter) << " at " << frequency;
        }
        std::cout << std::endl;
    }
}

TEST_F(RasterAntialias, AA_2_a_filter_keeps_a_constant_and_its_borders)
{
    for (const PixelFilter filter :
         {PixelFilter::box, PixelFilter::tent, PixelFilter::gaussian, PixelFilter::blackman_harris})
        for (const int per_side : {1, 3, 4}) {
            SceneBuilder scene("wall");
            scene.show("wall", wall(), scene.material(unlit({0.25, 0.5, 2, 1})));
            RenderSettings settings = transparent(1);
            settings.ssaa = per_side;
            settings.pixel_filter = filter;
            const Film film = draw(device(), std::move(scene), settings, {7, 5});
            ASSERT_EQ(film.width, 7);
            ASSERT_EQ(film.height, 5);
            EXPECT_EQ(film.samples, std::uint64_t(per_side * per_side));
            for (std::size_t i = 0; i < film.pixel_count(); ++i) {
                expect_radiance(film.mean[i], {0.25, 0.5, 2}, 1e-6);
                EXPECT_NEAR(film.alpha[i], 1, 1e-6);
            }
        }
}

TEST_F(RasterAntialias, AOVs_are_of_the_pixels_centres_whatever_is_drawn_between_them)
{
    SceneBuilder plain("sphere"), fine("sphere");
    for (SceneBuilder* scene : {&plain, &fine}) {
        scene->show("half", make_rectangle({-0.5, 0, 0}, {0.5, 0, 0}, {0, 1, 0}), scene->material(unlit(dvec4(1))));
        scene->sphere("ball", {0.5, 0, 0}, 0.4, scene->lambert("white", dvec3(1)));
    }
    RenderSettings settings;
    settings.aovs = true;
    const Film a = draw(device(), std::move(plain), settings, {16, 12});
    settings.ssaa = 3;
    const Film b = draw(device(), std::move(fine), settings, {16, 12});
    EXPECT_EQ(a.aovs.object_id, b.aovs.object_id);
    EXPECT_EQ(a.aovs.depth, b.aovs.depth);
}

TEST_F(RasterAntialias, sample_counts_that_the_device_lacks_are_refused_with_those_it_has)
{
    RenderSettings settings;
    for (const int msaa : {1, 2, 4, 8, 16}) {
        settings.msaa = msaa;
        SceneBuilder scene("wall");
        scene.show("wall", wall(), scene.material(unlit(dvec4(1))));
        if ((device().limits().samples & unsigned(msaa)) != 0) {
            EXPECT_EQ(draw(device(), std::move(scene), settings).samples, std::uint64_t(msaa));
            continue;
        }
        try {
            draw(device(), std::move(scene), settings);
            FAIL() << msaa;
        } catch (const Error& error) {
            EXPECT_EQ(error.exit_code(), 3);
            EXPECT_THAT(error.mend(), testing::HasSubstr("--msaa may be 1"));
            EXPECT_THAT(error.mend(), testing::HasSubstr("--ssaa"));
        }
    }
}

}  // namespace
}  // namespace etalon::test
