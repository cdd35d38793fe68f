#pragma once
#include <algorithm>
#include <array>
#include <cstdint>
#include <optional>
#include <vector>

#include "engine/reference/intersect.h"
#include "engine/scene/pose.h"

namespace etalon::reference {

/// A triangle or a sphere in world space. Triangles: the three corners in the order of the file. Spheres: p0 is the
/// centre and p1.x the radius.
struct Shape {
    dvec3 p0{0}, p1{0}, p2{0};
    std::uint32_t object = 0;    ///< index of the draw, or draws.size() + index of the sphere
    std::uint32_t element = 0;   ///< triangle of the draw; kSphereElement for spheres
    std::uint32_t material = 0;  ///< Scene::materials
    bool mirrored = false;       ///< world_from_object has a negative determinant: the winding is turned (SH-1)

    static constexpr std::uint32_t kSphereElement = 0xffffffffu;
    bool is_sphere() const { return element == kSphereElement; }
};

/// Where a ray meets a shape.
struct Hit {
    double t = 0;
    double b1 = 0, b2 = 0;    ///< triangles: p = p0 + b1 (p1 - p0) + b2 (p2 - p0)
    std::uint32_t shape = 0;  ///< index into SceneIndex::shapes()
};

/// (SH-1) The geometric normal at `p`, unit, towards the glTF front; 0 for a triangle without area.
dvec3 geometric_normal(const Shape& shape, const dvec3& p);

/// The shapes of a scene and a tree of boxes over them, all in double. Answers are those of trying every shape, bit for
/// bit: `closest_of_all` does just that.
class SceneIndex {
 public:
    explicit SceneIndex(const PosedScene& posed);

    const std::vector<Shape>& shapes() const { return shapes_; }

    /// The hit of smallest t that `accept(hit)` does not let pass; of equal ones that of the lowest (object, element).
    template <class Accept>
    std::optional<Hit> closest(const Ray& ray, Accept&& accept) const;

    /// As `closest`, by trying every shape.
    template <class Accept>
    std::optional<Hit> closest_of_all(const Ray& ray, Accept&& accept) const;

    /// Product of `transmit(hit)` over everything that the ray meets; 0 ends it.
    template <class Transmit>
    double transmittance(const Ray& ray, Transmit&& transmit) const;

 private:
    struct Box {
        dvec3 low{std::numeric_limits<double>::infinity()};
        dvec3 high{-std::numeric_limits<double>::infinity()};
        void add(const dvec3& p) { low = glm::min(low, p), high = glm::max(high, p); }
        void add(const Box& b) { low = glm::min(low, b.low), high = glm::max(high, b.high); }
        double half_area() const
        {
            const dvec3 d = high - low;
            return d.x < 0 ? 0 : d.x * d.y + d.y * d.z + d.z * d.x;
        }
    };
    /// 64 bytes, one cache line. Inner: the first child follows, the second is at `index`. Leaf: shapes index … +
    /// count.
    struct Node {
        Box box;
        std::uint32_t index = 0;
        std::uint32_t count = 0;  ///< 0: inner
        std::uint32_t axis = 0;
    };
    struct RayBox {
        dvec3 origin, inverse;
    };
    struct Piece;

    static Box bounds(const Shape& shape);
    void build(std::vector<Piece>& pieces, std::size_t begin, std::size_t end, int depth);
    static bool enters(const Box& box, const RayBox& ray, double t_max);
    template <class Visit>
    void walk(const Ray& ray, const double& t_max, Visit&& visit) const;
    template <class Visit>
    void meet(std::uint32_t shape, const Ray& ray, const ShearedRay& sheared, Visit&& visit) const;
    bool before(const Hit& a, const Hit& b) const;

    static constexpr int kMaxDepth = 96;  ///< of the tree: build() halves where the heuristic would go deeper
    std::vector<Shape> shapes_;
    std::vector<Node> nodes_;
};

// Slab test (RT-3). Planes are chosen by the ray's sign and compared so that 0 · Inf = NaN leaves the interval as it is
// (promise G19).
inline bool SceneIndex::enters(const Box& box, const RayBox& ray, double t_max)
{
    // Far above 1 + 2 γ₃ (promise G20) and the rounding of a hit's own t: no hit that trying every shape finds is lost.
    constexpr double kWiden = 1 + 2e-10;
    double t0 = 0, t1 = t_max;
    const auto slab = [&](double low, double high, double origin, double inverse) {
        const bool down = std::signbit(inverse);
        const double near = ((down ? high : low) - origin) * inverse;
        const double far = ((down ? low : high) - origin) * inverse;
        t0 = near > t0 ? near : t0;
        t1 = far < t1 ? far : t1;
    };
    slab(box.low.x, box.high.x, ray.origin.x, ray.inverse.x);
    slab(box.low.y, box.high.y, ray.origin.y, ray.inverse.y);
    slab(box.low.z, box.high.z, ray.origin.z, ray.inverse.z);
    return t0 <= t1 * kWiden;
}

inline bool SceneIndex::before(const Hit& a, const Hit& b) const
{
    if (a.t != b.t) return a.t < b.t;
    const Shape& sa = shapes_[a.shape];
    const Shape& sb = shapes_[b.shape];
    return sa.object != sb.object ? sa.object < sb.object : sa.element < sb.element;
}

template <class Visit>
void SceneIndex::meet(std::uint32_t shape, const Ray& ray, const ShearedRay& sheared, Visit&& visit) const
{
    const Shape& s = shapes_[shape];
    if (s.is_sphere()) {
        const SphereHits hits = intersect_sphere(ray, s.p0, s.p1.x);
        for (int i = 0; i < hits.count; ++i)
            visit(Hit{.t = hits.t[static_cast<std::size_t>(i)], .b1 = 0, .b2 = 0, .shape = shape});
    } else if (const auto hit = intersect_triangle(sheared, s.p0, s.p1, s.p2)) {
        visit(Hit{.t = hit->t, .b1 = hit->b1, .b2 = hit->b2, .shape = shape});
    }
}

// Visits every shape in boxes that the ray enters before t_max, which `visit` may lower.
template <class Visit>
void SceneIndex::walk(const Ray& ray, const double& t_max, Visit&& visit) const
{
    if (nodes_.empty()) return;
    const ShearedRay sheared(ray);
    const RayBox slab{ray.origin, 1.0 / ray.direction};
    std::array<std::uint32_t, kMaxDepth + 1> stack;
    std::size_t depth = 0;
    std::uint32_t at = 0;
    for (;;) {
        const Node& node = nodes_[at];
        if (enters(node.box, slab, t_max)) {
            if (node.count == 0) {
                const bool first_is_near = !(ray.direction[static_cast<int>(node.axis)] < 0);
                stack[depth++] = first_is_near ? node.index : at + 1;
                at = first_is_near ? at + 1 : node.index;
                continue;
            }
            for (std::uint32_t i = 0; i < node.count; ++i) meet(node.index + i, ray, sheared, visit);
        }
        if (depth == 0) return;
        at = stack[--depth];
    }
}

template <class Accept>
std::optional<Hit> SceneIndex::closest(const Ray& ray, Accept&& accept) const
{
    std::optional<Hit> best;
    double t_max = ray.t_max;
    walk(ray, t_max, [&](const Hit& hit) {
        if (!(hit.t < ray.t_max) || (best && !before(hit, *best)) || !accept(hit)) return;
        best = hit;
        t_max = hit.t;
    });
    return best;
}

template <class Accept>
std::optional<Hit> SceneIndex::closest_of_all(const Ray& ray, Accept&& accept) const
{
    std::optional<Hit> best;
    const ShearedRay sheared(ray);
    for (std::uint32_t i = 0; i < shapes_.size(); ++i)
        meet(i, ray, sheared, [&](const Hit& hit) {
            if (!(hit.t < ray.t_max) || (best && !before(hit, *best)) || !accept(hit)) return;
            best = hit;
        });
    return best;
}

template <class Transmit>
double SceneIndex::transmittance(const Ray& ray, Transmit&& transmit) const
{
    double through = 1;
    double t_max = ray.t_max;
    walk(ray, t_max, [&](const Hit& hit) {
        if (through == 0 || !(hit.t < ray.t_max)) return;
        through *= transmit(hit);
        if (through == 0) t_max = -1;  // enter no further box
    });
    return through;
}

}  // namespace etalon::reference
