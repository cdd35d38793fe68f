#pragma once
// Private to engine/image: what the module libetalon_pictures does with OpenImageIO. It is a library of its own, loaded
// when the first picture is read or written: OpenImageIO brings 260 others, which cost every start 0.2 s and 60 MB.
#include <cstddef>
#include <functional>
#include <map>
#include <span>
#include <string>
#include <vector>

#include "engine/image/codec.h"

namespace etalon::codec {

/// What a file's header says, as the library understood it.
struct Header {
    int width = 0;
    int height = 0;
    int depth = 1;
    std::vector<std::string> channels;
    std::size_t pixel_bytes = 0;
    bool deep = false;
    bool windows_differ = false;  ///< the data window is not the display window
    int tile_width = 0;           ///< 0: scan lines
    int tile_height = 0;
};

enum class ChannelType { code8, float32, uint32 };

/// A picture to be written: interleaved channels, each of its type.
struct Sheet {
    Format format = Format::png;
    int width = 0;
    int height = 0;
    std::vector<std::string> channels;
    std::vector<ChannelType> types;
    const void* data = nullptr;
    const std::map<std::string, std::string>* text = nullptr;
};

/// Both throw std::runtime_error about the picture, std::logic_error where this OpenImageIO lacks the format.
struct PictureLibrary {
    /// `check` sees the header before a pixel is read; what it throws passes.
    Picture (*decode)(std::span<const std::byte> bytes, Format format,
                      const std::function<void(const Header&)>& check) = nullptr;
    std::vector<std::byte> (*encode)(const Sheet& sheet) = nullptr;
};

/// Loads the module, once. Throws Error(machine) when it is not to be found.
const PictureLibrary& picture_library();

}  // namespace etalon::codec

/// The module's one entry.
extern "C" const etalon::codec::PictureLibrary* etalon_picture_library();
