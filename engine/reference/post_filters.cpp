#include <algorithm>
#include <array>
#include <cmath>

#include "engine/math/robust.h"
#include "engine/reference/post_parts.h"

namespace etalon::reference {
namespace {

/// A mean of neighbours: those that are not finite take no part.
class WeightedMean {
 public:
    void add(const dvec4& pixel, double weight)
    {
        if (!is_finite(pixel)) return;
        sum_ += weight * pixel;
        weights_ += weight;
    }
    dvec4 mean() const { return sum_ / weights_; }

 private:
    dvec4 sum_{0};
    double weights_ = 0;
};

double bell(double distance, double sigma)
{
    const double d = distance / sigma;
    return std::exp(-0.5 * d * d);
}

int radius_of(double sigma)
{
    return int(std::ceil(4 * sigma));
}

void gaussian_axis(PostPicture& picture, double sigma, int dx, int dy)
{
    replace_each(picture, [&](const PostPicture& from, int x, int y) {
        WeightedMean mean;
        for (int i = -radius_of(sigma); i <= radius_of(sigma); ++i)
            mean.add(from.at(x + i * dx, y + i * dy), bell(i, sigma));
        return mean.mean();
    });
}

/// The bilateral filter over a window of so many pixels to each side (IP-7), (IP-8).
void bilateral_window(PostPicture& picture, const ivec2& reach, double sigma_s, double sigma_r)
{
    replace_each(picture, [&](const PostPicture& from, int x, int y) {
        const dvec4 centre = from.at(x, y);
        WeightedMean mean;
        for (int dy = -reach.y; dy <= reach.y; ++dy)
            for (int dx = -reach.x; dx <= reach.x; ++dx) {
                const dvec4& there = from.at(x + dx, y + dy);
                const double distance = std::hypot(double(dx), double(dy));
                const double difference = robust_length(dvec3(there) - dvec3(centre));
                mean.add(there, bell(distance, sigma_s) * bell(difference, sigma_r));
            }
        return mean.mean();
    });
}

double median_of(std::vector<double>& values)
{
    std::sort(values.begin(), values.end());
    const std::size_t n = values.size();
    const double low = values[(n - 1) / 2], high = values[n / 2];
    return low + 0.5 * (high - low);
}

dvec4 surface_at(const PostPicture& picture, int x, int y)
{
    const std::size_t i = picture.nearest(x, y);
    const dvec3 normal(picture.aovs->normal[i]);
    const double depth = picture.aovs->depth[i];
    return dvec4(etalon::is_finite(normal) ? normal : dvec3(0), std::isfinite(depth) && depth > 0 ? 1 / depth : 0);
}

}  // namespace

void gaussian(PostPicture& picture, double sigma)
{
    if (sigma < kPostLeastSigma) return;
    gaussian_axis(picture, sigma, 1, 0);
    gaussian_axis(picture, sigma, 0, 1);
}

void median(PostPicture& picture, int radius)
{
    replace_each(picture, [&](const PostPicture& from, int x, int y) {
        std::array<std::vector<double>, 4> channels;
        for (int dy = -radius; dy <= radius; ++dy)
            for (int dx = -radius; dx <= radius; ++dx) {
                const dvec4& there = from.at(x + dx, y + dy);
                if (!is_finite(there)) continue;
                for (int c = 0; c < 4; ++c) channels[std::size_t(c)].push_back(there[c]);
            }
        return dvec4(median_of(channels[0]), median_of(channels[1]), median_of(channels[2]), median_of(channels[3]));
    });
}

void bilateral(PostPicture& picture, const PostStage& stage)
{
    const double sigma_s = stage["sigma_s"], sigma_r = stage["sigma_r"];
    if (sigma_s < kPostLeastSigma || sigma_r == 0) return;
    const int radius = radius_of(sigma_s);
    if (stage.is("method", "grid")) return bilateral_grid(picture, sigma_s, sigma_r);
    if (stage.is("method", "exact")) return bilateral_window(picture, ivec2(radius), sigma_s, sigma_r);
    bilateral_window(picture, ivec2(radius, 0), sigma_s, sigma_r);
    bilateral_window(picture, ivec2(0, radius), sigma_s, sigma_r);
}

void bloom(PostPicture& picture, const PostStage& stage)
{
    const double threshold = stage["threshold"];
    const int levels = int(stage["levels"]);
    PostPicture bright = picture;
    for (dvec4& pixel : bright.pixels) {
        const double y = luminance(pixel);
        if (is_finite(pixel) && threshold > 0)
            pixel = dvec4(dvec3(pixel) * (y > threshold ? (y - threshold) / y : 0), pixel.w);
    }
    for (int level = 0; level < levels; ++level) {
        PostPicture scattered = bright;
        gaussian(scattered, std::min(stage["sigma"] * std::exp2(level), 1000.0));
        for (std::size_t i = 0; i < picture.pixels.size(); ++i) {
            if (!is_finite(picture.pixels[i])) continue;
            const dvec3 change(scattered.pixels[i] - bright.pixels[i]);
            picture.pixels[i] += dvec4(stage["strength"] / levels * change, 0);
        }
    }
}

void sobel(PostPicture& picture, double gain)
{
    replace_each(picture, [&](const PostPicture& from, int x, int y) {
        const dvec4 centre = from.at(x, y);
        const auto light = [&](int dx, int dy) {
            const dvec4& there = from.at(x + dx, y + dy);
            return luminance(is_finite(there) ? there : centre);
        };
        dvec2 gradient(0);  // of differences across, so that a constant has none to the last bit (I2)
        for (int i = -1; i <= 1; ++i)
            gradient += (2 - std::abs(i)) / 8.0 * dvec2(light(1, i) - light(-1, i), light(i, 1) - light(i, -1));
        return dvec4(dvec3(gain * std::hypot(gradient.x, gradient.y)), centre.w);
    });
}

void outline(PostPicture& picture, const PostStage& stage)
{
    replace_each(picture, [&](const PostPicture& from, int x, int y) {
        dvec4 gx(0), gy(0);
        double nearest = 0;
        for (int dy = -1; dy <= 1; ++dy)
            for (int dx = -1; dx <= 1; ++dx) {
                const dvec4 there = surface_at(from, x + dx, y + dy);
                gx += dx * (2 - std::abs(dy)) / 8.0 * there;
                gy += dy * (2 - std::abs(dx)) / 8.0 * there;
                nearest = std::max(nearest, there.w);
            }
        const double normal = std::sqrt(dot(dvec3(gx), dvec3(gx)) + dot(dvec3(gy), dvec3(gy)));
        const double depth = nearest > 0 ? std::hypot(gx.w, gy.w) / nearest : 0;
        // A width of 0 draws where there is any change, one of Inf nowhere.
        const auto full = [](double change, double width) { return change == 0 ? 0 : change / std::max(width, 1e-18); };
        const double most = std::max(full(normal, stage["normal"]), full(depth, stage["depth"]));
        const double line = stage["strength"] * std::clamp(most, 0.0, 1.0);
        const dvec4 centre = from.at(x, y);
        return dvec4(dvec3(centre) * (1 - line), centre.w + line * (1 - centre.w));
    });
}

}  // namespace etalon::reference
