#include <algorithm>
#include <array>

#include "engine/base/error.h"
#include "engine/scene/animation.h"

namespace etalon {

namespace {

Trs& trs_of(const Scene& scene, Index node, Motion& motion)
{
    return motion.nodes.try_emplace(node, scene.nodes.at(node).trs.value_or(Trs{})).first->second;
}

dvec3 triple(std::span<const double> v)
{
    return dvec3(v[0], v[1], v[2]);
}

using Values = std::span<const double>;

constexpr std::array kProperties = {
    AnimatedProperty{"/nodes/{}/translation", 3, false,
                     [](const Scene& s, Index i, Values v, Motion& m) { trs_of(s, i, m).translation = triple(v); }},
    AnimatedProperty{
        "/nodes/{}/rotation", 4, true,
        [](const Scene& s, Index i, Values v, Motion& m) { trs_of(s, i, m).rotation = dquat(v[3], v[0], v[1], v[2]); }},
    AnimatedProperty{"/nodes/{}/scale", 3, false,
                     [](const Scene& s, Index i, Values v, Motion& m) { trs_of(s, i, m).scale = triple(v); }},
    AnimatedProperty{"/nodes/{}/weights", 0, false,
                     [](const Scene&, Index i, Values v, Motion& m) { m.weights[i].assign(v.begin(), v.end()); }},
};

}  // namespace

std::span<const AnimatedProperty> animated_properties()
{
    return kProperties;
}

Index animated_property(std::string_view pointer)
{
    const auto row = std::find_if(kProperties.begin(), kProperties.end(),
                                  [&](const AnimatedProperty& p) { return p.pointer == pointer; });
    assume(row != kProperties.end());
    return static_cast<Index>(row - kProperties.begin());
}

}  // namespace etalon
