#include "engine/render/raster_geometry.h"

#include <algorithm>
#include <string>
#include <tuple>

#include "engine/base/error.h"
#include "engine/scene/builder.h"

namespace etalon {
namespace {

struct StreamFormat {
    const char* name;
    VkFormat format;
    std::uint32_t floats;
};

constexpr std::array<StreamFormat, static_cast<std::size_t>(RasterStream::count)> kFormats{{
    {"positions", VK_FORMAT_R32G32B32_SFLOAT, 3},
    {"normals", VK_FORMAT_R32G32B32_SFLOAT, 3},
    {"tangents", VK_FORMAT_R32G32B32A32_SFLOAT, 4},
    {"TEXCOORD_0", VK_FORMAT_R32G32_SFLOAT, 2},
    {"TEXCOORD_1", VK_FORMAT_R32G32_SFLOAT, 2},
    {"colours", VK_FORMAT_R32G32B32A32_SFLOAT, 4},
    {"corners of lines and points", VK_FORMAT_R32G32B32A32_SFLOAT, 4},
}};

bool is_required(RasterStream stream, const Requirements& required)
{
    switch (stream) {
        case RasterStream::normal:
            return required.has(Feature::normals);
        case RasterStream::tangent:
            return required.has(Feature::tangents);
        case RasterStream::uv0:
            return required.has(Feature::uv0);
        case RasterStream::uv1:
            return required.has(Feature::uv1);
        case RasterStream::color:
            return required.has(Feature::vertex_colors);
        case RasterStream::beside:
            return required.has(Feature::lines) || required.has(Feature::points);
        default:
            return true;
    }
}

bool is_required(Topology topology, const Requirements& required)
{
    switch (topology) {
        case Topology::points:
            return required.has(Feature::points);
        case Topology::lines:
            return required.has(Feature::lines);
        default:
            return required.has(Feature::triangles);
    }
}

/// The attribute's values; empty where the primitive has none.
std::span<const float> values(const Primitive& primitive, RasterStream stream)
{
    const auto flat = [](const auto& list) {
        using Vector = typename std::remove_cvref_t<decltype(list)>::value_type;
        return std::span<const float>(list.empty() ? nullptr : &list[0].x, list.size() * Vector::length());
    };
    switch (stream) {
        case RasterStream::normal:
            return flat(primitive.normals);
        case RasterStream::tangent:
            return flat(primitive.tangents);
        case RasterStream::uv0:
            return flat(primitive.uv[0]);
        case RasterStream::uv1:
            return flat(primitive.uv[1]);
        case RasterStream::color:
            return flat(primitive.colors);
        case RasterStream::beside:
            return {};
        default:
            return flat(primitive.positions);
    }
}

/// Of an attribute that the primitive lacks: white, else 0.
float default_value(RasterStream stream)
{
    return stream == RasterStream::color ? 1.f : 0.f;
}

/// (SH-1) in object space; in double, for the sake of slivers (G12). 0 without area.
vec3 face_normal(const Primitive& primitive, std::size_t face)
{
    const auto corner = [&](std::size_t i) { return dvec3(primitive.positions[primitive.indices[face * 3 + i]]); };
    const dvec3 p0 = corner(0);
    const dvec3 n = cross(corner(1) - p0, corner(2) - p0);
    const double area = length(n);
    return area > 0 ? vec3(n / area) : vec3(0);
}

/// How many vertices an element has that is drawn as a rectangle; 0: triangles, drawn as they are.
std::size_t ends(const Primitive& primitive)
{
    return primitive.topology == Topology::lines ? 2 : primitive.topology == Topology::points ? 1 : 0;
}

std::uint64_t drawn_vertices(const Primitive& primitive)
{
    const std::size_t own = ends(primitive);
    return own == 0 ? primitive.positions.size() : primitive.indices.size() / own * 4;
}

std::uint64_t drawn_indices(const Primitive& primitive)
{
    const std::size_t own = ends(primitive);
    return own == 0 ? primitive.indices.size() : primitive.indices.size() / own * 6;
}

/// Which vertex each corner of the rectangles is, four a line or point, going round.
std::vector<std::uint32_t> corners(const Primitive& primitive)
{
    const std::size_t own = ends(primitive);
    std::vector<std::uint32_t> out;
    for (std::size_t i = 0; i + own <= primitive.indices.size(); i += own) {
        const std::uint32_t first = primitive.indices[i], last = primitive.indices[i + own - 1];
        out.insert(out.end(), {first, last, last, first});
    }
    return out;
}

/// RasterStream::beside of those corners.
void add_beside(const Primitive& primitive, std::vector<float>& all)
{
    if (primitive.topology == Topology::points) {
        for (std::size_t i = 0; i < primitive.indices.size(); ++i)
            for (const vec2 corner : {vec2(-1, -1), vec2(1, -1), vec2(1, 1), vec2(-1, 1)})
                all.insert(all.end(), {corner.x, corner.y, 0, 0});
        return;
    }
    for (std::size_t i = 0; i + 2 <= primitive.indices.size(); i += 2) {
        const vec3 a = primitive.positions[primitive.indices[i]], b = primitive.positions[primitive.indices[i + 1]];
        // Seen from its other end, a side is the other side.
        all.insert(all.end(), {b.x, b.y, b.z, 1, a.x, a.y, a.z, -1, a.x, a.y, a.z, 1, b.x, b.y, b.z, -1});
    }
}

/// One attribute of a primitive as it is drawn.
void add_values(const Primitive& primitive, RasterStream stream, std::uint32_t floats, std::vector<float>& all)
{
    if (stream == RasterStream::beside && ends(primitive) != 0) {
        add_beside(primitive, all);
        return;
    }
    const std::span<const float> own = values(primitive, stream);
    if (own.empty()) {
        all.insert(all.end(), drawn_vertices(primitive) * floats, default_value(stream));
    } else if (ends(primitive) == 0) {
        all.insert(all.end(), own.begin(), own.end());
    } else {
        for (const std::uint32_t vertex : corners(primitive)) {
            const auto value = own.subspan(std::size_t{vertex} * floats, floats);
            all.insert(all.end(), value.begin(), value.end());
        }
    }
}

void add_indices(const Primitive& primitive, std::vector<std::uint32_t>& indices)
{
    if (ends(primitive) == 0) {
        indices.insert(indices.end(), primitive.indices.begin(), primitive.indices.end());
        return;
    }
    for (std::uint32_t first = 0; first < drawn_vertices(primitive); first += 4)
        indices.insert(indices.end(), {first, first + 1, first + 2, first, first + 2, first + 3});
}

/// The primitives that are drawn, each once, in order.
std::vector<const Primitive*> drawn_primitives(const PosedScene& posed, const Requirements& required,
                                               std::vector<std::vector<RasterGeometry::Range>>& ranges)
{
    for (const Mesh& mesh : posed.scene->meshes) ranges.emplace_back(mesh.primitives.size());
    ranges.emplace_back(posed.deformed.size());
    std::vector<const Primitive*> primitives;
    std::uint64_t vertices = 0, indices = 0, faces = 0;
    for (const Draw& draw : posed.draws) {
        const Primitive& primitive = posed.primitive(draw);
        RasterGeometry::Range& range =
            draw.deformed != kNone ? ranges.back()[draw.deformed] : ranges[draw.mesh][draw.primitive];
        if (range.index_count != 0 || primitive.indices.empty()) continue;
        if (!is_required(primitive.topology, required)) continue;
        const std::uint64_t index_count = drawn_indices(primitive);
        range = {.first_index = static_cast<std::uint32_t>(indices),
                 .index_count = static_cast<std::uint32_t>(index_count),
                 .first_vertex = static_cast<std::int32_t>(vertices),
                 .first_face = static_cast<std::uint32_t>(faces)};
        std::tie(range.low, range.high) = bounds(primitive);
        vertices += drawn_vertices(primitive);
        indices += index_count;
        if (primitive.topology == Topology::triangles) faces += primitive.indices.size() / 3;
        primitives.push_back(&primitive);
    }
    if (vertices > 0x7fffffffu || indices > 0xffffffffu)
        throw Error(Blame::input, "the scene has more than 2^31 vertices or 2^32 indices", "split it");
    return primitives;
}

}  // namespace

std::uint64_t raster_stream_bytes(const PosedScene& posed, const Requirements& required)
{
    std::uint64_t floats = 0;
    for (std::size_t i = 0; i < kFormats.size(); ++i)
        if (is_required(static_cast<RasterStream>(i), required)) floats += kFormats[i].floats;
    std::vector<std::vector<RasterGeometry::Range>> ranges;
    std::uint64_t vertices = 0;
    for (const Primitive* primitive : drawn_primitives(posed, required, ranges)) vertices += drawn_vertices(*primitive);
    return vertices * floats * sizeof(float);
}

RasterGeometry::RasterGeometry(gpu::Device& device, const PosedScene& posed, const Requirements& required)
{
    const std::vector<const Primitive*> primitives = drawn_primitives(posed, required, ranges_);
    for (std::size_t i = 0; i < kStreams; ++i) {
        const auto stream = static_cast<RasterStream>(i);
        present_[i] = is_required(stream, required) && !primitives.empty();
        std::vector<float> all;
        if (!present_[i]) all.assign(4, default_value(stream));
        for (const Primitive* primitive : primitives) {
            if (!present_[i]) break;
            add_values(*primitive, stream, kFormats[i].floats, all);
        }
        buffers_[i] = gpu::make_buffer(device, all, kFormats[i].name);
    }
    std::vector<std::uint32_t> indices;
    std::vector<vec3> normals;
    for (const Primitive* primitive : primitives) {
        add_indices(*primitive, indices);
        if (primitive->topology != Topology::triangles) continue;
        for (std::size_t face = 0; face < primitive->indices.size() / 3; ++face)
            normals.push_back(face_normal(*primitive, face));
    }
    indices_ = gpu::make_buffer(device, indices, "indices");
    face_normals_ = gpu::make_buffer(device, normals, "face normals");
}

std::vector<gpu::VertexStream> RasterGeometry::streams() const
{
    std::vector<gpu::VertexStream> streams;
    for (std::size_t i = 0; i < kStreams; ++i)
        streams.push_back({.stride = present_[i] ? kFormats[i].floats * std::uint32_t{sizeof(float)} : 0});
    return streams;
}

std::vector<gpu::VertexAttribute> RasterGeometry::attributes()
{
    std::vector<gpu::VertexAttribute> attributes;
    for (std::uint32_t i = 0; i < kStreams; ++i)
        attributes.push_back({.location = i, .format = kFormats[i].format, .stream = i});
    return attributes;
}

void RasterGeometry::bind(gpu::Commands& commands) const
{
    for (std::uint32_t i = 0; i < kStreams; ++i) commands.bind_vertices(i, buffers_[i]);
    commands.bind_indices(indices_);
}

}  // namespace etalon
