#include "engine/render/environment.h"

#include <algorithm>
#include <cmath>
#include <span>
#include <vector>

#include "engine/base/error.h"
#include "engine/base/parallel.h"
#include "engine/image/mips.h"

namespace etalon {
namespace {

constexpr int kSourceWidth = 128;  // of the map that is integrated (SH-33, SH-35)
constexpr int kSourceHeight = 64;
constexpr int kMirrorWidth = 512;  // most of table 0
constexpr int kMirrorHeight = 256;

/// A row of a map by colour planes, in double.
struct Planes {
    std::vector<double> r, g, b;
    explicit Planes(int width)
        : r(static_cast<std::size_t>(width)), g(static_cast<std::size_t>(width)), b(static_cast<std::size_t>(width))
    {}
};

std::vector<Planes> rows_of(const Image& map)
{
    std::vector<Planes> rows(static_cast<std::size_t>(map.height), Planes(map.width));
    for (int y = 0; y < map.height; ++y) {
        Planes& row = rows[static_cast<std::size_t>(y)];
        for (int x = 0; x < map.width; ++x) {
            const auto i = static_cast<std::size_t>(x);
            row.r[i] = map.at(x, y, 0);
            row.g[i] = map.at(x, y, 1);
            row.b[i] = map.at(x, y, 2);
        }
    }
    return rows;
}

double polar_angle(int row, int height)
{
    return kPi * (row + 0.5) / height;
}

/// Solid angle of each texel of a row, sr: exact, not sin θ Δθ Δφ.
double texel_solid_angle(int row, int width, int height)
{
    return 2 * kPi / width * (std::cos(kPi * row / height) - std::cos(kPi * (row + 1) / height));
}

/// D(N·h)(N·l)₊ up to its constant factor, for view and normal along N: a function of N·l alone, since (N·h)² = (1 +
/// N·l)/2.
double lobe(double n_l, double alpha)
{
    if (n_l <= 0) return 0;
    const double cos2 = (1 + n_l) / 2;
    const double sin2 = (1 - n_l) / 2;
    const double k = alpha / (sin2 + cos2 * alpha * alpha);  // (SH-11)
    return k * k * n_l;
}

/// Table k weighs light from N·l by this: the lobes of (SH-35), and last the cosine of (SH-33).
double weight_of(int table, double n_l)
{
    if (table > EnvironmentTables::kRoughTables) return std::max(n_l, 0.0);
    const double roughness = table / double(EnvironmentTables::kRoughTables);
    return lobe(n_l, roughness * roughness);
}

/// One row of a table. The weight of a source texel depends on the two rows and on the distance in
/// azimuth alone, so that each row of weights serves every column.
void prefilter_row(const std::vector<Planes>& source, int table, int row, std::span<dvec3> out)
{
    const int columns = static_cast<int>(out.size());
    const double polar = polar_angle(row, EnvironmentTables::kTableHeight);
    std::vector<double> weights(kSourceWidth * 2);
    double total = 0;
    for (int y = 0; y < kSourceHeight; ++y) {
        const double source_polar = polar_angle(y, kSourceHeight);
        const double solid_angle = texel_solid_angle(y, kSourceWidth, kSourceHeight);
        // Column i of the table is centred on the edge between source columns 2i and 2i + 1.
        for (int x = 0; x < kSourceWidth; ++x) {
            const double azimuth = 2 * kPi * (x + 0.5) / kSourceWidth;
            const double n_l =
                std::sin(polar) * std::sin(source_polar) * std::cos(azimuth) + std::cos(polar) * std::cos(source_polar);
            const double weight = weight_of(table, n_l) * solid_angle;
            total += weight;
            const auto column = static_cast<std::size_t>(x);
            weights[column] = weights[column + std::size_t{kSourceWidth}] = weight;
        }
        const Planes& planes = source[static_cast<std::size_t>(y)];
        for (int i = 0; i < columns; ++i) {
            const int edge = 2 * i + 1;
            const double* w = weights.data() + (kSourceWidth - edge);
            double r = 0, g = 0, b = 0;
            for (std::size_t j = 0; j < kSourceWidth; ++j) {
                r += w[j] * planes.r[j];
                g += w[j] * planes.g[j];
                b += w[j] * planes.b[j];
            }
            out[static_cast<std::size_t>(i)] += dvec3(r, g, b);
        }
    }
    for (dvec3& value : out) value /= total;
}

void put(Image& atlas, int x, int y, const dvec3& value)
{
    for (int c = 0; c < 3; ++c) atlas.at(x, y, c) = static_cast<float>(value[c]);
    atlas.at(x, y, 3) = 1;
}

}  // namespace

EnvironmentTables tabulate(const Image& map, unsigned threads)
{
    using Tables = EnvironmentTables;
    assume(map.width > 0 && map.height > 0 && map.channels >= 3);
    const Image source = shrink(map, kSourceWidth, kSourceHeight, threads);
    const Image mirror = shrink(map, std::min(map.width, kMirrorWidth), std::min(map.height, kMirrorHeight), threads);
    constexpr int kSmall = Tables::kRoughTables + 1;
    Tables tables{
        .atlas = Image(std::max(mirror.width, Tables::kTableWidth), mirror.height + kSmall * Tables::kTableHeight, 4),
        .mirror_width = mirror.width,
        .mirror_height = mirror.height};
    for (int y = 0; y < mirror.height; ++y)
        for (int x = 0; x < mirror.width; ++x)
            put(tables.atlas, x, y, {mirror.at(x, y, 0), mirror.at(x, y, 1), mirror.at(x, y, 2)});

    const std::vector<Planes> rows = rows_of(source);
    parallel_for(
        kSmall * Tables::kTableHeight,
        [&](std::size_t i) {
            const int row = static_cast<int>(i) % Tables::kTableHeight;
            const int table = static_cast<int>(i) / Tables::kTableHeight + 1;
            std::vector<dvec3> values(Tables::kTableWidth, dvec3(0));
            prefilter_row(rows, table, row, values);
            for (int x = 0; x < Tables::kTableWidth; ++x)
                put(tables.atlas, x, mirror.height + static_cast<int>(i), values[static_cast<std::size_t>(x)]);
        },
        threads);
    return tables;
}

}  // namespace etalon
