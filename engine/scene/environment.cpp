#include "engine/scene/environment.h"

#include <algorithm>

#include "engine/base/error.h"
#include "engine/image/io.h"

namespace etalon {

namespace {

constexpr int kStudioWidth = 256;
constexpr int kStudioHeight = 128;

// A soft box: a lobe about `axis` that falls to 1/e where 1 - cos = 1/sharpness.
double lobe(const dvec3& direction, const dvec3& axis, double sharpness)
{
    return std::exp(sharpness * (dot(direction, normalize(axis)) - 1));
}

// Grey, brighter above, with a key from the upper right in front and a weaker fill from the left.
double studio_radiance(const dvec3& d)
{
    const double up = 0.5 + 0.5 * d.y;
    return 0.25 + 0.55 * up * up + 5.0 * lobe(d, dvec3(0.6, 0.9, 0.7), 12) + 1.2 * lobe(d, dvec3(-1.0, 0.35, 0.4), 6) +
           0.8 * lobe(d, dvec3(0.1, 0.5, -1.0), 8);
}

}  // namespace

Environment studio_environment()
{
    auto map = std::make_shared<Image>(kStudioWidth, kStudioHeight, 3);
    double sum = 0;
    double weights = 0;
    for (int j = 0; j < kStudioHeight; ++j)
        for (int i = 0; i < kStudioWidth; ++i) {
            const double polar = kPi * (j + 0.5) / kStudioHeight;
            const double turn = 2 * kPi * (i + 0.5) / kStudioWidth;
            const dvec3 d(std::sin(polar) * std::sin(turn), std::cos(polar),
                          -std::sin(polar) * std::cos(turn));  // (SH-40)
            const double value = studio_radiance(d);
            for (int c = 0; c < 3; ++c) map->at(i, j, c) = static_cast<float>(value);
            sum += value * std::sin(polar);
            weights += std::sin(polar);
        }
    const auto scale = static_cast<float>(weights / sum);
    for (float& value : map->values) value *= scale;
    Environment out;
    out.map = std::move(map);
    return out;
}

Environment resolve_environment(const SceneRoot& root, const PoseSettings& settings, bool has_light,
                                std::vector<std::string>& notes)
{
    if (!std::isfinite(settings.environment_rotation) || !std::isfinite(settings.environment_intensity) ||
        settings.environment_intensity < 0)
        throw Error(Blame::input, "environment rotation and intensity must be finite, and intensity not negative");
    Environment out;
    if (settings.no_environment) return out;
    if (settings.environment) {
        out = *settings.environment;
    } else if (root.environment) {
        out = *root.environment;
    } else if (!has_light) {
        out = studio_environment();
        notes.push_back("no light in the scene: lit by the neutral studio environment");
    }
    out.rotation += settings.environment_rotation * kPi / 180;
    out.scale *= settings.environment_intensity;
    return out;
}

Environment read_environment(const std::filesystem::path& path)
{
    Image picture = read_image(path);
    replace_nonfinite(picture);
    auto map = std::make_shared<Image>(picture.width, picture.height, 3);
    for (int y = 0; y < picture.height; ++y)
        for (int x = 0; x < picture.width; ++x)
            for (int c = 0; c < 3; ++c) map->at(x, y, c) = std::max(picture.at(x, y, c), 0.0f);
    Environment out;
    out.map = std::move(map);
    return out;
}

}  // namespace etalon
