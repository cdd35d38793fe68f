#include "engine/scene/compressed_header.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cstring>
#include <string>
#include <vector>

#include "engine/base/error.h"

namespace etalon {

namespace {

constexpr unsigned kMetadataFlag = 0x8000;
constexpr std::size_t kMetadataDepth = 16;
constexpr std::uint32_t kMostElements = std::uint32_t{1} << 30;  // three corners a face stay within 32 bits

Error bad(std::string what)
{
    return Error(Blame::input, std::move(what),
                 "compress the mesh again, or decode it: gltf-transform copy in.glb out.glb writes it uncompressed");
}

class Reader {
 public:
    explicit Reader(std::span<const std::byte> bytes) : bytes_(bytes) {}

    unsigned byte()
    {
        need(1);
        return std::to_integer<unsigned>(bytes_[at_++]);
    }
    void skip(std::size_t count)
    {
        need(count);
        at_ += count;
    }
    // LEB128 of at most 32 bits.
    std::uint32_t varint()
    {
        std::uint64_t value = 0;
        for (unsigned shift = 0; shift < 35; shift += 7) {
            const unsigned part = byte();
            value |= std::uint64_t{part & 0x7fu} << shift;
            if (part < 0x80) {
                if (value > 0xffff'ffffu) break;
                return static_cast<std::uint32_t>(value);
            }
        }
        throw bad("Draco: a count of more than 32 bits");
    }

 private:
    void need(std::size_t count) const
    {
        if (count > bytes_.size() - at_) throw bad(fmt::format("Draco: the payload ends at byte {}", bytes_.size()));
    }

    std::span<const std::byte> bytes_;
    std::size_t at_ = 0;
};

// One level: names with values. Gives the number of levels below, each behind its name.
std::uint32_t skip_entries(Reader& in)
{
    const std::uint32_t entries = in.varint();
    for (std::uint32_t i = 0; i < entries; ++i) {
        in.skip(in.byte());
        in.skip(in.varint());
    }
    return in.varint();
}

void skip_level(Reader& in)
{
    std::vector<std::uint32_t> left = {skip_entries(in)};  // levels still to come, of each that is open
    while (!left.empty()) {
        if (left.back() == 0) {
            left.pop_back();
            continue;
        }
        --left.back();
        if (left.size() == kMetadataDepth)
            throw bad(fmt::format("Draco: metadata nested more than {} deep", kMetadataDepth));
        in.skip(in.byte());
        left.push_back(skip_entries(in));
    }
}

void skip_metadata(Reader& in)
{
    const std::uint32_t attributes = in.varint();
    for (std::uint32_t i = 0; i < attributes; ++i) {
        in.varint();  // the attribute's id
        skip_level(in);
    }
    skip_level(in);
}

DracoClaim sequential_counts(Reader& in)
{
    DracoClaim claim;
    claim.faces = in.varint();
    claim.vertices = in.varint();
    in.byte();
    return claim;
}

DracoClaim edgebreaker_counts(Reader& in)
{
    DracoClaim claim;
    in.byte();  // how the traversal is coded
    claim.vertices = in.varint();
    claim.faces = in.varint();
    in.byte();  // attributes with seams of their own
    const std::uint32_t symbols = in.varint();
    const std::uint32_t splits = in.varint();
    if (symbols > claim.faces || splits > symbols)
        throw bad(fmt::format("Draco: {} symbols with {} splits for {} faces", symbols, splits, claim.faces));
    return claim;
}

// Bytes that the codec of attributes spends at least: per block of vertices, on bit counts (version 0) or control bits
// (version 1) of every byte of the stride, and on the last vertex.
std::uint64_t least_attribute_bytes(std::uint64_t count, std::uint64_t stride, unsigned version)
{
    const std::uint64_t block = std::min<std::uint64_t>(8192 / stride / 16 * 16, 256);
    const std::uint64_t blocks = count / block;  // whole ones: a bound, the rest is small
    const std::uint64_t head = version == 0 ? stride * ((block / 16 + 3) / 4) : stride / 4;
    return 1 + blocks * head + stride;
}

}  // namespace

DracoClaim read_draco_header(std::span<const std::byte> payload)
{
    Reader in(payload);
    for (const char expected : {'D', 'R', 'A', 'C', 'O'})
        if (in.byte() != static_cast<unsigned char>(expected)) throw bad("the payload is not Draco");
    const unsigned major = in.byte();
    const unsigned minor = in.byte();
    if (major != 2 || minor != 2) throw bad(fmt::format("Draco bitstream {}.{}: glTF uses 2.2", major, minor));
    if (in.byte() != 1) throw bad("Draco: a point cloud, not a mesh");
    const unsigned method = in.byte();
    if (method > 1) throw bad(fmt::format("Draco: encoder method {} is not known", method));
    const unsigned low = in.byte();
    if (((in.byte() << 8 | low) & kMetadataFlag) != 0) skip_metadata(in);
    const DracoClaim claim = method == 0 ? sequential_counts(in) : edgebreaker_counts(in);
    if (claim.faces > kMostElements || claim.vertices > kMostElements)
        throw bad(fmt::format("Draco: {} faces of {} vertices", claim.faces, claim.vertices));
    return claim;
}

void check_meshopt_payload(std::span<const std::byte> payload, MeshoptMode mode, std::uint64_t count,
                           std::uint64_t stride)
{
    assume(stride >= 1 && stride <= 256);
    if (count > kMostElements) throw bad(fmt::format("meshopt: {} elements", count));
    const unsigned head = payload.empty() ? 0 : std::to_integer<unsigned>(payload[0]);
    const std::array<unsigned, 3> kinds = {0xa0, 0xe0, 0xd0};
    const unsigned version = head & 0x0fu;
    if ((head & 0xf0u) != kinds[static_cast<std::size_t>(mode)] || version > 1)
        throw bad(fmt::format("meshopt: the payload begins with 0x{:02x}, which is no stream of its mode", head));
    const std::uint64_t least = mode == MeshoptMode::attributes  ? least_attribute_bytes(count, stride, version)
                                : mode == MeshoptMode::triangles ? 1 + count / 3 + 16
                                                                 : 1 + count + 4;
    if (payload.size() < least)
        throw bad(fmt::format("meshopt: {} bytes cannot hold {} elements, which take {} at least", payload.size(),
                              count, least));
}

}  // namespace etalon
