#include <fmt/format.h>

#include <algorithm>

#include "engine/scene/preflight_parts.h"

namespace etalon::document {

namespace {

Unsigned saturating_product(Unsigned a, Unsigned b)
{
    Unsigned out = 0;
    return __builtin_mul_overflow(a, b, &out) ? ~Unsigned{0} : out;
}

// Bytes of one component, or 0 for a type that glTF does not know.
Unsigned component_size(Unsigned type, bool has_doubles = false)
{
    switch (type) {
        case 5120:
        case 5121:
            return 1;
        case 5122:
        case 5123:
            return 2;
        case 5125:
        case 5126:
            return 4;
        case 5130:
            return has_doubles ? 8 : 0;
        default:
            return 0;
    }
}

// Columns of small matrices begin at multiples of four bytes.
Unsigned element_size(const std::string& type, Unsigned component)
{
    if (type == "SCALAR") return component;
    if (type == "VEC2") return 2 * component;
    if (type == "VEC3") return 3 * component;
    if (type == "VEC4") return 4 * component;
    const auto padded = [](Unsigned bytes) { return (bytes + 3) / 4 * 4; };
    if (type == "MAT2") return padded(2 * component) + 2 * component;
    if (type == "MAT3") return 2 * padded(3 * component) + 3 * component;
    if (type == "MAT4") return 16 * component;
    return 0;
}

struct Elements {
    Unsigned view = 0;
    Unsigned offset = 0;
    Unsigned count = 0;  // at least 1
    Unsigned size = 0;   // bytes of one
    Unsigned stride = 0;
};

void check_room(const std::string& pointer, const Elements& elements, std::span<const View> views)
{
    const View& view = views[elements.view];
    Unsigned end = 0;
    if (__builtin_mul_overflow(elements.count - 1, elements.stride, &end) ||
        __builtin_add_overflow(end, elements.size, &end) || __builtin_add_overflow(end, elements.offset, &end) ||
        end > view.length)
        throw fault(
            pointer,
            fmt::format("{} elements of {} bytes from byte {}, stride {}, do not fit in bufferView {} of {} bytes "
                        "[ACCESSOR_TOO_LONG]",
                        elements.count, elements.size, elements.offset, elements.stride, elements.view, view.length));
}

const json& part_of(const json& sparse, const char* key, const std::string& pointer)
{
    const json* part = member(sparse, key);
    if (part == nullptr || member(*part, "bufferView") == nullptr)
        throw fault(pointer, fmt::format("{} is missing [UNDEFINED_PROPERTY]", key));
    return *part;
}

void check_sparse(const json& sparse, const std::string& pointer, Unsigned base_count, Unsigned size,
                  std::span<const View> views)
{
    const json& indices = part_of(sparse, "indices", pointer);
    const json& values = part_of(sparse, "values", pointer);
    const Unsigned count = unsigned_at(sparse, "count", pointer);
    if (count == 0 || count > base_count)
        throw fault(pointer + "/count",
                    fmt::format("{} of {} elements [ACCESSOR_SPARSE_COUNT_OUT_OF_RANGE]", count, base_count));
    const Unsigned type = unsigned_at(indices, "componentType", pointer + "/indices");
    if (type != 5121 && type != 5123 && type != 5125)
        throw fault(pointer + "/indices/componentType", fmt::format("{} [VALUE_NOT_IN_LIST]", type));
    const Unsigned index_size = component_size(type);
    check_room(pointer + "/indices",
               {.view = indices["bufferView"].get<Unsigned>(),
                .offset = unsigned_at(indices, "byteOffset", pointer + "/indices", 0),
                .count = count,
                .size = index_size,
                .stride = index_size},
               views);
    check_room(pointer + "/values",
               {.view = values["bufferView"].get<Unsigned>(),
                .offset = unsigned_at(values, "byteOffset", pointer + "/values", 0),
                .count = count,
                .size = size,
                .stride = size},
               views);
}

bool uses_extension(const json& document, std::string_view name)
{
    const json* used = member(document, "extensionsUsed");
    return used != nullptr && used->is_array() && std::find(used->begin(), used->end(), name) != used->end();
}

// Elements for which the file holds no data, so that their number costs it nothing.
class DatalessElements {
 public:
    explicit DatalessElements(const Limits& limits) : limit_(limits.zero_filled_bytes) {}
    void add(Unsigned count, Unsigned size, const std::string& pointer)
    {
        if (__builtin_add_overflow(sum_, saturating_product(count, size), &sum_) || sum_ > limit_)
            throw fault(pointer + "/count",
                        fmt::format("{} elements without data: the limit is {} bytes in all", count, limit_));
    }

 private:
    Unsigned limit_;
    Unsigned sum_ = 0;
};

}  // namespace

void set_aside_unknown(json& document, std::vector<std::string>& warnings)
{
    if (!document.contains("accessors")) return;
    const std::vector<bool> used = used_accessors(document);
    json& accessors = document["accessors"];
    for (std::size_t i = 0; i < accessors.size(); ++i) {
        const json* type = member(accessors[i], "type");
        if (used[i] || type == nullptr || !type->is_string() ||
            element_size(type->get_ref<const std::string&>(), 1) > 0)
            continue;
        warnings.push_back(
            fmt::format("/accessors/{}/type: {} is not known [VALUE_NOT_IN_LIST]: nothing uses it, and "
                        "it is ignored",
                        i, brief(*type)));
        accessors[i] = {{"componentType", Unsigned{5126}}, {"type", "SCALAR"}, {"count", Unsigned{1}}};
    }
}

void warn_of_missing_data(const json& document, std::span<const View> views, std::span<const GltfBuffer> buffers,
                          std::vector<std::string>& warnings)
{
    std::vector<bool> wanted(buffers.size());
    for_each(document, "/accessors/*/bufferView", [&](const json& index, const Place&) {
        const View& view = views[index.get<Unsigned>()];
        if (buffers[view.buffer].bytes.empty() && !view.is_decoded) wanted[view.buffer] = true;
    });
    for (std::size_t i = 0; i < wanted.size(); ++i)
        if (wanted[i])
            warnings.push_back(
                fmt::format("/buffers/{}: has no data in this file [BUFFER_MISSING_GLB_DATA]: what "
                            "accessors read of it is zero",
                            i));
}

void check_accessors(const json& document, std::span<const View> views, std::span<const GltfBuffer> buffers,
                     const Limits& limits)
{
    const std::vector<bool> is_decoded = check_compressed_meshes(document, views, buffers, limits);
    const bool has_doubles = uses_extension(document, "KHR_accessor_float64");
    DatalessElements dataless(limits);
    std::size_t i = 0;
    for (const json& accessor : collection(document, "/accessors")) {
        const bool has_values = is_decoded[i];
        const std::string pointer = fmt::format("/accessors/{}", i++);
        const Unsigned component_type = unsigned_at(accessor, "componentType", pointer);
        const json* type = member(accessor, "type");
        if (type == nullptr || !type->is_string()) throw fault(pointer, "type is missing [UNDEFINED_PROPERTY]");
        const Unsigned size =
            element_size(type->get_ref<const std::string&>(), component_size(component_type, has_doubles));
        if (size == 0)
            throw fault(pointer, fmt::format("type {} of component type {} does not exist [VALUE_NOT_IN_LIST]",
                                             brief(*type), component_type));
        const Unsigned count = unsigned_at(accessor, "count", pointer);
        if (count == 0) throw fault(pointer + "/count", "0: an accessor has at least one element [VALUE_NOT_IN_RANGE]");
        const Unsigned offset = unsigned_at(accessor, "byteOffset", pointer, 0);
        if (const json* index = member(accessor, "bufferView")) {
            const View& view = views[index->get<Unsigned>()];
            const Unsigned stride = view.stride == 0 ? size : view.stride;
            if (stride < size)
                throw fault(pointer, fmt::format("elements of {} bytes do not fit in stride {} of bufferView {} "
                                                 "[ACCESSOR_SMALL_BYTESTRIDE]",
                                                 size, stride, index->get<Unsigned>()));
            check_room(
                pointer,
                {.view = index->get<Unsigned>(), .offset = offset, .count = count, .size = size, .stride = stride},
                views);
            if (buffers[view.buffer].bytes.empty() && !view.is_decoded) dataless.add(count, size, pointer);
        } else if (!has_values) {
            dataless.add(count, size, pointer);
        }
        if (const json* sparse = member(accessor, "sparse"))
            check_sparse(*sparse, pointer + "/sparse", count, size, views);
    }
}

}  // namespace etalon::document
