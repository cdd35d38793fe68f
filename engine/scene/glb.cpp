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

struct Chunk {
    std::uint32_t type = 0;
    std::span<const std::byte> body;
};

Chunk read_chunk(std::span<const std::byte> bytes, std::size_t at)
{
    if (bytes.size() - at < kChunkHeader)
        throw broken(fmt::format("GLB chunk header cut at byte {} [GLB_UNEXPECTED_END_OF_CHUNK_HEADER]", at));
    const std::size_t size = word(bytes, at);
    const std::size_t left = bytes.size() - at - kChunkHeader;
    if (size > left)
        throw broken(
            fmt::format("GLB chunk at byte {} says {} bytes, but {} are left [GLB_CHUNK_TOO_BIG]", at, size, left));
    return {.type = word(bytes, at + 4), .body = bytes.subspan(at + kChunkHeader, size)};
}

std::vector<std::string_view> broken_rules(const Chunk& chunk, std::size_t index, const GltfParts& before)
{
    std::vector<std::string_view> out;
    if (chunk.body.size() % 4 != 0) out.push_back("its length is no multiple of 4 [GLB_CHUNK_LENGTH_UNALIGNED]");
    if (index > 0 && chunk.type == kJson) out.push_back("one more JSON chunk is ignored [GLB_DUPLICATE_CHUNK]");
    if (chunk.type == kBinary && before.binary) out.push_back("one more BIN chunk is ignored [GLB_DUPLICATE_CHUNK]");
    if (chunk.type == kBinary && index > 1) out.push_back("BIN is not the second chunk [GLB_UNEXPECTED_BIN_CHUNK]");
    if (chunk.type != kJson && chunk.type != kBinary)
        out.push_back("a chunk of unknown type is ignored [GLB_UNKNOWN_CHUNK_TYPE]");
    return out;
}

}  // namespace

GltfParts split_gltf(std::span<const std::byte> bytes)
{
    if (bytes.size() < 4 || word(bytes, 0) != kMagic) {
        std::string_view json = text(bytes);
        if (json.starts_with("\xef\xbb\xbf"))
            json.remove_prefix(3);  // the specification lets readers ignore a byte order mark
        return {.json = json, .binary = std::nullopt};
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

    GltfParts parts;
    if (length < bytes.size())
        parts.warnings.push_back(
            fmt::format("{} bytes behind the end of the GLB are ignored [GLB_EXTRA_DATA]", bytes.size() - length));
    bytes = bytes.first(length);
    std::size_t index = 0;
    for (std::size_t at = kHeader; at < length; ++index) {
        const Chunk chunk = read_chunk(bytes, at);
        if (index == 0 && chunk.type != kJson)
            throw broken("the first chunk of the GLB is not JSON [GLB_UNEXPECTED_FIRST_CHUNK]");
        for (const std::string_view rule : broken_rules(chunk, index, parts))
            parts.warnings.push_back(fmt::format("GLB chunk at byte {}: {}", at, rule));
        if (index == 0)
            parts.json = text(chunk.body);
        else if (chunk.type == kBinary && !parts.binary)
            parts.binary = chunk.body;
        at += kChunkHeader + chunk.body.size();
    }
    if (index == 0) throw broken("GLB without a chunk [GLB_UNEXPECTED_END_OF_HEADER]");
    // Some writers pad the JSON with zeros instead of spaces.
    while (parts.json.ends_with('\0')) parts.json.remove_suffix(1);
    return parts;
}

}  // namespace etalon
