#include "engine/reference/scene_index.h"

namespace etalon::reference {
namespace {

constexpr std::size_t kLeaf = 4;     // shapes that a leaf may hold
constexpr int kBins = 16;            // candidate planes of the area heuristic, per axis
constexpr int kHeuristicDepth = 48;  // below it halves: 48 + log2(2^32 / kLeaf) stays under kMaxDepth

}  // namespace

dvec3 geometric_normal(const Shape& shape, const dvec3& p)
{
    if (shape.is_sphere()) return (p - shape.p0) / length(p - shape.p0);
    const dvec3 n = cross(shape.p1 - shape.p0, shape.p2 - shape.p0);
    const double size = length(n);
    if (size == 0) return dvec3(0);
    return n * ((shape.mirrored ? -1 : 1) / size);
}

struct SceneIndex::Piece {
    Box box;
    dvec3 center;
    std::uint32_t shape;
};

SceneIndex::Box SceneIndex::bounds(const Shape& shape)
{
    Box box;
    if (shape.is_sphere()) {
        // Padded: a hit's rounding may lie outside the exact box.
        const dvec3 r(shape.p1.x * (1 + 1e-14));
        const dvec3 slack = glm::abs(shape.p0) * 1e-15;
        box.add(shape.p0 - r - slack);
        box.add(shape.p0 + r + slack);
        return box;
    }
    box.add(shape.p0);
    box.add(shape.p1);
    box.add(shape.p2);
    return box;
}

SceneIndex::SceneIndex(const PosedScene& posed)
{
    for (std::size_t d = 0; d < posed.draws.size(); ++d) {
        const Draw& draw = posed.draws[d];
        const Primitive& primitive = posed.primitive(draw);
        if (primitive.topology != Topology::triangles) continue;  // (SH-7)
        const bool mirrored = glm::determinant(dmat3(draw.world_from_object)) < 0;
        const auto world = [&](std::uint32_t i) {
            return dvec3(draw.world_from_object * dvec4(dvec3(primitive.positions[i]), 1));  // (TF-1)
        };
        for (std::size_t i = 0; i + 2 < primitive.indices.size(); i += 3) {
            Shape shape{.p0 = world(primitive.indices[i]),
                        .p1 = world(primitive.indices[i + 1]),
                        .p2 = world(primitive.indices[i + 2]),
                        .object = static_cast<std::uint32_t>(d),
                        .element = static_cast<std::uint32_t>(i / 3),
                        .material = primitive.material,
                        .mirrored = mirrored};
            // Without area (or finite corners) nothing can meet it.
            const double size = length(cross(shape.p1 - shape.p0, shape.p2 - shape.p0));
            if (size > 0 && std::isfinite(size)) shapes_.push_back(shape);
        }
    }
    for (std::size_t s = 0; s < posed.spheres.size(); ++s) {
        const PosedSphere& sphere = posed.spheres[s];
        if (!(sphere.radius > 0) || !is_finite(sphere.center) || !std::isfinite(sphere.radius)) continue;
        shapes_.push_back({.p0 = sphere.center,
                           .p1 = dvec3(sphere.radius, 0, 0),
                           .p2 = dvec3(0),
                           .object = static_cast<std::uint32_t>(posed.draws.size() + s),
                           .element = Shape::kSphereElement,
                           .material = sphere.material,
                           .mirrored = false});
    }
    if (shapes_.empty()) return;

    std::vector<Piece> pieces(shapes_.size());
    for (std::uint32_t i = 0; i < shapes_.size(); ++i) {
        const Box box = bounds(shapes_[i]);
        pieces[i] = {.box = box, .center = 0.5 * box.low + 0.5 * box.high, .shape = i};
    }
    nodes_.reserve(shapes_.size());
    build(pieces, 0, pieces.size(), 0);
    std::vector<Shape> in_leaf_order(shapes_.size());
    for (std::size_t i = 0; i < pieces.size(); ++i) in_leaf_order[i] = shapes_[pieces[i].shape];
    shapes_ = std::move(in_leaf_order);
}

// (RT-5) with c_t = c_i, over kBins planes an axis.
void SceneIndex::build(std::vector<Piece>& pieces, std::size_t begin, std::size_t end, int depth)
{
    Box box, centers;
    for (std::size_t i = begin; i < end; ++i) box.add(pieces[i].box), centers.add(pieces[i].center);
    const std::size_t self = nodes_.size();
    nodes_.push_back({.box = box,
                      .index = static_cast<std::uint32_t>(begin),
                      .count = static_cast<std::uint32_t>(end - begin),
                      .axis = 0});
    if (end - begin <= kLeaf) return;

    int best_axis = -1, best_plane = 0;
    double best_cost = std::numeric_limits<double>::infinity();
    const dvec3 extent = centers.high - centers.low;
    const auto bin = [&](const Piece& piece, int axis) {
        const double x = (piece.center[axis] - centers.low[axis]) / extent[axis];
        return std::min(kBins - 1, static_cast<int>(x * kBins));
    };
    for (int axis = 0; axis < 3 && depth < kHeuristicDepth; ++axis) {
        if (!(extent[axis] > 0)) continue;
        std::array<Box, kBins> boxes;
        std::array<std::size_t, kBins> counts{};
        for (std::size_t i = begin; i < end; ++i) {
            const auto b = static_cast<std::size_t>(bin(pieces[i], axis));
            boxes[b].add(pieces[i].box);
            ++counts[b];
        }
        std::array<double, kBins> right_cost{};
        Box right;
        std::size_t n = 0;
        for (std::size_t b = kBins - 1; b > 0; --b) {
            right.add(boxes[b]);
            n += counts[b];
            right_cost[b] = right.half_area() * static_cast<double>(n);
        }
        Box left;
        n = 0;
        for (std::size_t b = 0; b + 1 < kBins; ++b) {
            left.add(boxes[b]);
            n += counts[b];
            const double cost = left.half_area() * static_cast<double>(n) + right_cost[b + 1];
            if (n > 0 && n < end - begin && cost < best_cost) {
                best_cost = cost;
                best_axis = axis;
                best_plane = static_cast<int>(b);
            }
        }
    }

    const auto first = pieces.begin() + static_cast<std::ptrdiff_t>(begin);
    const auto last = pieces.begin() + static_cast<std::ptrdiff_t>(end);
    std::size_t middle = begin + (end - begin) / 2;
    if (best_axis >= 0) {
        const auto split = std::partition(first, last, [&](const Piece& p) { return bin(p, best_axis) <= best_plane; });
        middle = static_cast<std::size_t>(split - pieces.begin());
    } else {  // too deep, or all centres in one place: halves
        best_axis = extent.x > extent.y ? (extent.x > extent.z ? 0 : 2) : (extent.y > extent.z ? 1 : 2);
        std::nth_element(
            first, first + static_cast<std::ptrdiff_t>(middle - begin), last, [&](const Piece& a, const Piece& b) {
                return a.center[best_axis] != b.center[best_axis] ? a.center[best_axis] < b.center[best_axis]
                                                                  : a.shape < b.shape;
            });
    }
    nodes_[self].count = 0;
    nodes_[self].axis = static_cast<std::uint32_t>(best_axis);
    build(pieces, begin, middle, depth + 1);
    nodes_[self].index = static_cast<std::uint32_t>(nodes_.size());
    build(pieces, middle, end, depth + 1);
}

}  // namespace etalon::reference
