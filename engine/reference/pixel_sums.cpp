#include "engine/reference/pixel_sums.h"

#include <cmath>

#include "engine/base/error.h"

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

Film film_of(const std::vector<PixelSum>& sums, int width, int height, std::uint64_t samples)
{
    Film film;
    film.width = width;
    film.height = height;
    film.samples = samples;
    film.mean.reserve(sums.size());
    film.alpha.reserve(sums.size());
    if (samples >= 2) film.variance.reserve(sums.size());
    for (const PixelSum& sum : sums) {
        film.mean.emplace_back(sum.mean());
        film.alpha.push_back(static_cast<float>(sum.alpha()));
        if (samples >= 2) film.variance.emplace_back(sum.variance_of_mean());
        film.nonfinite += sum.nonfinite();
    }
    return film;
}

double relative_error(const std::vector<PixelSum>& sums)
{
    double variance = 0, radiance = 0;
    for (const PixelSum& sum : sums) {
        const dvec3 v = sum.variance_of_mean(), m = sum.mean();
        variance += v.x + v.y + v.z;
        radiance += m.x + m.y + m.z;
    }
    const double n = 3 * static_cast<double>(sums.size());
    return radiance > 0 ? std::sqrt(variance / n) / (radiance / n) : 0;
}

}  // namespace etalon::reference
