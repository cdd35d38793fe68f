#pragma once
#include <cstddef>
#include <map>
#include <span>
#include <vector>

#include "engine/scene/compressed_header.h"
#include "engine/scene/gltf_model.h"
#include "engine/scene/preflight.h"

namespace etalon::gltf {

/// What compression extensions stand for: bytes that no buffer of the file has.
struct Decoded {
    std::map<std::size_t, std::vector<std::byte>> views;      ///< by bufferView, as it declares them
    std::map<std::size_t, std::vector<std::byte>> accessors;  ///< by accessor, tightly packed
};

/// Decodes every bufferView of EXT_ or KHR_meshopt_compression and every primitive of KHR_draco_mesh_compression that
/// preflight has passed. Throws Error(input) with a JSON pointer: damaged payloads, meshopt's codec version 1 and
/// colour filter, over limits.decoded_bytes in all, a Draco mesh that is not what its accessors say.
Decoded decode_compressed(const Model& model, const CheckedGltf& file, const Limits& limits);

}  // namespace etalon::gltf

namespace etalon {

enum class MeshoptFilter { none, octahedral, quaternion, exponential };

/// `count` elements of `stride` bytes. Throws Error(input). compressed_meshopt.cpp
std::vector<std::byte> decode_meshopt(std::span<const std::byte> payload, MeshoptMode mode, MeshoptFilter filter,
                                      std::size_t count, std::size_t stride);

/// How an attribute of a Draco mesh is wanted.
struct DracoWish {
    std::uint32_t id = 0;        ///< the attribute's unique id
    int component_type = 0;      ///< glTF's number: 5120 … 5126
    std::size_t components = 0;  ///< of an element
    std::size_t count = 0;       ///< elements
};

struct DracoMesh {
    std::vector<std::uint32_t> corners;              ///< three a face, below `points`
    std::vector<std::vector<std::byte>> attributes;  ///< of each wish, tightly packed
};

/// Decodes a payload whose header has been read. Throws Error(input) where it is damaged or holds something else than
/// wished. compressed_draco.cpp
DracoMesh decode_draco(std::span<const std::byte> payload, std::span<const DracoWish> wishes);

}  // namespace etalon
