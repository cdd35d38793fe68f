#include "engine/scene/topology.h"

#include <algorithm>
#include <tuple>

#include "engine/base/error.h"
#include "engine/geometry/tangents.h"

namespace etalon {

namespace {

// Every attribute becomes that of the vertices in `order`.
void take_vertices(Primitive& primitive, const std::vector<std::uint32_t>& order)
{
    const auto take = [&](auto& attribute) {
        if (attribute.empty()) return;
        std::remove_reference_t<decltype(attribute)> out;
        out.reserve(order.size());
        for (const std::uint32_t i : order) out.push_back(attribute[i]);
        attribute = std::move(out);
    };
    take(primitive.positions);
    take(primitive.normals);
    take(primitive.tangents);
    for (auto& set : primitive.uv) take(set);
    take(primitive.colors);
    for (MorphTarget& target : primitive.targets) {
        take(target.positions);
        take(target.normals);
        take(target.tangents);
    }
    if (primitive.influences.empty()) return;
    const std::size_t each = primitive.influences_per_vertex;
    std::vector<Influence> influences;
    influences.reserve(order.size() * each);
    for (const std::uint32_t i : order) {
        const auto from = primitive.influences.begin() + static_cast<std::ptrdiff_t>(i * each);
        influences.insert(influences.end(), from, from + static_cast<std::ptrdiff_t>(each));
    }
    primitive.influences = std::move(influences);
}

// Twice the area times the normal, in double: exactly zero only for triangles that are segments or points, or too small
// to tell.
dvec3 area_vector(const Primitive& primitive, std::size_t triangle)
{
    const auto corner = [&](std::size_t i) { return dvec3(primitive.positions[primitive.indices[3 * triangle + i]]); };
    return cross(corner(1) - corner(0), corner(2) - corner(0));
}

// Of a triangle without area, which only what moves keeps, some direction.
vec3 face_normal(const Primitive& primitive, std::size_t triangle)
{
    const dvec3 n = normalize(area_vector(primitive, triangle));
    return is_finite(n) ? vec3(n) : vec3(0, 0, 1);
}

// Each triangle its own three vertices, with the normal of its plane.
void make_flat(Primitive& primitive)
{
    std::vector<vec3> normals;
    normals.reserve(primitive.indices.size());
    for (std::size_t t = 0; t < primitive.indices.size() / 3; ++t)
        normals.insert(normals.end(), 3, face_normal(primitive, t));
    primitive.normals.clear();
    take_vertices(primitive, primitive.indices);
    primitive.normals = std::move(normals);
    for (std::uint32_t i = 0; i < primitive.indices.size(); ++i) primitive.indices[i] = i;
}

}  // namespace

Topology topology_of(DrawMode mode)
{
    if (mode == DrawMode::points) return Topology::points;
    return mode <= DrawMode::line_strip ? Topology::lines : Topology::triangles;
}

std::vector<std::uint32_t> unrolled(DrawMode mode, std::vector<std::uint32_t> in)
{
    std::vector<std::uint32_t> out;
    switch (mode) {
        case DrawMode::points:
            return in;
        case DrawMode::lines:
            in.resize(in.size() / 2 * 2);
            return in;
        case DrawMode::triangles:
            in.resize(in.size() / 3 * 3);
            return in;
        case DrawMode::line_loop:
        case DrawMode::line_strip:
            for (std::size_t i = 0; i + 1 < in.size(); ++i) out.insert(out.end(), {in[i], in[i + 1]});
            if (mode == DrawMode::line_loop && in.size() > 2) out.insert(out.end(), {in.back(), in.front()});
            return out;
        case DrawMode::triangle_strip:
            for (std::size_t i = 0; i + 2 < in.size(); ++i)
                out.insert(out.end(), {in[i], in[i + 1 + i % 2], in[i + 2 - i % 2]});
            return out;
        case DrawMode::triangle_fan:
            for (std::size_t i = 1; i + 1 < in.size(); ++i) out.insert(out.end(), {in[i], in[i + 1], in[0]});
            return out;
    }
    assume(false);
    return out;
}

void drop_triangles_without_area(Primitive& primitive)
{
    std::size_t kept = 0;
    for (std::size_t t = 0; t < primitive.indices.size() / 3; ++t) {
        const dvec3 area = area_vector(primitive, t);
        if (!is_finite(normalize(area))) continue;
        std::copy_n(primitive.indices.begin() + static_cast<std::ptrdiff_t>(3 * t), 3,
                    primitive.indices.begin() + static_cast<std::ptrdiff_t>(3 * kept));
        ++kept;
    }
    primitive.indices.resize(3 * kept);
}

void finish_normals(Primitive& primitive)
{
    if (!primitive.has_normals) {
        if (primitive.topology == Topology::triangles) make_flat(primitive);
        return;
    }
    bool some_zero = false;
    for (vec3& n : primitive.normals) {
        const double l = length(dvec3(n));
        if (l > 0)
            n = vec3(dvec3(n) / l);
        else
            some_zero = true;
    }
    if (!some_zero || primitive.topology != Topology::triangles) return;
    for (std::size_t t = 0; t < primitive.indices.size() / 3; ++t)
        for (std::size_t i = 0; i < 3; ++i)
            if (vec3& n = primitive.normals[primitive.indices[3 * t + i]]; n == vec3(0)) n = face_normal(primitive, t);
}

void add_tangents(Primitive& primitive, int uv_set)
{
    const std::vector<vec4> tangents = compute_tangents(
        primitive.positions, primitive.normals, primitive.uv[static_cast<std::size_t>(uv_set)], primitive.indices);
    // Corners of one vertex with one tangent become one vertex. By sorting: no fan, however torn, makes it slow.
    const auto key = [&](std::uint32_t corner) {
        const vec4& t = tangents[corner];
        return std::tuple(primitive.indices[corner], t.x, t.y, t.z, t.w);
    };
    std::vector<std::uint32_t> corners(tangents.size());
    for (std::uint32_t i = 0; i < corners.size(); ++i) corners[i] = i;
    std::sort(corners.begin(), corners.end(), [&](std::uint32_t a, std::uint32_t b) { return key(a) < key(b); });
    std::vector<std::uint32_t> order;
    std::vector<vec4> kept;
    std::vector<std::uint32_t> indices(tangents.size());
    for (std::size_t i = 0; i < corners.size(); ++i) {
        if (i == 0 || key(corners[i]) != key(corners[i - 1])) {
            order.push_back(primitive.indices[corners[i]]);
            kept.push_back(tangents[corners[i]]);
        }
        indices[corners[i]] = static_cast<std::uint32_t>(order.size() - 1);
    }
    take_vertices(primitive, order);
    primitive.tangents = std::move(kept);
    primitive.tangents_from_uv = uv_set;
    primitive.indices = std::move(indices);
}

}  // namespace etalon
