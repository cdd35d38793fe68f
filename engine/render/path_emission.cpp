#include "engine/render/path_emission.h"

#include <algorithm>
#include <cmath>

#include "engine/image/develop.h"

namespace etalon {
namespace {

int wrapped(double coordinate, int size, Wrap wrap)
{
    if (!std::isfinite(coordinate)) return 0;
    double x = coordinate;
    if (wrap == Wrap::clamp_to_edge) {
        x = std::clamp(x, 0.0, 1.0);
    } else if (wrap == Wrap::repeat) {
        x -= std::floor(x);
    } else {
        x -= 2 * std::floor(x / 2);
        x = x > 1 ? 2 - x : x;
    }
    return std::clamp(static_cast<int>(x * size), 0, size - 1);
}

dvec3 nearest_texel(const Scene& scene, const Texture& texture, const dvec2& uv)
{
    const Texels& image = scene.images[texture.image];
    const int x = wrapped(uv.x, image.width, texture.sampler.wrap_u);
    const int y = wrapped(uv.y, image.height, texture.sampler.wrap_v);
    const std::size_t first = 4 * (std::size_t(y) * std::size_t(image.width) + std::size_t(x));
    dvec3 value;
    for (int c = 0; c < 3; ++c) {
        const std::size_t at = first + std::size_t(c);
        value[c] = linear_from_srgb(image.is_8_bit ? image.bytes[at] / 255.0 : double(image.wide[at]));
    }
    return value;
}

}  // namespace

double mean_emission(const Scene& scene, const Material& material, const std::array<vec2, 3>& uv)
{
    const TextureUse& use = material.emissive_texture;
    const auto mean = [](const dvec3& v) { return (v.x + v.y + v.z) / 3; };
    if (!use.present() || scene.textures[use.texture].image == kNone) return mean(material.emission);

    constexpr int kSide = 6;  // points of a triangular grid of this many a side
    double sum = 0;
    int points = 0;
    for (int i = 0; i < kSide; ++i) {
        for (int j = 0; i + j < kSide; ++j) {
            const double b = (i + 1.0 / 3) / kSide;
            const double c = (j + 1.0 / 3) / kSide;
            const dvec2 at = (1 - b - c) * dvec2(uv[0]) + b * dvec2(uv[1]) + c * dvec2(uv[2]);
            const dvec2 moved(use.transform * dvec3(at, 1));
            sum += mean(material.emission * nearest_texel(scene, scene.textures[use.texture], moved));
            ++points;
        }
    }
    return sum / points;
}

}  // namespace etalon
