#include <algorithm>
#include <cmath>

#include "engine/reference/post_parts.h"

namespace etalon::reference {
namespace {

/// What bends rows and columns alike, as a lone pixel or a diagonal beside constants does, is a row.
constexpr double kTie = 1e-4;

/// Roughly as bright as it looks.
double luma_of(const dvec4& pixel)
{
    return std::sqrt(std::clamp(luminance(pixel), 0.0, 1.0));
}

/// The 3 x 3 lumas about a pixel; neighbours that are not finite count as the pixel.
struct Neighbourhood {
    double l[3][3];  // [y][x]

    Neighbourhood(const PostPicture& picture, int x, int y)
    {
        const dvec4& centre = picture.at(x, y);
        for (int dy = -1; dy <= 1; ++dy)
            for (int dx = -1; dx <= 1; ++dx) {
                const dvec4& there = picture.at(x + dx, y + dy);
                l[dy + 1][dx + 1] = luma_of(is_finite(there) ? there : centre);
            }
    }
    double own() const { return l[1][1]; }
    double brightest() const { return std::max({l[0][1], l[1][0], l[1][1], l[1][2], l[2][1]}); }
    double darkest() const { return std::min({l[0][1], l[1][0], l[1][1], l[1][2], l[2][1]}); }
    /// How far the pixel is from the mean of its neighbours, in parts of the contrast: 1 of a lone pixel.
    double loneliness() const
    {
        const double sides = l[0][1] + l[1][0] + l[1][2] + l[2][1];
        const double corners = l[0][0] + l[0][2] + l[2][0] + l[2][2];
        return std::clamp(std::abs((2 * sides + corners) / 12 - own()) / (brightest() - darkest()), 0.0, 1.0);
    }
    /// Whether the luma bends more down the columns than along the rows.
    bool is_horizontal() const
    {
        double down = 0, along = 0;
        for (int i = 0; i < 3; ++i) {
            const double weight = i == 1 ? 2 : 1;
            down += weight * std::abs((l[0][i] - l[1][i]) + (l[2][i] - l[1][i]));
            along += weight * std::abs((l[i][0] - l[i][1]) + (l[i][2] - l[i][1]));
        }
        return down + kTie >= along;
    }
};

/// An edge between a pixel and its neighbour `across`, running `along`.
struct Edge {
    ivec2 across{0};
    ivec2 along{0};
    double middle = 0;    ///< luma on the edge
    double contrast = 0;  ///< a quarter of that across it
};

Edge edge_at(const Neighbourhood& n)
{
    const bool horizontal = n.is_horizontal();
    const double before = horizontal ? n.l[0][1] : n.l[1][0];
    const double after = horizontal ? n.l[2][1] : n.l[1][2];
    const bool towards_before = std::abs(before - n.own()) >= std::abs(after - n.own());
    const double other = towards_before ? before : after;
    const int side = towards_before ? -1 : 1;
    return {.across = horizontal ? ivec2(0, side) : ivec2(side, 0),
            .along = horizontal ? ivec2(1, 0) : ivec2(0, 1),
            .middle = (n.own() + other) / 2,
            .contrast = std::abs(other - n.own()) / 4};
}

struct End {
    int steps = 0;
    double difference = 0;  ///< of the luma on the edge from its middle
};

End find_end(const PostPicture& picture, const ivec2& at, const Edge& edge, int direction, int reach)
{
    const double own = luma_of(picture.at(at.x, at.y));
    const auto luma = [&](const ivec2& p) {
        const dvec4& there = picture.at(p.x, p.y);
        return is_finite(there) ? luma_of(there) : own;
    };
    End end;
    while (end.steps < reach) {
        ++end.steps;
        const ivec2 there = at + direction * end.steps * edge.along;
        end.difference = (luma(there) + luma(there + edge.across)) / 2 - edge.middle;
        if (std::abs(end.difference) >= edge.contrast) break;
    }
    return end;
}

}  // namespace

void fxaa(PostPicture& picture, const PostStage& stage)
{
    replace_each(picture, [&](const PostPicture& from, int x, int y) {
        const dvec4 centre = from.at(x, y);
        const Neighbourhood n(from, x, y);
        const double range = n.brightest() - n.darkest();
        if (range == 0 || range < std::max(stage["floor"], stage["threshold"] * n.brightest())) return centre;
        const double lone = n.loneliness();
        const double softened = lone * lone * (3 - 2 * lone);
        const double subpixel = softened * softened * stage["subpixel"];

        const Edge edge = edge_at(n);
        const End back = find_end(from, ivec2(x, y), edge, -1, int(stage["reach"]));
        const End fore = find_end(from, ivec2(x, y), edge, 1, int(stage["reach"]));
        const End& nearer = back.steps < fore.steps ? back : fore;
        const bool bends_here = (n.own() < edge.middle) != (nearer.difference < 0);
        const double shift = bends_here ? 0.5 - nearer.steps / double(back.steps + fore.steps) : 0;
        const dvec4& other = from.at(x + edge.across.x, y + edge.across.y);
        return is_finite(other) ? centre + std::max(shift, subpixel) * (other - centre) : centre;
    });
}

}  // namespace etalon::reference
