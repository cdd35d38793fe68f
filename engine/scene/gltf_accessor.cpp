#include "engine/scene/gltf_accessor.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstring>

namespace etalon::gltf {

namespace {

std::size_t components_of(int type)
{
    const int count = tinygltf::GetNumComponentsInType(static_cast<std::uint32_t>(type));
    assume(count > 0);
    return static_cast<std::size_t>(count);
}

std::size_t size_of(int component_type)
{
    const int size = tinygltf::GetComponentSizeInBytes(static_cast<std::uint32_t>(component_type));
    assume(size > 0);
    return static_cast<std::size_t>(size);
}

template <typename T>
T load(std::span<const std::byte> bytes, std::size_t at)
{
    assume(at + sizeof(T) <= bytes.size());
    T value;
    std::memcpy(&value, bytes.data() + at,
                sizeof value);  // glTF is little-endian, and so are we; offsets need not be aligned
    return value;
}

// One component as a number (glTF 2.0 §3.11 for the normalized integers).
template <typename T>
T component(std::span<const std::byte> bytes, std::size_t at, int type, bool normalized)
{
    switch (type) {
        case TINYGLTF_COMPONENT_TYPE_BYTE: {
            const T value = load<std::int8_t>(bytes, at);
            return normalized ? std::max(value / 127, T(-1)) : value;
        }
        case TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE: {
            const T value = load<std::uint8_t>(bytes, at);
            return normalized ? value / 255 : value;
        }
        case TINYGLTF_COMPONENT_TYPE_SHORT: {
            const T value = load<std::int16_t>(bytes, at);
            return normalized ? std::max(value / 32767, T(-1)) : value;
        }
        case TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT: {
            const T value = load<std::uint16_t>(bytes, at);
            return normalized ? value / 65535 : value;
        }
        case TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT:
            return static_cast<T>(load<std::uint32_t>(bytes, at));
        case TINYGLTF_COMPONENT_TYPE_DOUBLE:
            return static_cast<T>(load<double>(bytes, at));
        default:
            return load<float>(bytes, at);
    }
}

std::uint32_t whole(std::span<const std::byte> bytes, std::size_t at, int type)
{
    switch (type) {
        case TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE:
            return load<std::uint8_t>(bytes, at);
        case TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT:
            return load<std::uint16_t>(bytes, at);
        default:
            return load<std::uint32_t>(bytes, at);
    }
}

// Where the elements of an accessor, or of one part of a sparse one, lie.
struct Elements {
    std::span<const std::byte> bytes;  // from the first element on
    std::size_t stride = 0;
};

// Without a bufferView accessors are zero (glTF 2.0 §3.6.2.1), and so they are here where its buffer has no data:
// preflight has warned of it.
bool has_data(const Source& source, int view_index)
{
    if (view_index < 0) return false;
    if (source.decoded.views.contains(static_cast<std::size_t>(view_index))) return true;
    const auto& view = source.model.bufferViews.at(static_cast<std::size_t>(view_index));
    return !source.file.buffers.at(static_cast<std::size_t>(view.buffer)).bytes.empty();
}

Elements elements(const Source& source, int view_index, std::size_t offset, std::size_t packed)
{
    const auto& view = source.model.bufferViews.at(static_cast<std::size_t>(view_index));
    const std::size_t stride = view.byteStride == 0 ? packed : view.byteStride;
    if (const auto decoded = source.decoded.views.find(static_cast<std::size_t>(view_index));
        decoded != source.decoded.views.end())
        return {std::span(decoded->second).subspan(offset), stride};
    const auto& buffer = source.file.buffers.at(static_cast<std::size_t>(view.buffer)).bytes;
    if (buffer.size() < view.byteOffset + view.byteLength)
        throw fault(fmt::format("/bufferViews/{}", view_index),
                    fmt::format("buffer {} has no data in this file [BUFFER_MISSING_GLB_DATA]", view.buffer),
                    "export again; a buffer without uri needs the binary chunk of a .glb");
    return {buffer.subspan(view.byteOffset, view.byteLength).subspan(offset), stride};
}

// The positions of a sparse accessor's own elements: increasing, below `count`.
std::vector<std::uint32_t> sparse_positions(const Source& source, const tinygltf::Accessor& accessor,
                                            const std::string& pointer)
{
    const auto& sparse = accessor.sparse;
    const std::size_t size = size_of(sparse.indices.componentType);
    const Elements from =
        elements(source, sparse.indices.bufferView, static_cast<std::size_t>(sparse.indices.byteOffset), size);
    std::vector<std::uint32_t> out;
    for (std::size_t i = 0; i < static_cast<std::size_t>(sparse.count); ++i) {
        const std::uint32_t at = whole(from.bytes, i * size, sparse.indices.componentType);
        if (at >= accessor.count)
            throw fault(pointer + "/sparse/indices",
                        fmt::format("element {} is {}, of {} [ACCESSOR_SPARSE_INDEX_OOB]", i, at, accessor.count));
        if (!out.empty() && at <= out.back())
            throw fault(
                pointer + "/sparse/indices",
                fmt::format("element {} is {} after {} [ACCESSOR_SPARSE_INDICES_NON_INCREASING]", i, at, out.back()));
        out.push_back(at);
    }
    return out;
}

// Calls `put(place, bytes, at)` for each element of `subset`, numbered by its place there: first the base elements,
// then the sparse ones that replace some.
template <typename Function>
void for_each_element(const Source& source, const tinygltf::Accessor& accessor, std::size_t size,
                      const std::string& pointer, const Subset& subset, Function put)
{
    const std::size_t count = subset ? subset->size() : accessor.count;
    const auto index = static_cast<std::size_t>(&accessor - source.model.accessors.data());
    const auto decoded = source.decoded.accessors.find(index);
    if (decoded != source.decoded.accessors.end() || has_data(source, accessor.bufferView)) {
        const Elements from = decoded != source.decoded.accessors.end()
                                  ? Elements{decoded->second, size}
                                  : elements(source, accessor.bufferView, accessor.byteOffset, size);
        for (std::size_t i = 0; i < count; ++i) put(i, from.bytes, (subset ? (*subset)[i] : i) * from.stride);
    }
    if (!accessor.sparse.isSparse) return;
    const std::vector<std::uint32_t> positions = sparse_positions(source, accessor, pointer);
    const auto& values = accessor.sparse.values;
    const Elements from = elements(source, values.bufferView, static_cast<std::size_t>(values.byteOffset), size);
    for (std::size_t i = 0; i < positions.size(); ++i) {
        std::size_t place = positions[i];
        if (subset) {
            const auto found = std::lower_bound(subset->begin(), subset->end(), positions[i]);
            if (found == subset->end() || *found != positions[i]) continue;
            place = static_cast<std::size_t>(found - subset->begin());
        }
        put(place, from.bytes, i * size);
    }
}

}  // namespace

std::size_t AccessorReader::count(int accessor) const
{
    return source_.model.accessors.at(static_cast<std::size_t>(accessor)).count;
}

template <typename T>
Numbers<T> AccessorReader::read(int index, std::initializer_list<std::size_t> components, const std::string& pointer,
                                const Subset& subset) const
{
    const auto& accessor = source_.model.accessors.at(static_cast<std::size_t>(index));
    Numbers<T> out{
        .count = subset ? subset->size() : accessor.count, .components = components_of(accessor.type), .values = {}};
    if (std::find(components.begin(), components.end(), out.components) == components.end())
        throw fault(
            pointer,
            fmt::format("accessor {} has {} components an element [MESH_PRIMITIVE_ATTRIBUTES_ACCESSOR_INVALID_FORMAT]",
                        index, out.components));
    out.values.resize(out.count * out.components);
    const std::size_t size = size_of(accessor.componentType);
    const std::string where = fmt::format("/accessors/{}", index);
    const bool as_stored =
        accessor.componentType == (sizeof(T) == 4 ? TINYGLTF_COMPONENT_TYPE_FLOAT : TINYGLTF_COMPONENT_TYPE_DOUBLE);
    for_each_element(source_, accessor, size * out.components, where, subset,
                     [&](std::size_t i, std::span<const std::byte> bytes, std::size_t at) {
                         if (as_stored) {
                             assume(at + size * out.components <= bytes.size());
                             std::memcpy(&out.values[i * out.components], bytes.data() + at, size * out.components);
                             return;
                         }
                         for (std::size_t c = 0; c < out.components; ++c)
                             out.values[i * out.components + c] =
                                 component<T>(bytes, at + c * size, accessor.componentType, accessor.normalized);
                     });
    const auto bad = std::find_if(out.values.begin(), out.values.end(), [](T value) { return !std::isfinite(value); });
    if (bad != out.values.end()) {
        const std::size_t place = static_cast<std::size_t>(bad - out.values.begin()) / out.components;
        throw fault(pointer, fmt::format("accessor {}, element {}: {} is not a finite number [ACCESSOR_INVALID_FLOAT]",
                                         index, subset ? (*subset)[place] : place, *bad));
    }
    return out;
}

Floats AccessorReader::floats(int accessor, std::initializer_list<std::size_t> components, const std::string& pointer,
                              const Subset& subset) const
{
    return read<float>(accessor, components, pointer, subset);
}

Doubles AccessorReader::doubles(int accessor, std::initializer_list<std::size_t> components,
                                const std::string& pointer) const
{
    return read<double>(accessor, components, pointer, std::nullopt);
}

std::vector<std::uint32_t> AccessorReader::joints(int index, const std::string& pointer, const Subset& subset) const
{
    const auto& accessor = source_.model.accessors.at(static_cast<std::size_t>(index));
    const int type = accessor.componentType;
    if (accessor.type != TINYGLTF_TYPE_VEC4 ||
        (type != TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE && type != TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT))
        throw fault(pointer, fmt::format("accessor {} holds no four unsigned integers of 8 or 16 bits "
                                         "[MESH_PRIMITIVE_ATTRIBUTES_ACCESSOR_INVALID_FORMAT]",
                                         index));
    const std::size_t size = size_of(type);
    std::vector<std::uint32_t> out(4 * (subset ? subset->size() : accessor.count));
    for_each_element(source_, accessor, 4 * size, fmt::format("/accessors/{}", index), subset,
                     [&](std::size_t i, std::span<const std::byte> bytes, std::size_t at) {
                         for (std::size_t c = 0; c < 4; ++c) out[4 * i + c] = whole(bytes, at + c * size, type);
                     });
    return out;
}

std::vector<std::uint32_t> AccessorReader::indices(int index, const std::string& pointer) const
{
    const auto& accessor = source_.model.accessors.at(static_cast<std::size_t>(index));
    const int type = accessor.componentType;
    const bool is_unsigned = type == TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE ||
                             type == TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT ||
                             type == TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT;
    if (accessor.type != TINYGLTF_TYPE_SCALAR || !is_unsigned)
        throw fault(
            pointer,
            fmt::format("accessor {} holds no unsigned scalars [MESH_PRIMITIVE_INDICES_ACCESSOR_INVALID_FORMAT]",
                        index));
    const std::size_t size = size_of(type);
    const std::uint32_t restart = size == 1 ? 0xffu : size == 2 ? 0xffffu : 0xffffffffu;
    std::vector<std::uint32_t> out(accessor.count);
    for_each_element(
        source_, accessor, size, fmt::format("/accessors/{}", index), std::nullopt,
        [&](std::size_t i, std::span<const std::byte> bytes, std::size_t at) { out[i] = whole(bytes, at, type); });
    const auto bad = std::find(out.begin(), out.end(), restart);
    if (bad != out.end())
        throw fault(
            pointer,
            fmt::format("index {} is {}, the restart value, which glTF forbids [ACCESSOR_INDEX_PRIMITIVE_RESTART]",
                        bad - out.begin(), restart));
    return out;
}

}  // namespace etalon::gltf
