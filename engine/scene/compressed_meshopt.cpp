// The one includer of meshoptimizer in this room.
#include <fmt/format.h>
#include <meshoptimizer.h>

#include "engine/base/error.h"
#include "engine/scene/compressed.h"

namespace etalon {

namespace {

Error bad(std::string what)
{
    return Error(Blame::input, std::move(what),
                 "compress the file again, or decode it: gltf-transform copy in.glb out.glb writes it uncompressed");
}

}  // namespace

std::vector<std::byte> decode_meshopt(std::span<const std::byte> payload, MeshoptMode mode, MeshoptFilter filter,
                                      std::size_t count, std::size_t stride)
{
    assume(!payload.empty());
    // The library reads version 0 of the attribute codec; to it the next one is damage.
    if (mode == MeshoptMode::attributes && (std::to_integer<unsigned>(payload[0]) & 0x0fu) != 0)
        throw bad("meshopt: attributes of codec version 1 (meshoptimizer 0.23 and later) are not read");
    std::vector<std::byte> out(count * stride);
    const auto* bytes = reinterpret_cast<const unsigned char*>(payload.data());
    int failure = 0;
    switch (mode) {
        case MeshoptMode::attributes:
            failure = meshopt_decodeVertexBuffer(out.data(), count, stride, bytes, payload.size());
            break;
        case MeshoptMode::triangles:
            failure = meshopt_decodeIndexBuffer(out.data(), count, stride, bytes, payload.size());
            break;
        case MeshoptMode::indices:
            failure = meshopt_decodeIndexSequence(out.data(), count, stride, bytes, payload.size());
            break;
    }
    if (failure != 0) throw bad(fmt::format("meshopt: the payload is damaged (decoder's code {})", failure));
    switch (filter) {
        case MeshoptFilter::none:
            break;
        case MeshoptFilter::octahedral:
            meshopt_decodeFilterOct(out.data(), count, stride);
            break;
        case MeshoptFilter::quaternion:
            meshopt_decodeFilterQuat(out.data(), count, stride);
            break;
        case MeshoptFilter::exponential:
            meshopt_decodeFilterExp(out.data(), count, stride);
            break;
    }
    return out;
}

}  // namespace etalon
