#pragma once
// Private to preflight: its checks, in the order in which they run. Each trusts those before it, and throws
// Error(input) with a JSON pointer.
#include <filesystem>
#include <span>
#include <vector>

#include "engine/scene/glb.h"
#include "engine/scene/preflight.h"
#include "engine/scene/preflight_document.h"

namespace etalon::document {

inline constexpr std::string_view kLights = "/extensions/KHR_lights_punctual/lights";

/// What must be arrays of objects is. preflight_references.cpp
void check_collections(const json& document);
/// Every index is one, of something that exists.
void check_references(const json& document);
/// Of each accessor: does anything name it? After check_references.
std::vector<bool> used_accessors(const json& document);

/// A bufferView within the declared length of its buffer.
struct View {
    Unsigned length = 0;
    Unsigned stride = 0;  ///< 0: packed
    Unsigned buffer = 0;
    Unsigned offset = 0;
    bool is_decoded = false;  ///< its bytes come out of a compression extension
};

/// Reads the buffers: those in the file, in data URIs, and beneath `folder`. preflight_buffers.cpp
std::vector<GltfBuffer> read_buffers(const json& document, const GltfParts& parts, const LiftedText& text,
                                     const std::filesystem::path& folder, const Limits& limits);
std::vector<View> read_views(const json& document, std::span<const GltfBuffer> buffers);
/// The bytes of the file that `view` shows; empty when its buffer has no data.
std::span<const std::byte> bytes_of(const View& view, std::span<const GltfBuffer> buffers);

/// Accessors of a type that glTF may gain later, which nothing here uses, become one zero: their bytes cannot be told.
/// Everything else that check_accessors refuses stays. preflight_accessors.cpp
void set_aside_unknown(json& document, std::vector<std::string>& warnings);
/// Accessors, sparse ones too, lie within their bufferViews; those without data are few. preflight_accessors.cpp
void check_accessors(const json& document, std::span<const View> views, std::span<const GltfBuffer> buffers,
                     const Limits& limits);
/// Buffers of which accessors want bytes that are not in this file, and come out of no extension: a warning each.
void warn_of_missing_data(const json& document, std::span<const View> views, std::span<const GltfBuffer> buffers,
                          std::vector<std::string>& warnings);

/// What the headers of compressed payloads claim is what the document says, and not more than such a payload can hold.
/// Marks the views whose bytes they give. preflight_compressed.cpp
void check_compressed_views(const json& document, std::vector<View>& views, std::span<const GltfBuffer> buffers);
/// Of each accessor: do its values come out of a Draco payload?
std::vector<bool> check_compressed_meshes(const json& document, std::span<const View> views,
                                          std::span<const GltfBuffer> buffers, const Limits& limits);

std::vector<GltfImage> read_images(const json& document, const LiftedText& text, std::span<const View> views,
                                   std::span<const GltfBuffer> buffers);

}  // namespace etalon::document
