#include <algorithm>
#include <cmath>

#include "engine/reference/post_parts.h"

namespace etalon::reference {
namespace {

constexpr int kLevels = 32;  // along luminance

/// Cells of colour times weight, and weight, over place and luminance (Paris & Durand 2006; Chen et al. 2007).
struct Grid {
    ivec3 size{0};
    std::vector<dvec4> cells;

    explicit Grid(const ivec3& cell_count)
        : size(cell_count), cells(std::size_t(size.x) * std::size_t(size.y) * std::size_t(size.z), dvec4(0))
    {}
    bool holds(const ivec3& p) const
    {
        return p.x >= 0 && p.y >= 0 && p.z >= 0 && p.x < size.x && p.y < size.y && p.z < size.z;
    }
    dvec4& at(const ivec3& p)
    {
        return cells[(std::size_t(p.z) * std::size_t(size.y) + std::size_t(p.y)) * std::size_t(size.x) +
                     std::size_t(p.x)];
    }
};

/// Visits the eight cells around a point of the grid with the weights of their tents.
template <class Visit>
void around(Grid& grid, const dvec3& p, Visit visit)
{
    const ivec3 first(glm::floor(p));
    for (int corner = 0; corner < 8; ++corner) {
        const ivec3 cell = first + ivec3(corner & 1, corner >> 1 & 1, corner >> 2);
        if (!grid.holds(cell)) continue;
        const dvec3 tent = 1.0 - glm::abs(p - dvec3(cell));
        visit(grid.at(cell), tent.x * tent.y * tent.z);
    }
}

void blur(Grid& grid, int axis)
{
    constexpr int kRadius = 4;
    const double variance = 2.0 / 3;  // with the tents of splatting and reading: 1
    Grid from = grid;
    ivec3 p(0);
    for (p.z = 0; p.z < grid.size.z; ++p.z)
        for (p.y = 0; p.y < grid.size.y; ++p.y)
            for (p.x = 0; p.x < grid.size.x; ++p.x) {
                dvec4 sum(0);
                for (int i = -kRadius; i <= kRadius; ++i) {
                    ivec3 q = p;
                    q[axis] += i;
                    if (from.holds(q)) sum += std::exp(-i * i / (2 * variance)) * from.at(q);
                }
                grid.at(p) = sum;
            }
}

}  // namespace

void bilateral_grid(PostPicture& picture, double sigma_s, double sigma_r)
{
    const double spacing = std::max(sigma_s, 1.0);
    const double level =
        std::max(sigma_r / std::sqrt(3.0), 1e-18);  // greys that differ by it differ by sigma_r in colour
    const auto place = [&](int x, int y, const dvec4& pixel) {
        return dvec3(x / spacing, y / spacing, std::clamp(luminance(pixel) / level, 0.0, kLevels - 1.0));
    };
    Grid grid(ivec3(int((picture.width - 1) / spacing) + 2, int((picture.height - 1) / spacing) + 2, kLevels));
    for (int y = 0; y < picture.height; ++y)
        for (int x = 0; x < picture.width; ++x) {
            const dvec4& pixel = picture.at(x, y);
            if (!is_finite(pixel)) continue;
            around(grid, place(x, y, pixel),
                   [&](dvec4& cell, double weight) { cell += weight * dvec4(dvec3(pixel), 1); });
        }
    for (int axis = 0; axis < 3; ++axis) blur(grid, axis);
    replace_each(picture, [&](const PostPicture& from, int x, int y) {
        const dvec4& pixel = from.at(x, y);
        dvec4 sum(0);
        around(grid, place(x, y, pixel), [&](dvec4& cell, double weight) { sum += weight * cell; });
        return dvec4(dvec3(sum) / sum.w, pixel.w);
    });
}

}  // namespace etalon::reference
