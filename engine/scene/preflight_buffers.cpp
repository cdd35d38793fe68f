#include <fmt/format.h>

#include "engine/scene/preflight_parts.h"
#include "engine/scene/resources.h"

namespace etalon::document {

namespace {

std::vector<std::byte> read_resource(const json& uri, const LiftedText& text, const std::string& pointer,
                                     const std::filesystem::path& folder, std::size_t wanted, std::size_t limit)
{
    if (!uri.is_string()) throw fault(pointer, fmt::format("{} is no URI [TYPE_MISMATCH]", brief(uri)));
    try {
        return read_uri(text.uri(uri.get_ref<const std::string&>()), folder, limit, wanted);
    } catch (Error& error) {
        throw error.at(pointer);
    }
}

}  // namespace

std::vector<GltfBuffer> read_buffers(const json& document, const GltfParts& parts, const LiftedText& text,
                                     const std::filesystem::path& folder, const Limits& limits)
{
    std::vector<GltfBuffer> out;
    Unsigned read = 0;  // of all buffers: one file may be named many times
    for (const json& buffer : collection(document, "/buffers")) {
        const std::string pointer = fmt::format("/buffers/{}", out.size());
        GltfBuffer one{.owned = {}, .bytes = {}, .declared = unsigned_at(buffer, "byteLength", pointer)};
        const json* uri = member(buffer, "uri");
        const bool has_data = uri != nullptr || (out.empty() && parts.binary);
        if (uri != nullptr) {
            one.owned = read_resource(*uri, text, pointer + "/uri", folder, one.declared, limits.resource_bytes - read);
            read += one.owned.size();
            one.bytes = one.owned;
        } else if (has_data) {
            one.bytes = *parts.binary;
        }
        if (has_data && one.bytes.size() < one.declared)
            throw fault(pointer, fmt::format("buffer of {} bytes has only {} [BUFFER_BYTE_LENGTH_MISMATCH]",
                                             one.declared, one.bytes.size()));
        one.bytes = one.bytes.first(has_data ? one.declared : 0);
        out.push_back(std::move(one));
    }
    return out;
}

std::vector<View> read_views(const json& document, std::span<const GltfBuffer> buffers)
{
    std::vector<View> out;
    for (const json& view : collection(document, "/bufferViews")) {
        const std::string pointer = fmt::format("/bufferViews/{}", out.size());
        View one{.length = unsigned_at(view, "byteLength", pointer),
                 .stride = unsigned_at(view, "byteStride", pointer, 0),
                 .buffer = unsigned_at(view, "buffer", pointer),
                 .offset = unsigned_at(view, "byteOffset", pointer, 0)};
        const Unsigned have = buffers[one.buffer].declared;
        if (one.offset > have || one.length > have - one.offset)
            throw fault(pointer + (one.offset >= have ? "/byteOffset" : "/byteLength"),
                        fmt::format("{} bytes from byte {} do not fit in buffer {} of {} bytes [BUFFER_VIEW_TOO_LONG]",
                                    one.length, one.offset, one.buffer, have));
        if (view.contains("byteStride") && (one.stride < 4 || one.stride > 252 || one.stride % 4 != 0))
            throw fault(pointer + "/byteStride",
                        fmt::format("{}: a stride is a multiple of 4 from 4 to 252 [{}]", one.stride,
                                    one.stride % 4 != 0 ? "VALUE_MULTIPLE_OF" : "VALUE_NOT_IN_RANGE"));
        out.push_back(one);
    }
    return out;
}

std::span<const std::byte> bytes_of(const View& view, std::span<const GltfBuffer> buffers)
{
    const auto& data = buffers[view.buffer].bytes;
    return data.empty() ? data : data.subspan(view.offset, view.length);
}

std::vector<GltfImage> read_images(const json& document, const LiftedText& text, std::span<const View> views,
                                   std::span<const GltfBuffer> buffers)
{
    std::vector<GltfImage> out;
    for (const json& image : collection(document, "/images")) {
        const std::string pointer = fmt::format("/images/{}", out.size());
        GltfImage one;
        if (const json* name = member(image, "name"); name != nullptr && name->is_string()) one.name = *name;
        const json* view = member(image, "bufferView");
        const json* uri = member(image, "uri");
        if ((view == nullptr) == (uri == nullptr))
            throw fault(pointer, "an image has either a uri or a bufferView [ONE_OF_MISMATCH]");
        if (view != nullptr) {
            const View& from = views[view->get<Unsigned>()];
            if (from.length == 0) throw fault(pointer, fmt::format("bufferView {} is empty", view->get<Unsigned>()));
            one.bytes = bytes_of(from, buffers);  // without data: empty, and an error only for who needs it
        } else if (uri->is_string()) {
            one.uri = *uri;
            if (const std::string_view whole = text.uri(one.uri); whole != one.uri) one.long_uri = whole;
        } else {
            throw fault(pointer + "/uri", fmt::format("{} is no URI [TYPE_MISMATCH]", brief(*uri)));
        }
        if (one.name.empty()) one.name = one.bytes ? pointer : std::string(one.source().substr(0, 80));
        out.push_back(std::move(one));
    }
    return out;
}

}  // namespace etalon::document
