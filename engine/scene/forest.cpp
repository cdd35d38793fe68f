#include "engine/scene/forest.h"

#include <fmt/format.h>

#include <algorithm>

#include "engine/base/error.h"

namespace etalon {

namespace {

Error fault(std::string where, std::string what)
{
    Error error(Blame::input, std::move(what), "export again, or repair the file by hand");
    error.at(std::move(where));
    return error;
}

}  // namespace

void check_forest(const std::vector<std::vector<std::size_t>>& children,
                  const std::vector<std::vector<std::size_t>>& scenes, std::uint64_t max_depth)
{
    const std::size_t none = children.size();
    std::vector<std::size_t> parent(children.size(), none);
    for (std::size_t i = 0; i < children.size(); ++i)
        for (std::size_t k = 0; k < children[i].size(); ++k) {
            const std::size_t child = children[i][k];
            if (parent[child] == i)
                throw fault(fmt::format("/nodes/{}/children/{}", i, k),
                            fmt::format("node {} is listed twice [DUPLICATE_ELEMENTS]", child));
            if (parent[child] != none)
                throw fault(
                    fmt::format("/nodes/{}/children/{}", i, k),
                    fmt::format("node {} already is a child of node {} [NODE_PARENT_OVERRIDE]", child, parent[child]));
            parent[child] = i;
        }

    // With one parent each, what no root reaches is on or below a cycle.
    std::vector<std::size_t> level;
    for (std::size_t i = 0; i < parent.size(); ++i)
        if (parent[i] == none) level.push_back(i);
    std::vector<bool> reached(children.size());
    for (std::uint64_t depth = 0; !level.empty(); ++depth) {
        if (depth == max_depth)
            throw fault(fmt::format("/nodes/{}", level.front()),
                        fmt::format("this node has {} ancestors: the limit of depth is reached", depth));
        std::vector<std::size_t> below;
        for (const std::size_t i : level) {
            reached[i] = true;
            below.insert(below.end(), children[i].begin(), children[i].end());
        }
        level = std::move(below);
    }
    if (const auto lost = std::find(reached.begin(), reached.end(), false); lost != reached.end())
        throw fault(fmt::format("/nodes/{}", lost - reached.begin()), "this node is its own ancestor [NODE_LOOP]");

    std::vector<std::size_t> listed_in(children.size(), scenes.size());
    for (std::size_t s = 0; s < scenes.size(); ++s) {
        for (std::size_t k = 0; k < scenes[s].size(); ++k) {
            const std::size_t node = scenes[s][k];
            if (parent[node] != none)
                throw fault(fmt::format("/scenes/{}/nodes/{}", s, k),
                            fmt::format("node {} is no root: it is a child of node {} [SCENE_NON_ROOT_NODE]", node,
                                        parent[node]));
            if (listed_in[node] == s)
                throw fault(fmt::format("/scenes/{}/nodes/{}", s, k),
                            fmt::format("node {} is listed twice [DUPLICATE_ELEMENTS]", node));
            listed_in[node] = s;
        }
    }
}

}  // namespace etalon
