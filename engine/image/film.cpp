#include "engine/image/film.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>

#include "engine/base/error.h"
#include "engine/math/stats.h"

namespace etalon {
namespace {

/// Sums of variance and radiance over some pixels; those that are not finite are left out.
struct ErrorSums {
    double variance = 0;
    double radiance = 0;
    std::uint64_t values = 0;

    void add(const vec3& mean, const vec3& variance_of_mean)
    {
        for (int c = 0; c < 3; ++c) {
            if (!std::isfinite(mean[c]) || !std::isfinite(variance_of_mean[c])) continue;
            variance += double(variance_of_mean[c]);
            radiance += double(mean[c]);
            ++values;
        }
    }
};

ErrorSums sum_tile(const Film& film, int x0, int y0, int tile)
{
    ErrorSums sums;
    for (int y = y0; y < std::min(y0 + tile, film.height); ++y)
        for (int x = x0; x < std::min(x0 + tile, film.width); ++x) {
            const std::size_t i = std::size_t(y) * std::size_t(film.width) + std::size_t(x);
            sums.add(film.mean[i], film.variance[i]);
        }
    return sums;
}

/// 16 where the picture has at least 30 such tiles, else the power of two that gives that many.
int tile_size(const Film& film)
{
    const auto tiles = [&](int size) { return ((film.width + size - 1) / size) * ((film.height + size - 1) / size); };
    int size = 16;
    while (size > 1 && tiles(size) < 30) size /= 2;
    return size;
}

}  // namespace

std::optional<ErrorEstimate> estimate_error(const Film& film)
{
    if (film.variance.empty()) return std::nullopt;
    assume(film.variance.size() == film.pixel_count() && film.mean.size() == film.pixel_count());
    const int tile = tile_size(film);
    std::vector<ErrorSums> tiles;
    ErrorSums all;
    for (int y = 0; y < film.height; y += tile)
        for (int x = 0; x < film.width; x += tile) {
            const ErrorSums sums = sum_tile(film, x, y, tile);
            if (sums.values == 0) continue;
            tiles.push_back(sums);
            all.variance += sums.variance;
            all.radiance += sums.radiance;
            all.values += sums.values;
        }
    if (all.values == 0) return std::nullopt;
    if (all.variance == 0) return ErrorEstimate{};
    if (all.radiance <= 0) return std::nullopt;

    const double variance = all.variance / double(all.values);
    const double relative = std::sqrt(variance) / (all.radiance / double(all.values));
    if (tiles.size() < 2) return ErrorEstimate{relative, 0, std::numeric_limits<double>::infinity()};
    // Ratio estimator: the scatter of what each tile's sum is above its share, weighted as the whole weighs it.
    double scatter = 0;
    for (const ErrorSums& sums : tiles) {
        const double residual = sums.variance - variance * double(sums.values);
        scatter += residual * residual;
    }
    const auto count = double(tiles.size());
    const double relative_error = std::sqrt(count / (count - 1) * scatter) / all.variance;
    // On the logarithm, so that the interval stays positive; the root halves it.
    const double factor = std::exp(0.5 * student_quantile(0.975, count - 1) * relative_error);
    return ErrorEstimate{relative, relative / factor, relative * factor};
}

FilmSum::FilmSum(int width, int height) : width_(width), height_(height)
{
    assume(width > 0 && height > 0);
    const std::size_t pixels = std::size_t(width) * std::size_t(height);
    mean_.resize(3 * pixels);
    m2_.resize(3 * pixels);
    alpha_.resize(pixels);
}

void FilmSum::add_block(std::span<const float> mean, std::span<const float> m2, std::span<const float> alpha,
                        std::uint64_t count)
{
    assume(mean.size() == mean_.size() && m2.size() == m2_.size() && alpha.size() == alpha_.size());
    if (count == 0) return;
    const auto before = double(samples_);
    const auto added = double(count);
    const double weight = added / (before + added);
    for (std::size_t i = 0; i < mean_.size(); ++i) {
        const double delta = double(mean[i]) - mean_[i];
        // A constant has delta 0 and stays exact (M2); m2 grows by squares alone and cannot turn negative (M3).
        m2_[i] += double(m2[i]) + delta * delta * before * weight;
        mean_[i] += delta * weight;
    }
    for (std::size_t i = 0; i < alpha_.size(); ++i) alpha_[i] += (double(alpha[i]) - alpha_[i]) * weight;
    samples_ += count;
}

std::vector<double> FilmSum::state() const
{
    std::vector<double> out(mean_);
    out.insert(out.end(), m2_.begin(), m2_.end());
    out.insert(out.end(), alpha_.begin(), alpha_.end());
    return out;
}

void FilmSum::restore(std::span<const double> state, std::uint64_t samples)
{
    if (state.size() != mean_.size() + m2_.size() + alpha_.size())
        throw Error(Blame::input, "a film cannot go on from the state of one of another size");
    for (std::vector<double>* part : {&mean_, &m2_, &alpha_}) {
        std::copy_n(state.begin(), part->size(), part->begin());
        state = state.subspan(part->size());
    }
    samples_ = samples;
}

Film FilmSum::film() const
{
    Film film;
    film.width = width_;
    film.height = height_;
    film.samples = samples_;
    const std::size_t pixels = film.pixel_count();
    film.mean.resize(pixels);
    film.alpha.resize(pixels);
    if (samples_ >= 2) film.variance.resize(pixels);
    const double scale = samples_ >= 2 ? 1 / (double(samples_ - 1) * double(samples_)) : 0;
    for (std::size_t i = 0; i < pixels; ++i) {
        film.alpha[i] = float(alpha_[i]);
        for (int c = 0; c < 3; ++c) {
            const std::size_t j = 3 * i + std::size_t(c);
            film.mean[i][c] = float(mean_[j]);
            if (!film.variance.empty()) film.variance[i][c] = float(m2_[j] * scale);
        }
    }
    return film;
}

PixelSums FilmSum::pixel(std::size_t i) const
{
    const auto triple = [i](const std::vector<double>& v) { return dvec3(v[3 * i], v[3 * i + 1], v[3 * i + 2]); };
    return {triple(mean_), triple(m2_), alpha_[i], samples_};
}

FilmCheck check(const Film& film)
{
    FilmCheck found;
    found.single_colour = film.mean.size() > 1;
    for (std::size_t i = 0; i < film.mean.size(); ++i) {
        const vec3& m = film.mean[i];
        if (std::isnan(m.x) || std::isnan(m.y) || std::isnan(m.z))
            ++found.nan_pixels;
        else if (std::isinf(m.x) || std::isinf(m.y) || std::isinf(m.z))
            ++found.inf_pixels;
        const bool same_alpha = film.alpha.empty() || film.alpha[i] == film.alpha[0];
        // By bits: a picture of NaN alone is of one colour too.
        const auto same_bits = [&](int c) {
            return std::bit_cast<std::uint32_t>(m[c]) == std::bit_cast<std::uint32_t>(film.mean[0][c]);
        };
        if (!same_alpha || !same_bits(0) || !same_bits(1) || !same_bits(2)) found.single_colour = false;
    }
    return found;
}

}  // namespace etalon
