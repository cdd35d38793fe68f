#include "engine/geometry/bvh_binary.h"

#include <algorithm>
#include <array>

#include "engine/base/error.h"
#include "engine/base/parallel.h"

namespace etalon {
namespace {

constexpr int kBins = 16;
/// From here on ranges are halved, so that no input makes a tree deeper than this and log2 of its size.
constexpr int kMaxSahDepth = 48;
/// Ranges below this are one task; above it, their boxes are binned in chunks of this size in parallel.
constexpr std::size_t kTaskSize = 1u << 15;

struct Item {
    Box box;
    vec3 center;
    std::uint32_t index;
};

struct Bin {
    Box box;
    std::size_t count = 0;
    void add(const Bin& other)
    {
        box.add(other.box);
        count += other.count;
    }
};

/// Which bin a centre falls into: the same answer when items are binned and when they are partitioned.
struct Binning {
    vec3 low{0};
    vec3 scale{0};

    explicit Binning(const Box& centers) : low(centers.min)
    {
        const dvec3 extent = dvec3(centers.max) - dvec3(centers.min);
        for (int axis = 0; axis < 3; ++axis)
            if (extent[axis] > 0) scale[axis] = static_cast<float>(std::min(kBins / extent[axis], 1e38));
    }
    bool splits(int axis) const { return scale[axis] > 0; }
    int bin(const vec3& center, int axis) const
    {
        return std::clamp(static_cast<int>((center[axis] - low[axis]) * scale[axis]), 0, kBins - 1);
    }
};

struct Range {
    std::size_t begin = 0;
    std::size_t end = 0;
    std::size_t size() const { return end - begin; }
};

struct Bounds {
    Box box;
    Box centers;
};

using Bins = std::array<std::array<Bin, kBins>, 3>;

struct Split {
    int axis = -1;
    int last_left_bin = 0;
    double cost = 0;  ///< Σ half area × count of both sides
};

/// Sums `part(range)` over chunks: in parallel for long ranges. Boxes and counts merge alike in any order.
template <typename Sum, typename Part, typename Merge>
Sum sum_chunks(Range range, unsigned threads, const Part& part, const Merge& merge)
{
    const std::size_t chunks = (range.size() + kTaskSize - 1) / kTaskSize;
    if (chunks <= 1 || threads == 1) return part(range);
    std::vector<Sum> sums(chunks);
    parallel_for(
        chunks,
        [&](std::size_t i) {
            const std::size_t begin = range.begin + i * kTaskSize;
            sums[i] = part(Range{begin, std::min(begin + kTaskSize, range.end)});
        },
        threads);
    for (std::size_t i = 1; i < chunks; ++i) merge(sums[0], sums[i]);
    return sums[0];
}

Bounds bounds_of(std::span<const Item> items, Range range, unsigned threads)
{
    return sum_chunks<Bounds>(
        range, threads,
        [&](Range part) {
            Bounds bounds;
            for (const Item& item : items.subspan(part.begin, part.size())) {
                bounds.box.add(item.box);
                bounds.centers.add(item.center);
            }
            return bounds;
        },
        [](Bounds& sum, const Bounds& part) {
            sum.box.add(part.box);
            sum.centers.add(part.centers);
        });
}

Bins bin_items(std::span<const Item> items, Range range, const Binning& binning, unsigned threads)
{
    return sum_chunks<Bins>(
        range, threads,
        [&](Range part) {
            Bins bins;
            for (const Item& item : items.subspan(part.begin, part.size()))
                for (int axis = 0; axis < 3; ++axis)
                    bins[std::size_t(axis)][std::size_t(binning.bin(item.center, axis))].add({item.box, 1});
            return bins;
        },
        [](Bins& sum, const Bins& part) {
            for (std::size_t axis = 0; axis < 3; ++axis)
                for (std::size_t i = 0; i < kBins; ++i) sum[axis][i].add(part[axis][i]);
        });
}

/// The cheapest plane between bins, (RT-5); axis -1 where every centre is the same.
Split best_split(const Bins& bins, const Binning& binning)
{
    Split best;
    for (int axis = 0; axis < 3; ++axis) {
        if (!binning.splits(axis)) continue;
        const auto& row = bins[std::size_t(axis)];
        std::array<double, kBins> right_cost{};
        Bin right;
        for (std::size_t i = kBins - 1; i > 0; --i) {
            right.add(row[i]);
            right_cost[i] = right.count == 0 ? -1 : half_area(right.box) * double(right.count);
        }
        Bin left;
        for (std::size_t i = 0; i + 1 < kBins; ++i) {
            left.add(row[i]);
            if (left.count == 0 || right_cost[i + 1] < 0) continue;
            const double cost = half_area(left.box) * double(left.count) + right_cost[i + 1];
            if (best.axis < 0 || cost < best.cost) best = {axis, static_cast<int>(i), cost};
        }
    }
    return best;
}

/// One level of the recursion: where `range` is cut (items are reordered), or range.end where it is a leaf.
std::size_t cut(std::span<Item> items, Range range, const Bounds& bounds, int depth, std::uint32_t max_leaf,
                unsigned threads)
{
    if (range.size() == 1) return range.end;
    const std::size_t middle = range.begin + range.size() / 2;
    const bool small = range.size() <= max_leaf;
    const Binning binning(bounds.centers);
    const Split split = best_split(bin_items(items, range, binning, threads), binning);
    if (split.axis < 0) return small ? range.end : middle;
    // Traversal and intersection cost alike: a split pays one visit of the node.
    if (small && (double(range.size()) - 1) * half_area(bounds.box) <= split.cost) return range.end;
    if (depth >= kMaxSahDepth) return middle;
    const auto begin = items.begin() + std::ptrdiff_t(range.begin);
    const auto end = items.begin() + std::ptrdiff_t(range.end);
    const auto found = std::partition(
        begin, end, [&](const Item& item) { return binning.bin(item.center, split.axis) <= split.last_left_bin; });
    return static_cast<std::size_t>(found - items.begin());
}

struct Task {
    std::uint32_t node;
    Range range;
    int depth;
};

/// Builds below `root` into `nodes`; ranges of at most `stop_at` items are left to `later` instead.
void build_below(std::vector<BinaryNode>& nodes, std::span<Item> items, Task root, std::size_t stop_at,
                 std::uint32_t max_leaf, unsigned threads, std::vector<Task>& later)
{
    std::vector<Task> stack{root};
    while (!stack.empty()) {
        const Task task = stack.back();
        stack.pop_back();
        if (task.range.size() <= stop_at) {
            later.push_back(task);
            continue;
        }
        const Bounds bounds = bounds_of(items, task.range, threads);
        const std::size_t middle = cut(items, task.range, bounds, task.depth, max_leaf, threads);
        BinaryNode& node = nodes[task.node];
        node.box = bounds.box;
        if (middle == task.range.end) {
            node.first = static_cast<std::uint32_t>(task.range.begin);
            node.count = static_cast<std::uint32_t>(task.range.size());
            continue;
        }
        const auto left = static_cast<std::uint32_t>(nodes.size());
        node.left = left;
        nodes.resize(nodes.size() + 2);
        stack.push_back({left + 1, {middle, task.range.end}, task.depth + 1});
        stack.push_back({left, {task.range.begin, middle}, task.depth + 1});
    }
}

/// Puts a subtree whose node 0 is `task.node` of `nodes` behind them.
void append(std::vector<BinaryNode>& nodes, const Task& task, const std::vector<BinaryNode>& subtree)
{
    const auto offset = static_cast<std::uint32_t>(nodes.size()) - 1;
    const auto moved = [offset](BinaryNode node) {
        if (!node.is_leaf()) node.left += offset;
        return node;
    };
    nodes[task.node] = moved(subtree[0]);
    std::transform(subtree.begin() + 1, subtree.end(), std::back_inserter(nodes), moved);
}

}  // namespace

BinaryBvh build_binary_bvh(std::span<const Box> boxes, const BvhOptions& options)
{
    assume(options.max_leaf >= 1 && options.max_leaf <= 15 && boxes.size() <= (std::size_t{1} << 27));
    std::vector<Item> items;
    items.reserve(boxes.size());
    for (std::size_t i = 0; i < boxes.size(); ++i)
        if (!boxes[i].is_empty() && is_finite(boxes[i]))
            items.push_back({boxes[i], boxes[i].center(), static_cast<std::uint32_t>(i)});

    BinaryBvh bvh;
    bvh.dropped = boxes.size() - items.size();
    if (items.empty()) return bvh;

    bvh.nodes.resize(1);
    std::vector<Task> tasks;
    build_below(bvh.nodes, items, {0, {0, items.size()}, 0}, kTaskSize, options.max_leaf, options.threads, tasks);
    std::vector<std::vector<BinaryNode>> subtrees(tasks.size());
    parallel_for(
        tasks.size(),
        [&](std::size_t i) {
            subtrees[i].resize(1);
            std::vector<Task> none;
            build_below(subtrees[i], items, {0, tasks[i].range, tasks[i].depth}, 0, options.max_leaf, 1, none);
        },
        options.threads);
    for (std::size_t i = 0; i < tasks.size(); ++i) append(bvh.nodes, tasks[i], subtrees[i]);

    bvh.order.reserve(items.size());
    for (const Item& item : items) bvh.order.push_back(item.index);
    return bvh;
}

}  // namespace etalon
