#pragma once
#include <cstddef>
#include <filesystem>
#include <span>
#include <string>

#include "engine/image/film.h"
#include "engine/image/image.h"

namespace etalon {

/// Decodes PNG, JPEG, WebP (8 or 16 bit a channel) from memory into RGBA texels; grey and missing alpha are filled.
/// The reader is chosen by magic bytes. `name` goes into errors. Refuses over 2^28 pixels or 10^4 times the input's size
/// before a pixel is read.
Texels decode_texels(std::span<const std::byte> bytes, const std::string& name);

/// A linear picture from EXR, HDR (or PNG and JPEG, whose sRGB is decoded): 3 or 4 channels by the file.
Image read_image(const std::filesystem::path& path);

/// EXR with the film's channels (R G B A, variance.R …, depth.Z, normal.X …, albedo.R …, emission.R …, object.id,
/// material.id, uv.U …) in float32 (ids uint32) and its metadata under "etalon:". Replaces the file at once.
void write_film(const Film& film, const std::filesystem::path& path);
Film read_film(const std::filesystem::path& path);

/// `display`: 3 or 4 channels of display-referred values in [0, 1], already transfer-coded (unassociated alpha).
/// PNG, 8 bit, rounded by floor(255 x + 1/2), with `metadata` as text chunks. Replaces the file at once.
void write_png(const Image& display, const std::map<std::string, std::string>& metadata, const std::filesystem::path& path);
/// The same as bytes, for standard output and HTML.
std::vector<std::byte> encode_png(const Image& display, const std::map<std::string, std::string>& metadata);

}  // namespace etalon
