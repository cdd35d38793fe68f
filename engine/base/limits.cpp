#include "engine/base/limits.h"

#include <array>

#include "engine/base/memory.h"

namespace etalon {
namespace {

constexpr std::uint64_t kMiB = std::uint64_t{1} << 20;
constexpr std::uint64_t kGiB = std::uint64_t{1} << 30;

constexpr std::array kTable = {
    Limit{.name = "file-bytes",
          .bounds = "the scene's file",
          .field = &Limits::file_bytes,
          .standard = 4 * kGiB,
          .strict = 256 * kMiB,
          .unit = "bytes",
          .why = "GLB counts its bytes in 32 bits"},
    Limit{.name = "resource-bytes",
          .bounds = "one buffer or coded image beside the scene's file, or in a data URI",
          .field = &Limits::resource_bytes,
          .standard = 4 * kGiB,
          .strict = 256 * kMiB,
          .unit = "bytes",
          .why = "a sparse file of terabytes costs nothing to make"},
    Limit{.name = "json-bytes",
          .bounds = "the JSON of a scene, data URIs included",
          .field = &Limits::json_bytes,
          .standard = kGiB,
          .strict = 64 * kMiB,
          .unit = "bytes",
          .why = "a parsed document is several times its text"},
    Limit{.name = "json-depth",
          .bounds = "objects and arrays inside one another",
          .field = &Limits::json_depth,
          .standard = 256,
          .strict = 64,
          .none = 256,
          .unit = "levels",
          .why = "readers recurse: one dies of 15,900 levels on a stack of 8 MiB"},
    Limit{.name = "json-values",
          .bounds = "numbers, strings, objects and arrays of a scene's JSON",
          .field = &Limits::json_values,
          .standard = 10'000'000,
          .strict = 1'000'000,
          .unit = "values",
          .why = "an empty array is two bytes of text and some hundred parsed"},
    Limit{.name = "zero-filled-bytes",
          .bounds = "accessors without a bufferView, together",
          .field = &Limits::zero_filled_bytes,
          .standard = 256 * kMiB,
          .strict = 64 * kMiB,
          .unit = "bytes",
          .why = "they cost the file nothing, whatever their count"},
    Limit{.name = "compressed-ratio",
          .bounds = "bytes of vertices and indices for each byte of a Draco payload, where it fills more than 64 MiB",
          .field = &Limits::compressed_ratio,
          .standard = 1'000,
          .strict = 1'000,
          .unit = "",
          .why = "47 bytes of Draco can ask for 5.4 GB"},
    Limit{.name = "decoded-bytes",
          .bounds = "what comes out of Draco and meshopt payloads",
          .field = &Limits::decoded_bytes,
          .standard = 8 * kGiB,
          .strict = 512 * kMiB,
          .unit = "bytes",
          .why = "many primitives may share one payload, and each is decoded"},
    Limit{.name = "vertex-bytes",
          .bounds = "attributes and indices of all primitives once imported",
          .field = &Limits::vertex_bytes,
          .standard = 8 * kGiB,
          .strict = 512 * kMiB,
          .unit = "bytes",
          .why = "many primitives may share one accessor, and each gets its own copy"},
    Limit{.name = "node-depth",
          .bounds = "nodes from a root to a leaf",
          .field = &Limits::node_depth,
          .standard = 10'000'000,
          .strict = 10'000,
          .unit = "nodes",
          .why = "walks are iterative, so that depth costs time alone"},
    Limit{.name = "instances",
          .bounds = "instances of EXT_mesh_gpu_instancing in a file",
          .field = &Limits::instances,
          .standard = 10'000'000,
          .strict = 1'000'000,
          .unit = "instances",
          .why = "a matrix in double takes 128 bytes"},
    Limit{.name = "draws",
          .bounds = "primitives times the nodes and instances that show them",
          .field = &Limits::draws,
          .standard = 10'000'000,
          .strict = 10'000'000,
          .none = 10'000'000,
          .unit = "draws",
          .why = "a few kilobytes of nodes can show one mesh a billion times"},
    Limit{.name = "posed-bytes",
          .bounds = "attributes and indices that skins and morph targets make at one instant",
          .field = &Limits::posed_bytes,
          .standard = 8 * kGiB,
          .strict = 512 * kMiB,
          .unit = "bytes",
          .why = "many nodes may show one mesh, and each may shape it otherwise"},
    Limit{.name = "morph-targets",
          .bounds = "morph targets of one primitive",
          .field = &Limits::morph_targets,
          .standard = 65'536,
          .strict = 1'024,
          .unit = "targets",
          .why = "each may hold as much as the mesh itself, from one shared accessor"},
    Limit{.name = "joints",
          .bounds = "joints of one skin",
          .field = &Limits::joints,
          .standard = 65'536,
          .strict = 4'096,
          .unit = "joints",
          .why = "JOINTS_n is of at most 16 bits: more cannot be named"},
    Limit{.name = "keyframes",
          .bounds = "keyframes of all animations",
          .field = &Limits::keyframes,
          .standard = 50'000'000,
          .strict = 1'000'000,
          .unit = "keyframes",
          .why = "many channels may share one accessor"},
    Limit{.name = "key-numbers",
          .bounds = "times and values of all keyframes once imported",
          .field = &Limits::key_numbers,
          .standard = 400'000'000,
          .strict = 10'000'000,
          .unit = "numbers",
          .why = "many samplers may share one accessor, and each gets its own copy in double"},
    Limit{.name = "image-side",
          .bounds = "width and height of an image that is read",
          .field = &Limits::image_side,
          .standard = 32'768,
          .strict = 16'384,
          .none = 1'048'576,
          .unit = "pixels",
          .why = "no device of today takes larger ones; readers count in 32 bits"},
    Limit{.name = "image-pixels",
          .bounds = "pixels of an image that is read",
          .field = &Limits::image_pixels,
          .standard = std::uint64_t{1} << 28,
          .strict = std::uint64_t{1} << 26,
          .none = std::uint64_t{1} << 31,
          .unit = "pixels",
          .why = "a PNG of 4 MB that claims 65,000 x 65,000 pixels takes its reader to 12 GB"},
    Limit{.name = "image-channels",
          .bounds = "channels of an image that is read",
          .field = &Limits::image_channels,
          .standard = 64,
          .strict = 64,
          .none = 1'024,
          .unit = "channels",
          .why = "a film with all its layers has 27"},
    Limit{.name = "image-ratio",
          .bounds = "bytes of pixels for each byte of an image's file, where it claims more than 64 MiB",
          .field = &Limits::image_ratio,
          .standard = 10'000,
          .strict = 1'100,
          .unit = "",
          .why = "deflate reaches 1,032 at most; WebP and ZIP-compressed EXR of one colour somewhat more"},
    Limit{.name = "picture-side",
          .bounds = "width and height of a rendered picture",
          .field = &Limits::picture_side,
          .standard = 32'768,
          .strict = 8'192,
          .none = 32'768,
          .unit = "pixels",
          .why = "with it pixels are numbered in 31 bits"},
    Limit{.name = "picture-pixels",
          .bounds = "pixels of a rendered picture",
          .field = &Limits::picture_pixels,
          .standard = std::uint64_t{1} << 30,
          .strict = std::uint64_t{1} << 25,
          .none = std::uint64_t{1} << 30,
          .unit = "pixels",
          .why = "a film takes 40 bytes a pixel and more: the memory limit is usually met first"},
};

}  // namespace

std::string_view name(LimitLevel level)
{
    switch (level) {
        case LimitLevel::none:
            return "none";
        case LimitLevel::standard:
            return "standard";
        case LimitLevel::strict:
            return "strict";
    }
    return {};
}

std::span<const Limit> limit_table()
{
    return kTable;
}

Limits::Limits(LimitLevel level) : memory(level == LimitLevel::none ? kUnlimited : memory_of_machine() / 4 * 3)
{
    for (const Limit& row : kTable)
        this->*row.field = level == LimitLevel::none     ? row.none
                           : level == LimitLevel::strict ? row.strict
                                                         : row.standard;
}

}  // namespace etalon
