#pragma once
#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "engine/scene/pose.h"

namespace etalon::reference {

/// Sub-pixel positions are multiples of 2⁻⁸ pixel, as Vulkan devices snap them (subPixelPrecisionBits = 8; promises
/// G1–G3).
inline constexpr std::int64_t kSubPixels = 256;

/// (TR-1) Twice the signed area of (p, a, b), pixel² / 2¹⁶, y down: > 0 where a → b has p on its right.
struct FixedPoint {
    std::int64_t x = 0, y = 0;
};
inline std::int64_t edge(const FixedPoint& a, const FixedPoint& b, const FixedPoint& p)
{
    return (a.x - p.x) * (b.y - p.y) - (a.y - p.y) * (b.x - p.x);
}

/// (TR-2) Whether a sample exactly on a → b belongs to the triangle whose inside is where edge() > 0.
inline bool is_top_left(const FixedPoint& a, const FixedPoint& b)
{
    const bool top = a.y == b.y && b.x > a.x;  // interior below
    const bool left = b.y < a.y;               // interior to the right
    return top || left;
}

/// (TR-2) Whether the clockwise (y down) triangle of positive area covers `p`.
bool covers(const std::array<FixedPoint, 3>& corners, const FixedPoint& p);

/// clip = projection * camera space. (TF-4), (TF-5); `far`: metres, orthographic only.
dmat4 projection(const View& view, double far);

/// A vertex before the division, with where it lies in its element: p = p0 + b.x (p1 - p0) + b.y (p2 - p0).
struct ClipVertex {
    dvec4 position{0};
    dvec2 b{0};
};

/// The part of a convex polygon in front of the near plane and inside a guard band of `guard` times the view, in
/// homogeneous coordinates, so that nothing is divided by w ≤ 0 (promise G6). Empty where nothing is left.
std::vector<ClipVertex> clip(std::span<const ClipVertex> polygon, const dvec2& guard);

/// A vertex on the film.
struct ScreenVertex {
    dvec2 pixel{0};      ///< (TF-6), before snapping: attributes are interpolated between the true positions
    FixedPoint snapped;  ///< what coverage is decided by
    double depth = 0;    ///< z / w
    double inverse_w = 1;
    dvec2 b{0};
};

/// Something to be drawn: a triangle on the film (also a piece of a line, or a point), or a whole sphere.
struct Piece {
    std::array<ScreenVertex, 3> v;            ///< clockwise with y down; unused for spheres
    std::array<std::uint32_t, 3> vertices{};  ///< of the primitive: what `b` interpolates between
    std::uint32_t object = 0;                 ///< draw, or draws.size() + sphere
    bool front = true;
    int x0 = 0, y0 = 0, x1 = 0, y1 = 0;  ///< pixels that it may touch: x0 ≤ x < x1, y0 ≤ y < y1
};

/// How wide points and lines are, pixels. (SH-7)
struct Widths {
    double point = 1;
    double line = 1;
};

/// Pieces of draw `object`, clipped and culled, in the order of its elements. (SH-32)
std::vector<Piece> pieces_of_draw(const PosedScene& posed, std::uint32_t object, const dmat4& clip_from_camera,
                                  const Widths& widths = {});

/// The piece of sphere `sphere` with the pixels that its box may cover; nothing where it lies behind the viewer.
std::optional<Piece> piece_of_sphere(const PosedScene& posed, std::uint32_t sphere);

/// (TR-3), (TR-4) at a point of the film.
struct Interpolation {
    dvec2 b{0};              ///< perspective-correct
    dvec2 b_dx{0}, b_dy{0};  ///< per pixel (TX-1)
    bool valid = false;      ///< false beyond the horizon of the triangle's plane
};
Interpolation interpolate(const Piece& piece, const dvec2& pixel);
/// Depth, affine on the film.
double depth_at(const Piece& piece, const dvec2& pixel);

}  // namespace etalon::reference
