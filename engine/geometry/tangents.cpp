#include "engine/geometry/tangents.h"

#include <algorithm>
#include <array>
#include <cfloat>
#include <tuple>

#include "engine/base/error.h"

namespace etalon {

namespace {

// All in float and in the published order of operations: bakers compute the same floats, and a normal map is only right
// with the tangents it was baked for.

constexpr std::uint32_t kNobody = 0xffffffffu;

bool not_zero(float x)
{
    return std::abs(x) > FLT_MIN;
}

vec3 normalized(const vec3& v)
{
    const float l = length(v);
    return not_zero(l) ? v * (1.0f / l) : v;
}

vec3 in_plane(const vec3& v, const vec3& normal)
{
    return normalized(v - dot(normal, v) * normal);
}

// One triangle with area.
struct Face {
    std::uint32_t source = 0;                                           // which triangle of the input
    std::array<std::uint32_t, 3> vertex{};                              // welded
    std::array<std::uint32_t, 3> neighbour{kNobody, kNobody, kNobody};  // across the edge from corner i to i + 1
    std::array<std::uint32_t, 3> group{kNobody, kNobody, kNobody};      // of each corner
    vec3 tangent{0};                                                    // direction in which u grows, unit
    bool preserves_orientation = false;                                 // of (u, v) against the front side
    bool joins_any = true;  // no uv area: takes the orientation of its first group
};

// Faces about one vertex that share a tangent.
struct Group {
    std::uint32_t vertex = 0;
    bool preserves_orientation = false;
    std::vector<std::uint32_t> faces;
};

class Tangents {
 public:
    Tangents(std::span<const vec3> positions, std::span<const vec3> normals, std::span<const vec2> uv,
             std::span<const std::uint32_t> indices)
        : positions_(positions), normals_(normals), uv_(uv), indices_(indices)
    {
        weld();
        make_faces();
        find_neighbours();
        make_groups();
    }

    std::vector<vec4> corners() const
    {
        std::vector<vec4> out;
        out.reserve(indices_.size());
        for (const std::uint32_t vertex : welded_) out.emplace_back(any_perpendicular(normals_[vertex]), 1.0f);
        std::vector<std::uint32_t> example(positions_.size(),
                                           kNobody);  // a corner of a face with area, per welded vertex
        std::vector<bool> has_area(indices_.size() / 3);
        for (const Group& group : groups_) {
            // v grows downwards in glTF's pictures: the sign is the opposite of that of the (u, v) orientation.
            const vec4 tangent(average(group), group.preserves_orientation ? -1.0f : 1.0f);
            for (const std::uint32_t f : group.faces)
                out[3 * faces_[f].source + corner_of(faces_[f], group.vertex)] = tangent;
        }
        for (const Face& face : faces_) {
            has_area[face.source] = true;
            for (std::uint32_t i = 0; i < 3; ++i)
                if (example[face.vertex[i]] == kNobody) example[face.vertex[i]] = 3 * face.source + i;
        }
        for (std::size_t corner = 0; corner < out.size(); ++corner)
            if (!has_area[corner / 3] && example[welded_[corner]] != kNobody)
                out[corner] = out[example[welded_[corner]]];
        return out;
    }

 private:
    // Equal vertices get one number. Sorting instead of hashing: no input makes it slow.
    void weld()
    {
        const auto key = [&](std::uint32_t i) {
            const vec3& p = positions_[i];
            const vec3& n = normals_[i];
            const vec2& t = uv_[i];
            return std::tuple(p.x, p.y, p.z, n.x, n.y, n.z, t.x, t.y);
        };
        std::vector<std::uint32_t> order(positions_.size());
        for (std::uint32_t i = 0; i < order.size(); ++i) order[i] = i;
        std::sort(order.begin(), order.end(), [&](std::uint32_t a, std::uint32_t b) {
            const auto ka = key(a);
            const auto kb = key(b);
            return ka < kb || (!(kb < ka) && a < b);
        });
        std::vector<std::uint32_t> first(positions_.size());
        for (std::size_t i = 0; i < order.size(); ++i)
            first[order[i]] = i > 0 && key(order[i]) == key(order[i - 1]) ? first[order[i - 1]] : order[i];
        welded_.reserve(indices_.size());
        for (const std::uint32_t index : indices_) welded_.push_back(first[index]);
    }

    void make_faces()
    {
        for (std::uint32_t t = 0; t < indices_.size() / 3; ++t) {
            Face face;
            face.source = t;
            for (std::uint32_t i = 0; i < 3; ++i) face.vertex[i] = welded_[3 * t + i];
            const auto& [a, b, c] = face.vertex;
            const vec3& p0 = positions_[a];
            if (p0 == positions_[b] || p0 == positions_[c] || positions_[b] == positions_[c]) continue;
            const vec2 t1 = uv_[b] - uv_[a];
            const vec2 t2 = uv_[c] - uv_[a];
            const vec3 d1 = positions_[b] - p0;
            const vec3 d2 = positions_[c] - p0;
            const float area = t1.x * t2.y - t1.y * t2.x;
            const vec3 along_u = t2.y * d1 - t1.y * d2;
            const vec3 along_v = t1.x * d2 - t2.x * d1;
            face.preserves_orientation = area > 0;
            if (not_zero(area)) {
                const float sign = face.preserves_orientation ? 1.0f : -1.0f;
                const float length_u = length(along_u);
                if (not_zero(length_u)) face.tangent = along_u * (sign / length_u);
                if (not_zero(length_u / std::abs(area)) && not_zero(length(along_v) / std::abs(area)))
                    face.joins_any = false;
            }
            faces_.push_back(face);
        }
    }

    // Two faces are neighbours when they share an edge with opposite senses; the first two in order where more do.
    void find_neighbours()
    {
        struct Edge {
            std::uint32_t low, high, face, corner;
        };
        std::vector<Edge> edges;
        edges.reserve(faces_.size() * 3);
        for (std::uint32_t f = 0; f < faces_.size(); ++f)
            for (std::uint32_t i = 0; i < 3; ++i) {
                const auto [low, high] = std::minmax(faces_[f].vertex[i], faces_[f].vertex[(i + 1) % 3]);
                edges.push_back({low, high, f, i});
            }
        std::sort(edges.begin(), edges.end(), [](const Edge& a, const Edge& b) {
            return std::tie(a.low, a.high, a.face, a.corner) < std::tie(b.low, b.high, b.face, b.corner);
        });
        std::vector<Edge> up;
        std::vector<Edge> down;
        for (std::size_t i = 0; i < edges.size();) {
            up.clear();
            down.clear();
            const std::size_t begin = i;
            for (; i < edges.size() && edges[i].low == edges[begin].low && edges[i].high == edges[begin].high; ++i)
                (faces_[edges[i].face].vertex[edges[i].corner] == edges[i].low ? up : down).push_back(edges[i]);
            // Each edge in order takes the first free one of the other sense: the k-th of each sense belong together.
            for (std::size_t k = 0; k < std::min(up.size(), down.size()); ++k) {
                faces_[up[k].face].neighbour[up[k].corner] = down[k].face;
                faces_[down[k].face].neighbour[down[k].corner] = up[k].face;
            }
        }
    }

    void make_groups()
    {
        for (std::uint32_t f = 0; f < faces_.size(); ++f)
            for (std::uint32_t i = 0; i < 3; ++i) {
                if (faces_[f].joins_any || faces_[f].group[i] != kNobody) continue;
                groups_.push_back({faces_[f].vertex[i], faces_[f].preserves_orientation, {}});
                gather(f);
            }
    }

    // Walks about the last group's vertex from face `start`, by its two edges there, as far as the orientation holds.
    void gather(std::uint32_t start)
    {
        const auto id = static_cast<std::uint32_t>(groups_.size() - 1);
        Group& group = groups_.back();
        std::vector<std::uint32_t> pending{start};
        while (!pending.empty()) {
            const std::uint32_t f = pending.back();
            pending.pop_back();
            Face& face = faces_[f];
            const std::uint32_t i = corner_of(face, group.vertex);
            if (face.group[i] != kNobody) continue;
            if (face.joins_any && face.group == std::array{kNobody, kNobody, kNobody})
                face.preserves_orientation = group.preserves_orientation;
            if (face.preserves_orientation != group.preserves_orientation) continue;
            face.group[i] = id;
            group.faces.push_back(f);
            const std::uint32_t before = face.neighbour[(i + 2) % 3];
            const std::uint32_t after = face.neighbour[i];
            if (before != kNobody) pending.push_back(before);
            if (after != kNobody) pending.push_back(after);
        }
        std::sort(group.faces.begin(), group.faces.end());
    }

    // The tangents of the group's faces in the plane of the vertex normal, weighted by their angles there.
    vec3 average(const Group& group) const
    {
        const vec3& n = normals_[group.vertex];
        vec3 sum(0);
        vec3 unweighted(0);  // for corners whose faces are seen edge-on from the normal: they have no angle
        for (const std::uint32_t f : group.faces) {
            const Face& face = faces_[f];
            if (face.joins_any) continue;
            const std::uint32_t i = corner_of(face, group.vertex);
            const vec3& here = positions_[face.vertex[i]];
            const vec3 a = in_plane(positions_[face.vertex[(i + 2) % 3]] - here, n);
            const vec3 b = in_plane(positions_[face.vertex[(i + 1) % 3]] - here, n);
            const float cosine = std::min(std::max(dot(a, b), -1.0f), 1.0f);
            const vec3 tangent = in_plane(face.tangent, n);
            sum = sum + static_cast<float>(std::acos(static_cast<double>(cosine))) * tangent;
            unweighted = unweighted + tangent;
        }
        for (const vec3& candidate : {normalized(sum), normalized(unweighted)})
            if (not_zero(length(candidate))) return candidate;
        return any_perpendicular(n);
    }

    static vec3 any_perpendicular(const vec3& n)
    {
        const vec3 axis = std::abs(n.x) < 0.5f ? vec3(1, 0, 0) : vec3(0, 1, 0);
        const vec3 out = in_plane(axis, n);
        return not_zero(length(out)) ? out : axis;
    }

    static std::uint32_t corner_of(const Face& face, std::uint32_t vertex)
    {
        for (std::uint32_t i = 0; i < 3; ++i)
            if (face.vertex[i] == vertex) return i;
        assume(false);
        return 0;
    }

    std::span<const vec3> positions_;
    std::span<const vec3> normals_;
    std::span<const vec2> uv_;
    std::span<const std::uint32_t> indices_;
    std::vector<std::uint32_t> welded_;  // per corner
    std::vector<Face> faces_;
    std::vector<Group> groups_;
};

}  // namespace

std::vector<vec4> compute_tangents(std::span<const vec3> positions, std::span<const vec3> normals,
                                   std::span<const vec2> uv, std::span<const std::uint32_t> indices)
{
    assume(normals.size() == positions.size() && uv.size() == positions.size() && indices.size() % 3 == 0);
    assume(std::all_of(indices.begin(), indices.end(), [&](std::uint32_t i) { return i < positions.size(); }));
    return Tangents(positions, normals, uv, indices).corners();
}

}  // namespace etalon
