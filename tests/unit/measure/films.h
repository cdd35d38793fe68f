#pragma once
#include <functional>
#include <random>

#include "engine/image/film.h"

namespace etalon::test {

/// A picture without error: radiance by pixel and channel.
using Truth = std::function<double(int x, int y, int channel)>;

/// A grey ramp with a little colour, 0.5 … 2 nit.
inline double ramp(int x, int y, int channel)
{
    return 0.5 + 0.02 * x + 0.01 * y + 0.1 * channel;
}

/// Draws one sample of mean 1.
using Draw = std::function<double(std::mt19937_64&)>;

inline double exponential(std::mt19937_64& random)
{
    return -std::log1p(-std::generate_canonical<double, 32>(random));
}
/// One sample in fifty carries all the light: the tail that spoils per-pixel tests.
inline double rare(std::mt19937_64& random)
{
    return std::generate_canonical<double, 32>(random) < 0.02 ? 50.0 : 0.0;
}

/// What a renderer with `samples` independent samples a pixel would measure of `truth`.
inline Film noisy_film(int width, int height, std::uint64_t samples, std::uint64_t seed, const Draw& draw = exponential,
                       const Truth& truth = ramp)
{
    std::mt19937_64 random(seed);
    Film film;
    film.width = width;
    film.height = height;
    film.samples = samples;
    film.alpha.assign(film.pixel_count(), 1.0f);
    for (int y = 0; y < height; ++y) {
        for (int x = 0; x < width; ++x) {
            vec3 mean, variance;
            for (int c = 0; c < 3; ++c) {
                double m = 0, m2 = 0;
                for (std::uint64_t n = 1; n <= samples; ++n) {
                    const double delta = truth(x, y, c) * draw(random) - m;
                    m += delta / double(n);
                    m2 += delta * delta * double(n - 1) / double(n);
                }
                mean[c] = float(m);
                variance[c] = float(m2 / double(samples - 1) / double(samples));
            }
            film.mean.push_back(mean);
            film.variance.push_back(variance);
        }
    }
    return film;
}

/// The same of a renderer whose `replicates` means of `samples` each are independent, while within one of them samples
/// know of each other, so that nothing but the means tells the error (MC-10).
inline Film replicated_film(int width, int height, std::uint64_t samples, std::uint32_t replicates, std::uint64_t seed,
                            const Draw& draw = exponential, const Truth& truth = ramp)
{
    Film film = noisy_film(width, height, samples * replicates, seed, draw, truth);
    std::mt19937_64 random(seed ^ 0x5eed);
    film.replicates = replicates;
    std::vector<double> means(replicates);
    for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x)
            for (int c = 0; c < 3; ++c) {
                double mean = 0, scatter = 0;
                for (double& m : means) {
                    m = 0;
                    for (std::uint64_t n = 0; n < samples; ++n) m += truth(x, y, c) * draw(random) / double(samples);
                    mean += m / replicates;
                }
                for (const double m : means) scatter += (m - mean) * (m - mean);
                const auto i = std::size_t(y) * std::size_t(width) + std::size_t(x);
                film.mean[i][c] = float(mean);
                film.variance[i][c] = float(scatter / (replicates * (replicates - 1.0)));
            }
    return film;
}

/// Every value `value`, known without error.
inline Film constant_film(int width, int height, float value)
{
    Film film;
    film.width = width;
    film.height = height;
    film.samples = 64;
    film.mean.assign(film.pixel_count(), vec3(value));
    film.variance.assign(film.pixel_count(), vec3(0));
    film.alpha.assign(film.pixel_count(), 1.0f);
    return film;
}

}  // namespace etalon::test
