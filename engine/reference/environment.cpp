#include "engine/reference/environment.h"

#include <algorithm>
#include <cmath>

#include "engine/base/parallel.h"
#include "engine/reference/texture.h"

namespace etalon::reference {
namespace {

// R_y(angle) d, the right-handed turn about +Y.
dvec3 turn_y(const dvec3& d, double angle)
{
    const double c = std::cos(angle), s = std::sin(angle);
    return {c * d.x + s * d.z, d.y, -s * d.x + c * d.z};
}

dvec3 texel(const Image& map, int x, int y)
{
    return {map.at(x, y, 0), map.at(x, y, 1), map.at(x, y, 2)};
}

double mean(const dvec3& c)
{
    return (c.x + c.y + c.z) / 3;
}

// The four texels around `uv` and their weights; u wraps, v clamps.
struct Bilinear {
    int x0, x1, y0, y1;
    double wx, wy;
    Bilinear(const dvec2& uv, int width, int height)
    {
        const double x = uv.x * width - 0.5, y = uv.y * height - 0.5;
        const double fx = std::floor(x), fy = std::floor(y);
        wx = x - fx;
        wy = y - fy;
        x0 = wrap_texel(static_cast<long long>(fx), width, Wrap::repeat);
        x1 = wrap_texel(static_cast<long long>(fx) + 1, width, Wrap::repeat);
        y0 = wrap_texel(static_cast<long long>(fy), height, Wrap::clamp_to_edge);
        y1 = wrap_texel(static_cast<long long>(fy) + 1, height, Wrap::clamp_to_edge);
    }
    template <class Fetch>
    dvec3 blend(Fetch&& at) const
    {
        return (1 - wy) * ((1 - wx) * at(x0, y0) + wx * at(x1, y0)) + wy * ((1 - wx) * at(x0, y1) + wx * at(x1, y1));
    }
};

}  // namespace

dvec2 map_from_direction(const dvec3& d)
{
    const double turns = std::atan2(d.x, -d.z) / (2 * kPi);
    const double u = turns - std::floor(turns);
    return {u < 1 ? u : 0, std::acos(std::clamp(d.y, -1.0, 1.0)) / kPi};
}

dvec3 direction_from_map(const dvec2& uv)
{
    const double phi = 2 * kPi * uv.x, theta = kPi * uv.y;
    return {std::sin(theta) * std::sin(phi), std::cos(theta), -std::sin(theta) * std::cos(phi)};
}

dvec3 environment_radiance(const Environment& environment, const dvec3& d)
{
    if (!environment.map) return environment.scale * environment.radiance;
    const Image& map = *environment.map;
    const dvec2 uv = map_from_direction(turn_y(d, -environment.rotation));
    return environment.scale *
           Bilinear(uv, map.width, map.height).blend([&](int x, int y) { return texel(map, x, y); });
}

EnvironmentSampler::EnvironmentSampler(const Environment& environment) : rotation_(environment.rotation)
{
    if (!environment.map || environment.is_black()) return;
    const Image& map = *environment.map;
    width_ = map.width;
    height_ = map.height;
    rows_.assign(static_cast<std::size_t>(height_), 0);
    columns_.assign(map.pixel_count(), 0);
    // A texel's share is the integral of the bilinear map over it: across, each of its neighbours counts 1/8.
    const auto across = [&](int x, int y) {
        const int left = wrap_texel(x - 1, width_, Wrap::repeat), right = wrap_texel(x + 1, width_, Wrap::repeat);
        return (mean(texel(map, left, y)) + 6 * mean(texel(map, x, y)) + mean(texel(map, right, y))) / 8;
    };
    double total = 0;
    for (int y = 0; y < height_; ++y) {
        const int above = std::max(0, y - 1), below = std::min(height_ - 1, y + 1);
        // Exact solid angle of a texel in this row, but for the constant 2π/W.
        const double solid_angle = std::cos(kPi * y / height_) - std::cos(kPi * (y + 1) / height_);
        double* row = columns_.data() + static_cast<std::size_t>(y) * static_cast<std::size_t>(width_);
        double sum = 0;
        for (int x = 0; x < width_; ++x) {
            const double share = (across(x, above) + 6 * across(x, y) + across(x, below)) / 8;
            sum += std::max(0.0, share);
            row[x] = sum;
        }
        if (sum > 0)
            for (int x = 0; x < width_; ++x) row[x] /= sum;
        total += sum * solid_angle;
        rows_[static_cast<std::size_t>(y)] = total;
    }
    if (!(total > 0) || !std::isfinite(total)) {  // all black: no light (S23)
        rows_.clear();
        columns_.clear();
        return;
    }
    for (double& r : rows_) r /= total;
}

namespace {

// The first entry of a running sum above u: never one of zero width (M11). `fraction`: how far into it u lies.
int pick(const double* sums, int count, double u, double& fraction)
{
    const double* found = std::upper_bound(sums, sums + count, u);
    if (found == sums + count)
        found = std::lower_bound(sums, sums + count, sums[count - 1]);  // u beyond a rounded last sum
    const double low = found == sums ? 0.0 : found[-1];
    fraction = std::clamp((u - low) / (*found - low), 0.0, 1 - 1e-16);
    return static_cast<int>(found - sums);
}

double width_of(const double* sums, int i)
{
    return i == 0 ? sums[0] : sums[i] - sums[i - 1];
}

}  // namespace

double EnvironmentSampler::pdf_of_texel(int row, int column, double sin_theta) const
{
    const double* columns = columns_.data() + static_cast<std::size_t>(row) * static_cast<std::size_t>(width_);
    const double share = width_of(rows_.data(), row) * width_of(columns, column);
    return sin_theta > 0 ? share * width_ * height_ / (2 * kPi * kPi * sin_theta) : 0;
}

EnvironmentSampler::Sample EnvironmentSampler::sample(const dvec2& u) const
{
    double fx = 0, fy = 0;
    const int row = pick(rows_.data(), height_, u.y, fy);
    const int column =
        pick(columns_.data() + static_cast<std::size_t>(row) * static_cast<std::size_t>(width_), width_, u.x, fx);
    const dvec2 uv((column + fx) / width_, (row + fy) / height_);
    const dvec3 d = turn_y(direction_from_map(uv), rotation_);
    return {d, pdf_of_texel(row, column, std::sin(kPi * uv.y))};
}

double EnvironmentSampler::pdf(const dvec3& direction) const
{
    if (empty()) return 0;
    const dvec3 d = turn_y(direction, -rotation_);
    const dvec2 uv = map_from_direction(d);
    const int row = std::min(height_ - 1, static_cast<int>(uv.y * height_));
    const int column = std::min(width_ - 1, static_cast<int>(uv.x * width_));
    return pdf_of_texel(row, column, std::sqrt(d.x * d.x + d.z * d.z));
}

dvec3 RadianceMap::bilinear(const dvec2& uv) const
{
    return Bilinear(uv, width, height).blend([&](int x, int y) {
        return texels[static_cast<std::size_t>(y) * static_cast<std::size_t>(width) + static_cast<std::size_t>(x)];
    });
}

// (SH-41)
RadianceMap area_average(const Environment& environment, int width, int height)
{
    RadianceMap out;
    if (!environment.map) {
        out.width = out.height = 1;
        out.texels = {environment.scale * environment.radiance};
        return out;
    }
    const Image& map = *environment.map;
    out.width = width;
    out.height = height;
    const BoxWeights wx = box_weights(map.width, out.width);
    const BoxWeights wy = box_weights(map.height, out.height);
    for (const auto& row : wy.taps)
        for (const auto& column : wx.taps) {
            dvec3 sum(0);
            for (const auto& [y, weight_y] : row)
                for (const auto& [x, weight_x] : column) sum += weight_y * weight_x * texel(map, x, y);
            out.texels.push_back(environment.scale * sum);
        }
    return out;
}

// Lagarde & de Rousiers 2014, "Moving Frostbite to PBR", §4.9.3
dvec3 dominant_reflection(const dvec3& wo, const dvec3& n, double roughness)
{
    const dvec3 mirror = 2 * dot(wo, n) * n - wo;
    const double smooth = 1 - std::min(roughness * roughness, 1.0);
    return n + smooth * (std::sqrt(smooth) + 1 - smooth) * (mirror - n);
}

namespace {

struct Source {  // a texel of the 128×64 map as a light
    dvec3 direction;
    dvec3 radiance;
    double solid_angle;
};

std::vector<Source> sources_of(const RadianceMap& map)
{
    std::vector<Source> sources;
    for (int y = 0; y < map.height; ++y)
        for (int x = 0; x < map.width; ++x) {
            const double solid_angle =
                2 * kPi / map.width * (std::cos(kPi * y / map.height) - std::cos(kPi * (y + 1) / map.height));
            sources.push_back({direction_from_map({(x + 0.5) / map.width, (y + 0.5) / map.height}),
                               map.texels[static_cast<std::size_t>(y) * static_cast<std::size_t>(map.width) +
                                          static_cast<std::size_t>(x)],
                               solid_angle});
        }
    return sources;
}

// (SH-35) at one direction: light weighted by the GGX lobe that reflects it to N seen from N.
dvec3 prefilter(const std::vector<Source>& sources, const dvec3& n, double alpha)
{
    dvec3 sum(0);
    double weights = 0;
    for (const Source& light : sources) {
        const double cosine = dot(n, light.direction);
        if (cosine <= 0) continue;
        const dvec3 h = normalize(n + light.direction);
        const dvec3 s = cross(n, h);
        const double nh = dot(n, h);
        const double k = alpha / (dot(s, s) + nh * nh * alpha * alpha);  // (SH-11), form S6
        const double weight = k * k / kPi * cosine * light.solid_angle;
        sum += weight * light.radiance;
        weights += weight;
    }
    return weights > 0 ? sum / weights : dvec3(0);
}

// (SH-33) E(N)/π, so that constant light gives itself
dvec3 mean_by_cosine(const std::vector<Source>& sources, const dvec3& n)
{
    dvec3 sum(0);
    double weights = 0;
    for (const Source& light : sources) {
        const double weight = std::max(0.0, dot(n, light.direction)) * light.solid_angle;
        sum += weight * light.radiance;
        weights += weight;
    }
    return sum / weights;
}

}  // namespace

EnvironmentTables::EnvironmentTables(const Environment& environment, unsigned threads) : rotation_(environment.rotation)
{
    if (!environment.map || environment.is_black()) {
        constant_ = true;
        radiance_ = environment.is_black() ? dvec3(0) : environment.scale * environment.radiance;
        return;
    }
    const std::vector<Source> sources = sources_of(area_average(environment, 128, 64));
    tables_[0] =
        area_average(environment, std::min(environment.map->width, 512), std::min(environment.map->height, 256));
    const auto fill = [&](RadianceMap& table, auto&& value) {
        table.width = 64;
        table.height = 32;
        table.texels.resize(64 * 32);
        parallel_for(
            32,
            [&](std::size_t y) {
                for (std::size_t x = 0; x < 64; ++x) {
                    const dvec2 uv((static_cast<double>(x) + 0.5) / 64, (static_cast<double>(y) + 0.5) / 32);
                    table.texels[y * 64 + x] = value(direction_from_map(uv));
                }
            },
            threads);
    };
    for (std::size_t i = 1; i < tables_.size(); ++i) {
        const double roughness = 0.2 * static_cast<double>(i);
        fill(tables_[i], [&](const dvec3& n) { return prefilter(sources, n, roughness * roughness); });
    }
    fill(cosine_, [&](const dvec3& n) { return mean_by_cosine(sources, n); });
}

dvec3 EnvironmentTables::irradiance(const dvec3& n) const
{
    if (constant_) return kPi * radiance_;
    return kPi * cosine_.bilinear(map_from_direction(turn_y(n, -rotation_)));
}

dvec3 EnvironmentTables::prefiltered(const dvec3& r, double roughness) const
{
    if (constant_) return radiance_;
    const dvec2 uv = map_from_direction(turn_y(r, -rotation_));
    const double at = std::clamp(roughness, 0.0, 1.0) * 5;
    const auto fine = static_cast<std::size_t>(std::min(4.0, std::floor(at)));
    const double blend = at - static_cast<double>(fine);
    return (1 - blend) * tables_[fine].bilinear(uv) + blend * tables_[fine + 1].bilinear(uv);
}

}  // namespace etalon::reference
