#pragma once
#include <array>
#include <cstdint>
#include <vector>

#include "engine/gpu/commands.h"
#include "engine/scene/pose.h"
#include "engine/scene/requirements.h"

namespace etalon {

/// The vertex streams of mesh.vert, in the order of its locations.
enum class RasterStream : unsigned { position, normal, tangent, uv0, uv1, color, beside, count };

/// Bytes of the streams that a scene's meshes take on a device, without indices and face normals.
std::uint64_t raster_stream_bytes(const PosedScene& posed, const Requirements& required);

/// The meshes of a posed scene on a device: one buffer per attribute that is required, shared by all draws. An
/// attribute that is not required is a single default vertex read with stride 0. Lines and points are rectangles, made
/// of two triangles each (SH-7).
class RasterGeometry {
 public:
    RasterGeometry(gpu::Device& device, const PosedScene& posed, const Requirements& required);

    std::vector<gpu::VertexStream> streams() const;
    static std::vector<gpu::VertexAttribute> attributes();
    void bind(gpu::Commands& commands) const;
    /// Object-space unit normals of all triangles, 3 floats each, for the fragment shader.
    const gpu::Buffer& face_normals() const { return face_normals_; }

    /// Where a primitive lies in the buffers; an index_count of 0 where it is not drawn.
    struct Range {
        std::uint32_t first_index = 0;
        std::uint32_t index_count = 0;
        std::int32_t first_vertex = 0;
        std::uint32_t first_face = 0;
        vec3 low{0}, high{0};  ///< its box in object space
    };
    const Range& range(const Draw& draw) const
    {
        return draw.deformed != kNone ? ranges_.back()[draw.deformed] : ranges_[draw.mesh][draw.primitive];
    }

 private:
    static constexpr std::size_t kStreams = static_cast<std::size_t>(RasterStream::count);
    std::vector<std::vector<Range>> ranges_;  // by mesh, primitive; the last row: deformed primitives
    std::array<gpu::Buffer, kStreams> buffers_;
    std::array<bool, kStreams> present_{};
    gpu::Buffer indices_;
    gpu::Buffer face_normals_;
};

}  // namespace etalon
