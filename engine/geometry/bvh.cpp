#include "engine/geometry/bvh.h"

#include <algorithm>
#include <cmath>

#include "engine/base/error.h"
#include "engine/geometry/bvh_binary.h"

namespace etalon {
namespace {

constexpr double kGridMax = 65535;

/// A grid a little larger than the bounds on every axis; a flat axis gets a thousandth of the longest.
BvhGrid grid_over(const Box& bounds)
{
    BvhGrid grid;
    const dvec3 extent = dvec3(bounds.max) - dvec3(bounds.min);
    const dvec3 magnitude = glm::max(glm::abs(dvec3(bounds.max)), glm::abs(dvec3(bounds.min)));
    const double longest = std::max({extent.x, extent.y, extent.z});
    for (int axis = 0; axis < 3; ++axis) {
        // Not below what a float coordinate can tell apart, or the base would round past the bounds.
        const double least = std::max({longest * 1e-3, magnitude[axis] * 1e-4, 1e-30});
        const double wide = std::max(extent[axis], least);
        grid.base[axis] = static_cast<float>(double(bounds.min[axis]) - 0.001 * wide - (wide - extent[axis]) / 2);
        grid.scale[axis] = static_cast<float>(kGridMax / (1.003 * wide));
    }
    return grid;
}

std::uint32_t cell(double q)
{
    return static_cast<std::uint32_t>(std::clamp(q, 0.0, kGridMax));
}

BvhChild quantise(const Box& box, const BvhGrid& grid, std::int32_t ref)
{
    const dvec3 low = (dvec3(box.min) - dvec3(grid.base)) * dvec3(grid.scale) - kBvhPad;
    const dvec3 high = (dvec3(box.max) - dvec3(grid.base)) * dvec3(grid.scale) + kBvhPad;
    const uvec3 lo(cell(std::floor(low.x)), cell(std::floor(low.y)), cell(std::floor(low.z)));
    const uvec3 hi(cell(std::ceil(high.x)), cell(std::ceil(high.y)), cell(std::ceil(high.z)));
    return {lo.x | lo.y << 16, lo.z | hi.x << 16, hi.y | hi.z << 16, ref};
}

/// The binary nodes that become the children of a wide one: the largest inner one is opened while there is room.
std::vector<std::uint32_t> children_of(const BinaryBvh& binary, std::uint32_t node)
{
    if (binary.nodes[node].is_leaf()) return {node};
    std::vector<std::uint32_t> children{binary.nodes[node].left, binary.nodes[node].left + 1};
    while (children.size() < 4) {
        const auto area = [&](std::uint32_t child) {
            return binary.nodes[child].is_leaf() ? -1.0 : half_area(binary.nodes[child].box);
        };
        const auto widest = std::max_element(children.begin(), children.end(),
                                             [&](std::uint32_t a, std::uint32_t b) { return area(a) < area(b); });
        if (area(*widest) < 0) break;
        const std::uint32_t left = binary.nodes[*widest].left;
        *widest = left;
        children.push_back(left + 1);
    }
    return children;
}

class Collapse {
 public:
    Collapse(const BinaryBvh& binary, Bvh& wide) : binary_(binary), wide_(wide) {}

    /// Appends the wide node made of binary node `node` and all below it, depth first.
    void run(std::uint32_t root)
    {
        struct Pending {
            std::uint32_t node;
            std::size_t parent;
            std::size_t slot;
            int waiting;  ///< entries that may wait on a traversal's stack when it comes here
        };
        std::vector<Pending> stack{{root, 0, 0, 0}};
        while (!stack.empty()) {
            const Pending at = stack.back();
            stack.pop_back();
            const std::size_t here = wide_.nodes.size();
            assume(here < (std::size_t{1} << 29));
            wide_.nodes.emplace_back();
            if (here != 0) wide_.nodes[at.parent][at.slot].ref = static_cast<std::int32_t>(here);

            std::vector<std::uint32_t> children = children_of(binary_, at.node);
            // Smallest inner child first onto the stack, so that the largest is laid out next.
            std::stable_sort(children.begin(), children.end(), [&](std::uint32_t a, std::uint32_t b) {
                return half_area(binary_.nodes[a].box) < half_area(binary_.nodes[b].box);
            });
            const int waiting = at.waiting + static_cast<int>(children.size()) - 1;
            wide_.stack_need = std::max(wide_.stack_need, waiting);
            for (std::size_t i = 0; i < children.size(); ++i) {
                const BinaryNode& child = binary_.nodes[children[i]];
                wide_.nodes[here][i] = quantise(child.box, wide_.grid, child.is_leaf() ? place(child) : 0);
                if (!child.is_leaf()) stack.push_back({children[i], here, i, waiting});
            }
        }
    }

 private:
    std::int32_t place(const BinaryNode& leaf)
    {
        const std::size_t first = wide_.order.size();
        for (std::uint32_t i = 0; i < leaf.count; ++i) wide_.order.push_back(binary_.order[leaf.first + i]);
        return ~static_cast<std::int32_t>(first << 4 | leaf.count);
    }

    const BinaryBvh& binary_;
    Bvh& wide_;
};

double sah_cost(const BinaryBvh& binary)
{
    const double root = half_area(binary.nodes[0].box);
    if (!(root > 0)) return 0;
    double cost = 0;
    for (const BinaryNode& node : binary.nodes) cost += half_area(node.box) * (node.is_leaf() ? node.count : 1);
    return cost / root;
}

}  // namespace

Bvh build_bvh(std::span<const Box> boxes, const BvhOptions& options)
{
    const BinaryBvh binary = build_binary_bvh(boxes, options);
    Bvh bvh;
    bvh.dropped = binary.dropped;
    if (binary.nodes.empty()) {
        bvh.nodes.emplace_back();
        return bvh;
    }
    bvh.bounds = binary.nodes[0].box;
    bvh.grid = grid_over(bvh.bounds);
    bvh.sah_cost = sah_cost(binary);
    bvh.nodes.reserve(binary.nodes.size() / 2 + 1);
    bvh.order.reserve(binary.order.size());
    Collapse(binary, bvh).run(0);
    return bvh;
}

}  // namespace etalon
