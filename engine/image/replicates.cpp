#include "engine/image/replicates.h"

#include "engine/base/error.h"

namespace etalon {

Pooled pool(std::span<const PixelSums> replicates)
{
    Pooled out;
    dvec3 m2(0);
    double parts = 0, samples = 0;
    for (const PixelSums& r : replicates) {
        if (r.count == 0) continue;
        ++parts;
        samples += double(r.count);
        out.mean += r.mean;
        out.alpha += r.alpha;
        m2 += r.m2;
    }
    if (parts == 0) return {};
    out.mean /= parts;
    out.alpha /= parts;
    if (parts < 2) {
        if (samples > 1) out.variance = m2 / (samples - 1) / samples;
        return out;
    }
    for (const PixelSums& r : replicates)
        if (r.count > 0) out.variance += (r.mean - out.mean) * (r.mean - out.mean);
    out.variance /= parts * (parts - 1);
    return out;
}

Film film_of(std::span<const FilmSum> replicates)
{
    assume(!replicates.empty());
    if (replicates.size() == 1) return replicates.front().film();
    Film film;
    film.width = replicates.front().width();
    film.height = replicates.front().height();
    for (const FilmSum& sum : replicates) {
        film.samples += sum.samples();
        film.replicates += sum.samples() > 0 ? 1 : 0;
    }
    if (film.replicates < 2) film.replicates = 0;
    const std::size_t pixels = film.pixel_count();
    std::vector<PixelSums> parts(replicates.size());
    for (std::size_t i = 0; i < pixels; ++i) {
        for (std::size_t r = 0; r < parts.size(); ++r) parts[r] = replicates[r].pixel(i);
        const Pooled pooled = pool(parts);
        film.mean.emplace_back(pooled.mean);
        film.alpha.push_back(float(pooled.alpha));
        if (film.samples >= 2) film.variance.emplace_back(pooled.variance);
    }
    return film;
}

}  // namespace etalon
