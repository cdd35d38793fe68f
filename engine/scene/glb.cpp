#include "engine/scene/glb.h"

#include <fmt/format.h>

#include <cstdint>

#include "engine/base/error.h"

namespace etalon {

namespace {

constexpr std::uint32_t kMagic = 0x46546c67;   // "glTF"
constexpr std::uint32_t kJson = 0x4e4f534a;    // "JSON"
constexpr std::uint32_t kBinary = 0x004e4942;  // "BIN"
constexpr std::size_t kHeader = 12;
constexpr std::size_t kChunkHeader = 8;

std::uint32_t word(std::span<const std::byte> bytes, std::size_t at)
{
    std::uint32_t out = 0;
    for (std::size_t i = 0; i < 4; ++i) out |= std::to_integer<std::uint32_t>(bytes[at + i]) << (8 * i);
    return out;
}

std::string_view text(std::span<const std::byte> bytes)
{
    return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

Error broken(std::string what)
{
    return Error(Blame::input, std::move(what), "the file is cut short or damaged: copy or export it again");
}

}  // namespace

GltfParts split_gltf(std::span<const std::byte> bytes)
{
    if (bytes.size() < 4 || word(bytes, 0) != kMagic) {
        std::string_view json = text(bytes);
        if (json.starts_with("\xef\xbb\xbf"))
            json.remove_prefix(3);  // the specification lets readers ignore a byte order mark
        return {json, std::nullopt};
    }
    if (bytes.size() < kHeader)
        throw broken(
            fmt::format("GLB of {} bytes: its header alone has 12 [GLB_UNEXPECTED_END_OF_HEADER]", bytes.size()));
    if (word(bytes, 4) != 2)
        throw Error(Blame::input, fmt::format("GLB version {} [GLB_INVALID_VERSION]", word(bytes, 4)),
                    "export as glTF 2.0");
    const std::size_t length = word(bytes, 8);
    if (length > bytes.size() || length < kHeader)
        throw broken(
            fmt::format("GLB says it has {} bytes, but there are {} [GLB_LENGTH_MISMATCH]", length, bytes.size()));
    bytes = bytes.first(length);

    GltfParts parts;
    bool first = true;
    for (std::size_t at = kHeader; at < length;) {
        if (length - at < kChunkHeader)
            throw broken(fmt::format("GLB chunk header cut at byte {} [GLB_UNEXPECTED_END_OF_CHUNK_HEADER]", at));
        const std::size_t size = word(bytes, at);
        const std::uint32_t type = word(bytes, at + 4);
        at += kChunkHeader;
        if (size > length - at)
            throw broken(fmt::format("GLB chunk at byte {} says {} bytes, but {} are left [GLB_CHUNK_TOO_BIG]",
                                     at - kChunkHeader, size, length - at));
        const auto body = bytes.subspan(at, size);
        if (first && type != kJson) throw broken("the first chunk of the GLB is not JSON [GLB_UNEXPECTED_FIRST_CHUNK]");
        if (first)
            parts.json = text(body);
        else if (type == kBinary && !parts.binary)
            parts.binary = body;
        first = false;
        at += size;
    }
    if (first) throw broken("GLB without a chunk [GLB_UNEXPECTED_END_OF_HEADER]");
    return parts;
}

}  // namespace etalon
