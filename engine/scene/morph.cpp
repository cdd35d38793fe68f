#include "engine/scene/morph.h"

#include <algorithm>
#include <cmath>

#include "engine/base/error.h"
#include "engine/scene/topology.h"

namespace etalon {

namespace {

using Offsets = std::vector<vec3> MorphTarget::*;

// What the targets add to vertex `i`.
dvec3 sum_at(const Primitive& base, std::span<const double> weights, Offsets offsets, std::size_t i)
{
    dvec3 sum(0);
    for (std::size_t t = 0; t < std::min(base.targets.size(), weights.size()); ++t)
        if (const auto& list = base.targets[t].*offsets; weights[t] != 0 && !list.empty())
            sum += weights[t] * dvec3(list[i]);
    return sum;
}

bool moves(const Primitive& base, std::span<const double> weights, Offsets offsets)
{
    for (std::size_t t = 0; t < std::min(base.targets.size(), weights.size()); ++t)
        if (weights[t] != 0 && !(base.targets[t].*offsets).empty()) return true;
    return false;
}

}  // namespace

Primitive morphed(const Primitive& base, std::span<const double> weights)
{
    Primitive out = base;
    const auto add = [&](auto& values, Offsets offsets) {
        if (!moves(base, weights, offsets)) return;
        for (std::size_t i = 0; i < values.size(); ++i) {
            const dvec3 moved = dvec3(values[i]) + sum_at(base, weights, offsets, i);
            values[i].x = static_cast<float>(moved.x);
            values[i].y = static_cast<float>(moved.y);
            values[i].z = static_cast<float>(moved.z);
            if (!is_finite(dvec3(values[i])))
                throw Error(Blame::input, "a morphed vertex is beyond every number",
                            "repair the weights and the targets");
        }
    };
    add(out.positions, &MorphTarget::positions);
    add(out.normals, &MorphTarget::normals);
    add(out.tangents, &MorphTarget::tangents);
    return out;
}

void finish_deformed(Primitive& primitive, bool reshaped)
{
    primitive.targets.clear();
    primitive.influences.clear();
    primitive.influences_per_vertex = 0;
    finish_normals(primitive);
    const std::optional<int> uv_set = primitive.tangents_from_uv;
    if (uv_set && (reshaped || !primitive.has_normals)) {
        primitive.tangents.clear();
        add_tangents(primitive, *uv_set);
        return;
    }
    for (vec4& t : primitive.tangents) {
        const dvec3 direction = normalize(dvec3(t));
        if (is_finite(direction)) t = vec4(vec3(direction), t.w);
    }
}

}  // namespace etalon
