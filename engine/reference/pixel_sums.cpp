#include "engine/reference/pixel_sums.h"

#include <algorithm>
#include <cmath>

#include "engine/base/error.h"
#include "engine/image/replicates.h"

namespace etalon::reference {

void PixelSum::add(const dvec3& radiance, double alpha)
{
    if (!is_finite(radiance)) {
        ++nonfinite_;
        return;
    }
    ++count_;
    const double n = static_cast<double>(count_);
    const dvec3 step = radiance - mean_;
    mean_ += step / n;
    m2_ += step * (radiance - mean_);
    alpha_ += (alpha - alpha_) / n;
}

dvec3 PixelSum::variance_of_mean() const
{
    if (count_ < 2) return dvec3(0);
    const double n = static_cast<double>(count_);
    return m2_ / (n - 1) / n;
}

void PixelSum::save(std::span<double> numbers) const
{
    assume(numbers.size() == kNumbers);
    for (int c = 0; c < 3; ++c) {
        numbers[static_cast<std::size_t>(c)] = mean_[c];
        numbers[static_cast<std::size_t>(3 + c)] = m2_[c];
    }
    numbers[6] = alpha_;
    numbers[7] = static_cast<double>(count_);  // exact: under 2^53
    numbers[8] = static_cast<double>(nonfinite_);
}

void PixelSum::restore(std::span<const double> numbers)
{
    assume(numbers.size() == kNumbers);
    for (int c = 0; c < 3; ++c) {
        mean_[c] = numbers[static_cast<std::size_t>(c)];
        m2_[c] = numbers[static_cast<std::size_t>(3 + c)];
    }
    alpha_ = numbers[6];
    count_ = static_cast<std::uint64_t>(numbers[7]);
    nonfinite_ = static_cast<std::uint64_t>(numbers[8]);
}

FilmState state_of(const std::vector<PixelSum>& sums, int width, int height, std::uint64_t samples)
{
    FilmState state{.of = {},
                    .width = width,
                    .height = height,
                    .samples = samples,
                    .sums = std::vector<double>(PixelSum::kNumbers * sums.size()),
                    .block = {}};
    std::span<double> rest(state.sums);
    for (const PixelSum& sum : sums) {
        sum.save(rest.first(PixelSum::kNumbers));
        rest = rest.subspan(PixelSum::kNumbers);
    }
    return state;
}

void restore(std::vector<PixelSum>& sums, const FilmState& state)
{
    if (state.sums.size() != PixelSum::kNumbers * sums.size() || state.block_samples > 0)
        throw Error(Blame::input, "this picture cannot go on from the state of another one");
    std::span<const double> rest(state.sums);
    for (PixelSum& sum : sums) {
        sum.restore(rest.first(PixelSum::kNumbers));
        rest = rest.subspan(PixelSum::kNumbers);
    }
}

namespace {

Pooled pool_pixel(std::span<const PixelSum> replicates)
{
    std::vector<PixelSums> parts;
    for (const PixelSum& sum : replicates) parts.push_back(sum.sums());
    return pool(parts);
}

}  // namespace

Film film_of(const std::vector<PixelSum>& sums, int width, int height, std::uint64_t samples)
{
    Film film;
    film.width = width;
    film.height = height;
    film.samples = samples;
    const std::size_t pixels = film.pixel_count(), replicates = sums.size() / pixels;
    if (std::min<std::uint64_t>(replicates, samples) > 1)
        film.replicates = static_cast<std::uint32_t>(std::min<std::uint64_t>(replicates, samples));
    film.mean.reserve(pixels);
    film.alpha.reserve(pixels);
    if (samples >= 2) film.variance.reserve(pixels);
    for (std::size_t i = 0; i < pixels; ++i) {
        const auto parts = std::span(sums).subspan(i * replicates, replicates);
        const Pooled pooled = pool_pixel(parts);
        film.mean.emplace_back(pooled.mean);
        film.alpha.push_back(static_cast<float>(pooled.alpha));
        if (samples >= 2) film.variance.emplace_back(pooled.variance);
        for (const PixelSum& sum : parts) film.nonfinite += sum.nonfinite();
    }
    return film;
}

double relative_error(const std::vector<PixelSum>& sums, std::size_t pixels)
{
    double variance = 0, radiance = 0;
    const std::size_t replicates = sums.size() / pixels;
    for (std::size_t i = 0; i < pixels; ++i) {
        const Pooled pooled = pool_pixel(std::span(sums).subspan(i * replicates, replicates));
        variance += pooled.variance.x + pooled.variance.y + pooled.variance.z;
        radiance += pooled.mean.x + pooled.mean.y + pooled.mean.z;
    }
    const double n = 3 * static_cast<double>(pixels);
    return radiance > 0 ? std::sqrt(variance / n) / (radiance / n) : 0;
}

}  // namespace etalon::reference
