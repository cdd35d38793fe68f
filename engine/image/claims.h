#pragma once
// Private to engine/image: what the first bytes of a coded picture claim, read before any library sees them.
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "engine/base/limits.h"
#include "engine/image/codec.h"

namespace etalon::codec {

struct Claims {
    std::uint64_t width = 0;
    std::uint64_t height = 0;
    std::uint64_t channels = 1;
    std::uint64_t pixel_bytes = 1;  ///< once decoded
};

/// The sizes that the header of a whole file of `format` claims. Nothing for a header without them and for Radiance
/// HDR, whose reader reserves nothing on its word. Throws Error naming `name` where the header is not within the file,
/// or is of a kind we do not read (a deep EXR).
std::optional<Claims> read_claims(std::span<const std::byte> bytes, Format format, const std::string& name);

/// Throws Error naming `name` when the claims are over the limits, or out of proportion to a file of `file_bytes`.
void check_claims(const Claims& claims, std::size_t file_bytes, const Limits& limits, const std::string& name);

/// Whether the file goes on to its end: every chunk of a PNG to IEND, a JPEG to its end marker. True for other formats,
/// whose readers notice.
bool is_whole(std::span<const std::byte> bytes, Format format);

/// The same picture without what is not picture: colour profiles, camera data, texts. Readers unpack and parse these
/// whether we look at them or not, and kilobytes of text unpack to gigabytes. PNG, JPEG and WebP; others unchanged.
std::vector<std::byte> bare(std::span<const std::byte> bytes, Format format);

/// The same WebP file with its alpha switched off. OpenImageIO 2.4 multiplies WebP's colour by alpha whatever it is
/// asked, which cannot be undone in 8 bits; from this copy it decodes the colour as it is.
std::vector<std::byte> webp_without_alpha(std::span<const std::byte> bytes);

}  // namespace etalon::codec
