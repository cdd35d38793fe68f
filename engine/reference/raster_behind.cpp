#include "engine/reference/raster_behind.h"

#include <algorithm>
#include <cmath>

#include "engine/reference/texture.h"

namespace etalon::reference {

PictureBehind::PictureBehind(ivec2 size, std::vector<dvec4> pixels)
{
    levels_.push_back({size, std::move(pixels)});
    while (levels_.back().size != ivec2(1)) {
        const Level& above = levels_.back();
        Level level{.size = glm::max(above.size / 2, ivec2(1)), .texels = {}};
        const BoxWeights wx = box_weights(above.size.x, level.size.x), wy = box_weights(above.size.y, level.size.y);
        for (const auto& row : wy.taps)
            for (const auto& column : wx.taps) {
                dvec4 sum(0);
                for (const auto& y : row)
                    for (const auto& x : column)
                        sum += y.weight * x.weight *
                               above.texels[static_cast<std::size_t>(y.index) * static_cast<std::size_t>(above.size.x) +
                                            static_cast<std::size_t>(x.index)];
                level.texels.push_back(sum);
            }
        levels_.push_back(std::move(level));
    }
}

dvec4 PictureBehind::Level::bilinear(const dvec2& uv) const
{
    const dvec2 at = glm::clamp(uv * dvec2(size) - 0.5, dvec2(-1), dvec2(size));
    const dvec2 low = glm::floor(at), f = at - low;
    const auto texel = [&](int dx, int dy) {
        const int x = std::clamp(static_cast<int>(low.x) + dx, 0, size.x - 1);
        const int y = std::clamp(static_cast<int>(low.y) + dy, 0, size.y - 1);
        return texels[static_cast<std::size_t>(y) * static_cast<std::size_t>(size.x) + static_cast<std::size_t>(x)];
    };
    return (1 - f.y) * ((1 - f.x) * texel(0, 0) + f.x * texel(1, 0)) +
           f.y * ((1 - f.x) * texel(0, 1) + f.x * texel(1, 1));
}

dvec4 PictureBehind::at(const dvec2& film, double level) const
{
    const dvec2 uv = film / dvec2(levels_[0].size);
    const double l = std::clamp(level, 0.0, static_cast<double>(levels_.size() - 1));
    const auto fine = static_cast<std::size_t>(l);
    const double blend = l - std::floor(l);
    const dvec4 sharp = levels_[fine].bilinear(uv);
    return blend > 0 ? (1 - blend) * sharp + blend * levels_[fine + 1].bilinear(uv) : sharp;
}

}  // namespace etalon::reference
