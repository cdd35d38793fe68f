#include "engine/render/path_light_tree.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numeric>

#include "engine/base/error.h"

namespace etalon {
namespace {

/// Directions within `angle` of `axis`.
struct Cone {
    dvec3 axis{0, 0, 1};
    double angle = -1;  ///< radians; negative: none yet
};

/// The smallest cone that holds both (Conty & Kulla 2018, algorithm 1).
Cone join(const Cone& a, const Cone& b)
{
    if (a.angle < 0) return b;
    if (b.angle < 0) return a;
    const Cone& wide = a.angle >= b.angle ? a : b;
    const Cone& narrow = a.angle >= b.angle ? b : a;
    const dvec3 normal = cross(wide.axis, narrow.axis);
    const double between = std::atan2(length(normal), dot(wide.axis, narrow.axis));
    if (std::min(between + narrow.angle, kPi) <= wide.angle) return wide;
    const double angle = (wide.angle + between + narrow.angle) / 2;
    // Opposite axes: any plane would do, and the joined cone is the whole sphere or nearly so.
    if (angle >= kPi || !(length(normal) > 0)) return {wide.axis, kPi};
    const double turn = angle - wide.angle;
    const dvec3 across = cross(normalize(normal), wide.axis);
    return {normalize(std::cos(turn) * wide.axis + std::sin(turn) * across), angle};
}

struct Bounds {
    Box box;
    Cone normals;
    double power = 0;

    void add(const Bounds& other)
    {
        box.add(other.box);
        normals = join(normals, other.normals);
        power += other.power;
    }
};

Bounds bounds_of(const TreeLight& light)
{
    return {light.box, {light.axis, light.everywhere ? kPi : 0.0}, light.power};
}

/// The paper's M_Ω for emission over the hemisphere of every normal (its equation 5 with θ_e = π/2).
double solid_measure(const Cone& normals)
{
    const double o = normals.angle;
    const double w = std::min(o + kPi / 2, kPi);
    return 2 * kPi * (1 - std::cos(o)) +
           kPi / 2 * (2 * w * std::sin(o) - std::cos(o - 2 * w) - 2 * o * std::sin(o) + std::cos(o));
}

double cost(const Bounds& bounds)
{
    if (bounds.power == 0) return 0;
    // A light may be a line or a point to the box; its extent still counts.
    const dvec3 d = dvec3(bounds.box.max) - dvec3(bounds.box.min);
    return bounds.power * solid_measure(bounds.normals) * (half_area(bounds.box) + 1e-6 * dot(d, d));
}

class Builder {
 public:
    explicit Builder(std::span<const TreeLight> lights) : lights_(lights), order_(lights.size())
    {
        std::iota(order_.begin(), order_.end(), 0u);
    }

    LightTree run() &&
    {
        out_.nodes.reserve(2 * order_.size());
        for (const TreeLight& light : lights_) total_ += light.power;
        struct Range {
            std::size_t first, end;
            int depth;
        };
        // The left half last, so that all of it is written before the right one.
        std::vector<Range> pending{{0, order_.size(), 0}};
        while (!pending.empty()) {
            const auto [first, end, depth] = pending.back();
            pending.pop_back();
            write(first, end);
            if (end - first == 1) {
                out_.leaves.push_back(order_[first]);
                continue;
            }
            const std::size_t middle = depth < kMostUneven ? split(first, end) : first + (end - first) / 2;
            out_.nodes.back().left_leaves = static_cast<std::uint32_t>(middle - first);
            pending.push_back({middle, end, depth + 1});
            pending.push_back({first, middle, depth + 1});
        }
        return std::move(out_);
    }

 private:
    static constexpr std::size_t kBins = 12;
    /// Levels after which halves are equal, so that no input makes the tree a list.
    static constexpr int kMostUneven = 40;

    Bounds bounds(std::size_t first, std::size_t end) const
    {
        Bounds all;
        for (std::size_t i = first; i < end; ++i) all.add(bounds_of(lights_[order_[i]]));
        return all;
    }

    void write(std::size_t first, std::size_t end)
    {
        const Bounds all = bounds(first, end);
        LightTreeNode node;
        node.low = all.box.min;
        node.high = all.box.max;
        node.power = static_cast<float>(all.power / total_);
        node.axis = vec3(all.normals.axis);
        // A little wider than it is, for what float directions are off.
        node.cos_normals = static_cast<float>(std::cos(std::min(all.normals.angle + 1e-5, kPi)));
        out_.nodes.push_back(node);
    }

    struct Plane {
        double cost = std::numeric_limits<double>::infinity();
        int axis = -1;
        double at = 0;  ///< lights with a lower centre go left
    };

    Plane best_plane(std::size_t first, std::size_t end, int axis, const dvec3& low, const dvec3& extent) const
    {
        std::array<Bounds, kBins> bins;
        for (std::size_t i = first; i < end; ++i) {
            const TreeLight& light = lights_[order_[i]];
            const double share = (double(light.box.center()[axis]) - low[axis]) / extent[axis];
            bins[std::min(static_cast<std::size_t>(share * kBins), kBins - 1)].add(bounds_of(light));
        }
        std::array<double, kBins> right{};
        Bounds sum;
        for (std::size_t b = kBins; b-- > 1;) {
            sum.add(bins[b]);
            right[b] = cost(sum);
        }
        // Thin boxes are worse than their area says: the paper's regularisation.
        const double thin = std::max({extent.x, extent.y, extent.z}) / extent[axis];
        Plane best;
        Bounds left;
        for (std::size_t b = 1; b < kBins; ++b) {
            left.add(bins[b - 1]);
            const double here = thin * (cost(left) + right[b]);
            if (left.power > 0 && right[b] > 0 && here < best.cost)
                best = {here, axis, low[axis] + extent[axis] * double(b) / double(kBins)};
        }
        return best;
    }

    std::size_t split(std::size_t first, std::size_t end)
    {
        Box centers;
        for (std::size_t i = first; i < end; ++i) centers.add(lights_[order_[i]].box.center());
        const dvec3 low(centers.min);
        const dvec3 extent = dvec3(centers.max) - low;
        Plane best;
        for (int axis = 0; axis < 3; ++axis) {
            if (!(extent[axis] > 0)) continue;
            const Plane plane = best_plane(first, end, axis, low, extent);
            if (plane.cost < best.cost) best = plane;
        }
        const auto begin = order_.begin() + std::ptrdiff_t(first);
        const auto stop = order_.begin() + std::ptrdiff_t(end);
        if (best.axis >= 0) {
            const auto middle = std::stable_partition(begin, stop, [&](std::uint32_t light) {
                return double(lights_[light].box.center()[best.axis]) < best.at;
            });
            if (middle != begin && middle != stop) return static_cast<std::size_t>(middle - order_.begin());
        }
        return first + (end - first) / 2;
    }

    std::span<const TreeLight> lights_;
    std::vector<std::uint32_t> order_;
    double total_ = 0;
    LightTree out_;
};

}  // namespace

LightTree make_light_tree(std::span<const TreeLight> lights)
{
    if (lights.empty()) return {};
    for (const TreeLight& light : lights) assume(light.power > 0 && std::isfinite(light.power));
    return Builder(lights).run();
}

}  // namespace etalon
