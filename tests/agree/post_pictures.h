#pragma once
// Films for tests of post passes.
#include <cmath>
#include <limits>
#include <random>

#include "engine/image/film.h"

namespace etalon::test {

/// Shapes with edges, a gradient and noise, brighter than 1 here and there, half transparent at one side; with
/// variance, and the AOVs of a few planes before nothing.
inline Film post_film_of(int width, int height, unsigned seed = 5)
{
    std::mt19937 random(seed);
    std::uniform_real_distribution<float> uniform(0, 1);
    Film film{.width = width, .height = height, .samples = 16};
    for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x) {
            const float u = (float(x) + 0.5f) / float(width), v = (float(y) + 0.5f) / float(height);
            const bool disc = std::hypot(u - 0.4f, v - 0.5f) < 0.25f;
            const bool stripe = u + 0.3f * v > 0.8f;
            const vec3 base = disc ? vec3(0.9f, 0.4f, 0.1f) : stripe ? vec3(0.05f, 0.1f, 0.3f) : vec3(0.3f + 0.3f * u);
            const float bright = disc && v < 0.4f ? 4.0f : 1.0f;
            const vec3 noise(uniform(random), uniform(random), uniform(random));
            film.mean.push_back(bright * base * (vec3(0.8f) + 0.4f * noise));
            film.variance.push_back(bright * bright * base * base * (0.01f + 0.01f * uniform(random)));
            film.alpha.push_back(stripe ? 0.5f : 1.0f);
            film.aovs.depth.push_back(disc ? 2.0f + u : stripe ? std::numeric_limits<float>::infinity() : 5.0f + v);
            film.aovs.normal.push_back(disc ? vec3(0.6f, 0, 0.8f) : stripe ? vec3(0) : vec3(0, 0.8f, 0.6f));
            film.aovs.albedo.push_back(base);
            film.aovs.emission.emplace_back(0);
            film.aovs.object_id.push_back(disc ? 1 : 0);
            film.aovs.material_id.push_back(disc ? 1 : 0);
            film.aovs.uv.emplace_back(u, v);
        }
    return film;
}

/// As post_film_of, with every kind of value that no pass may stumble over.
inline Film hostile_post_film(int width, int height)
{
    const float inf = std::numeric_limits<float>::infinity(), nan = std::numeric_limits<float>::quiet_NaN();
    Film film = post_film_of(width, height);
    const vec3 nasty[] = {vec3(nan),         vec3(inf, 0, 0), vec3(0, -inf, 1), vec3(1, nan, 2),    vec3(0),
                          vec3(-0.0f, 0, 0), vec3(1e-40f),    vec3(1e-30f),     vec3(-3, 0.5f, -1), vec3(1e6f, 0, 1)};
    const std::size_t count = film.pixel_count();
    for (std::size_t i = 0; i < std::size(nasty); ++i) film.mean[(7 * i + 3) % count] = nasty[i];
    film.alpha[(5 * count / 7) % count] = nan;
    film.alpha[(3 * count / 7) % count] = 0;
    const float depths[] = {nan, -1, 0, 1e-30f, 1e30f};
    for (std::size_t i = 0; i < std::size(depths); ++i) film.aovs.depth[(11 * i + 1) % count] = depths[i];
    film.aovs.normal[count / 2] = vec3(nan, 0, 1);
    film.variance[count / 3] = vec3(nan);
    film.variance[count / 4] = vec3(0);
    return film;
}

}  // namespace etalon::test
