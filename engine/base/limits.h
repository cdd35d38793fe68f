#pragma once
#include <cstdint>
#include <span>
#include <string_view>

namespace etalon {

/// `none` lifts every limit that only guards time and memory; those without which a reader would overrun its stack or
/// its integers stay.
enum class LimitLevel { none, standard, strict };
std::string_view name(LimitLevel level);

/// What input may ask for before it is told no. The values are those of limit_table(), which also says why; the page
/// docs/limits.md is made from it.
struct Limits {
    explicit Limits(LimitLevel level = LimitLevel::standard);

    std::uint64_t file_bytes;      ///< the scene's own file
    std::uint64_t resource_bytes;  ///< a buffer, or a coded image, in a file of its own or in a data URI
    std::uint64_t json_bytes;
    std::uint64_t json_depth;
    std::uint64_t json_values;
    std::uint64_t zero_filled_bytes;  ///< accessors without a bufferView, together
    std::uint64_t compressed_ratio;   ///< bytes that a Draco payload fills, for each of its own
    std::uint64_t decoded_bytes;      ///< that come out of compression extensions
    std::uint64_t vertex_bytes;       ///< attributes and indices of all primitives once imported
    std::uint64_t node_depth;
    std::uint64_t instances;      ///< of EXT_mesh_gpu_instancing, in the file
    std::uint64_t draws;          ///< primitives times their nodes and instances
    std::uint64_t posed_bytes;    ///< attributes and indices that skins and morph targets make at one instant
    std::uint64_t morph_targets;  ///< of one primitive
    std::uint64_t joints;         ///< of one skin
    std::uint64_t keyframes;      ///< of all animations
    std::uint64_t key_numbers;    ///< times and values of all keyframes once imported
    std::uint64_t image_side;     ///< pixels
    std::uint64_t image_pixels;
    std::uint64_t image_channels;
    std::uint64_t image_ratio;   ///< bytes of pixels for a byte of file
    std::uint64_t picture_side;  ///< pixels of a rendered picture
    std::uint64_t picture_pixels;
    /// Bytes that a run may need in all, predicted before they are asked for. Not of the table: by default and when
    /// strict three quarters of memory_of_machine(), and for LimitLevel::none the whole address space.
    std::uint64_t memory;
};

inline constexpr std::uint64_t kUnlimited = ~std::uint64_t{0};

/// One row of the table.
struct Limit {
    std::string_view name;    ///< "image-pixels"
    std::string_view bounds;  ///< what there may be at most so many of
    std::uint64_t Limits::*field;
    std::uint64_t standard;
    std::uint64_t strict;
    std::uint64_t none = kUnlimited;
    std::string_view unit;  ///< "bytes", "pixels", …
    std::string_view why;   ///< what it prevents, or where the value comes from
};
std::span<const Limit> limit_table();

}  // namespace etalon
