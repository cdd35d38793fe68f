#pragma once
#include <cstddef>
#include <cstdint>
#include <span>

namespace etalon {

/// What the header of a Draco payload says it holds.
struct DracoClaim {
    std::uint32_t faces = 0;
    std::uint32_t vertices = 0;  ///< decoded points are these, or more where attributes have seams
};

/// Reads the header of a Draco mesh (bitstream 2.2, the one that KHR_draco_mesh_compression names) up to its counts;
/// nothing is allocated. Throws Error(input): not Draco, another version, a point cloud, metadata nested deeper than
/// 16 (its decoder recurses), counts that contradict each other or pass 2^30, a payload that ends before them. Source:
/// Draco Bitstream Specification 2.2.
DracoClaim read_draco_header(std::span<const std::byte> payload);

enum class MeshoptMode { attributes, triangles, indices };

/// A payload that claims `count` elements of `stride` bytes has the header of its mode and at least the bytes that the
/// codec spends on so many, so that memory for them is in proportion to the payload: at most 1,024 times (attributes),
/// 12 times (triangles), 4 times (indices). Throws Error(input). Source: KHR_meshopt_compression, appendix A.
void check_meshopt_payload(std::span<const std::byte> payload, MeshoptMode mode, std::uint64_t count,
                           std::uint64_t stride);

}  // namespace etalon
