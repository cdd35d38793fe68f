#include "engine/render/raster_geometry.h"

#include <algorithm>
#include <string>

#include "engine/base/error.h"

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
        range = {.first_index = static_cast<std::uint32_t>(indices),
                 .index_count = static_cast<std::uint32_t>(primitive.indices.size()),
                 .first_vertex = static_cast<std::int32_t>(vertices),
                 .first_face = static_cast<std::uint32_t>(faces)};
        vertices += primitive.positions.size();
        indices += primitive.indices.size();
        if (primitive.topology == Topology::triangles) faces += primitive.indices.size() / 3;
        primitives.push_back(&primitive);
    }
    if (vertices > 0x7fffffffu || indices > 0xffffffffu)
        throw Error(Blame::input, "the scene has more than 2^31 vertices or 2^32 indices", "split it");
    return primitives;
}

}  // namespace

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
            const std::span<const float> own = values(*primitive, stream);
            if (own.empty())
                all.insert(all.end(), primitive->positions.size() * kFormats[i].floats, default_value(stream));
            else
                all.insert(all.end(), own.begin(), own.end());
        }
        buffers_[i] = gpu::make_buffer(device, all, kFormats[i].name);
    }
    std::vector<std::uint32_t> indices;
    std::vector<vec3> normals;
    for (const Primitive* primitive : primitives) {
        indices.insert(indices.end(), primitive->indices.begin(), primitive->indices.end());
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
