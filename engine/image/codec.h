#pragma once
// Private to engine/image: the little of OpenImageIO that we use, behind checks that it does not make itself.
#include <cstddef>
#include <cstdint>
#include <map>
#include <span>
#include <string>
#include <variant>
#include <vector>

#include "engine/base/limits.h"

namespace etalon::codec {

enum class Format { png, jpeg, webp, hdr, exr };

/// A decoded file: interleaved values, row 0 on top, not premultiplied where the format is not.
struct Picture {
    Format format = Format::png;
    int width = 0;
    int height = 0;
    std::vector<std::string> channels;                           ///< names: R G B A or Y first
    std::vector<std::uint8_t> codes8;                            ///< filled for files of up to 8 bits a channel
    std::vector<std::uint16_t> codes16;                          ///< … of 16 bits
    std::vector<float> values;                                   ///< … of EXR and HDR
    std::map<std::string, std::vector<std::uint32_t>> integers;  ///< EXR's uint32 channels once more, exactly
    std::map<std::string, std::string> text;                     ///< string attributes
};

/// Decodes `bytes`, which must be of one of `accepted` by their first bytes, and whose header must not claim more than
/// `limits` allow. The one way to any decoder. Throws Error naming `name`.
Picture decode(std::span<const std::byte> bytes, std::span<const Format> accepted, const Limits& limits,
               const std::string& name);

/// One channel to write: `step` values between pixels.
struct Channel {
    std::string name;
    std::variant<const float*, const std::uint32_t*> first;
    std::size_t step = 1;
};

std::vector<std::byte> encode_exr(int width, int height, std::span<const Channel> channels,
                                  const std::map<std::string, std::string>& text);

/// 3 or 4 channels of sRGB codes, not premultiplied.
std::vector<std::byte> encode_png(int width, int height, int channels, std::span<const std::uint8_t> codes,
                                  const std::map<std::string, std::string>& text);

}  // namespace etalon::codec
