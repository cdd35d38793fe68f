#pragma once
#include <cstddef>
#include <filesystem>
#include <map>
#include <span>
#include <string>
#include <vector>

#include "engine/base/limits.h"
#include "engine/image/film.h"
#include "engine/image/image.h"

namespace etalon {

/// Decodes PNG, JPEG or WebP (8 or 16 bit a channel) from memory into RGBA texels; grey is spread, missing alpha is 1,
/// and colour is not multiplied by alpha. The reader is chosen by magic bytes. `name` goes into errors. Before a pixel
/// is read it refuses what its header claims over `limits` (image_side, image_pixels, image_channels, image_ratio).
/// Throws Error(input), also for a file that ends early; Error(machine) when memory runs out.
Texels decode_texels(std::span<const std::byte> bytes, const std::string& name, const Limits& limits = Limits());

/// A linear picture from EXR or HDR (or PNG, JPEG and WebP, whose sRGB is decoded to linear): 4 channels where the file
/// has alpha, else 3. Alpha is as the file has it: premultiplied in EXR, not in the others. NaN and Inf are kept. Same
/// limits (and resource_bytes) and errors as decode_texels. An EXR must be flat, its data window its display window.
Image read_image(const std::filesystem::path& path, const Limits& limits = Limits());

/// Replaces texels that are not finite before anything filters them, value by value: NaN and -Inf by 0, +Inf by the
/// largest finite value of the picture. How many texels had one (T14).
std::size_t replace_nonfinite(Image& image);

/// What a picture is written as, by the extension of its file.
enum class PictureFormat { exr, png };
/// Throws Error(input) naming the extensions there are. Ask before rendering, not after.
PictureFormat picture_format(const std::filesystem::path& path);

/// EXR with the film's channels (R G B A, variance.R …, depth.Z, normal.X …, albedo.R …, emission.R …, object.id,
/// material.id, uv.U …) in float32 (ids uint32) and its metadata under "etalon:", as are samples, nonfinite and
/// truncated (which the metadata must not name). Replaces the file at once. read_film gives back every bit, NaN
/// included. Throws Error(input) where `path` is no .exr or cannot be written.
void write_film(const Film& film, const std::filesystem::path& path);
/// Any EXR with R, G and B is a film; what it lacks stays empty (alpha: 1).
Film read_film(const std::filesystem::path& path, const Limits& limits = Limits());

/// `display`: 3 or 4 channels of display-referred values in [0, 1], already transfer-coded (unassociated alpha).
/// PNG, 8 bit, rounded by floor(255 x + 1/2) (below 0 and NaN: 0; above 1: 255), with `metadata` as text chunks. The
/// same picture gives the same bytes: there is no time stamp. Replaces the file at once.
void write_png(const Image& display, const std::map<std::string, std::string>& metadata,
               const std::filesystem::path& path);
/// The same as bytes, for standard output and HTML.
std::vector<std::byte> encode_png(const Image& display, const std::map<std::string, std::string>& metadata);

}  // namespace etalon
