#include "engine/scene/gltf_accessor.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstring>

namespace etalon::gltf {

namespace {

constexpr std::size_t kMaxDecodedBytes = std::size_t{8} << 30;

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

// One component as a float (glTF 2.0 §3.11 for the normalized integers).
float component(std::span<const std::byte> bytes, std::size_t at, int type, bool normalized)
{
    switch (type) {
        case TINYGLTF_COMPONENT_TYPE_BYTE: {
            const float value = load<std::int8_t>(bytes, at);
            return normalized ? std::max(value / 127.0f, -1.0f) : value;
        }
        case TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE: {
            const float value = load<std::uint8_t>(bytes, at);
            return normalized ? value / 255.0f : value;
        }
        case TINYGLTF_COMPONENT_TYPE_SHORT: {
            const float value = load<std::int16_t>(bytes, at);
            return normalized ? std::max(value / 32767.0f, -1.0f) : value;
        }
        case TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT: {
            const float value = load<std::uint16_t>(bytes, at);
            return normalized ? value / 65535.0f : value;
        }
        case TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT:
            return static_cast<float>(load<std::uint32_t>(bytes, at));
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

Elements elements(const Source& source, int view_index, std::size_t offset, std::size_t packed)
{
    const auto& view = source.model.bufferViews.at(static_cast<std::size_t>(view_index));
    const auto& buffer = source.file.buffers.at(static_cast<std::size_t>(view.buffer)).bytes;
    if (buffer.size() < view.byteOffset + view.byteLength)
        throw fault(fmt::format("/bufferViews/{}", view_index),
                    fmt::format("buffer {} has no data in this file [BUFFER_MISSING_GLB_DATA]", view.buffer),
                    "export again; a buffer without uri needs the binary chunk of a .glb");
    return {buffer.subspan(view.byteOffset, view.byteLength).subspan(offset),
            view.byteStride == 0 ? packed : view.byteStride};
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

// Calls `put(element, bytes, at)` for the base elements, then for the sparse ones that replace some.
template <typename Function>
void for_each_element(const Source& source, const tinygltf::Accessor& accessor, std::size_t size,
                      const std::string& pointer, Function put)
{
    if (accessor.bufferView >= 0) {
        const Elements from = elements(source, accessor.bufferView, accessor.byteOffset, size);
        for (std::size_t i = 0; i < accessor.count; ++i) put(i, from.bytes, i * from.stride);
    }
    if (!accessor.sparse.isSparse) return;
    const std::vector<std::uint32_t> positions = sparse_positions(source, accessor, pointer);
    const auto& values = accessor.sparse.values;
    const Elements from = elements(source, values.bufferView, static_cast<std::size_t>(values.byteOffset), size);
    for (std::size_t i = 0; i < positions.size(); ++i) put(positions[i], from.bytes, i * size);
}

}  // namespace

void AccessorReader::spend(std::size_t bytes, const std::string& pointer)
{
    spent_ += bytes;
    if (spent_ > kMaxDecodedBytes)
        throw fault(pointer, fmt::format("the vertices of all primitives need over {} GiB", kMaxDecodedBytes >> 30),
                    "give each primitive its own part of the vertices, or split the file");
}

std::size_t AccessorReader::count(int accessor) const
{
    return source_.model.accessors.at(static_cast<std::size_t>(accessor)).count;
}

Floats AccessorReader::floats(int index, std::initializer_list<std::size_t> components, const std::string& pointer)
{
    const auto& accessor = source_.model.accessors.at(static_cast<std::size_t>(index));
    Floats out{.count = accessor.count, .components = components_of(accessor.type), .values = {}};
    if (std::find(components.begin(), components.end(), out.components) == components.end())
        throw fault(
            pointer,
            fmt::format("accessor {} has {} components an element [MESH_PRIMITIVE_ATTRIBUTES_ACCESSOR_INVALID_FORMAT]",
                        index, out.components));
    spend(out.count * out.components * sizeof(float), pointer);
    out.values.resize(out.count * out.components);
    const std::size_t size = size_of(accessor.componentType);
    const std::string where = fmt::format("/accessors/{}", index);
    for_each_element(source_, accessor, size * out.components, where,
                     [&](std::size_t i, std::span<const std::byte> bytes, std::size_t at) {
                         for (std::size_t c = 0; c < out.components; ++c)
                             out.values[i * out.components + c] =
                                 component(bytes, at + c * size, accessor.componentType, accessor.normalized);
                     });
    const auto bad =
        std::find_if(out.values.begin(), out.values.end(), [](float value) { return !std::isfinite(value); });
    if (bad != out.values.end())
        throw fault(pointer,
                    fmt::format("accessor {}, element {}: {} is not a finite number [ACCESSOR_INVALID_FLOAT]", index,
                                static_cast<std::size_t>(bad - out.values.begin()) / out.components, *bad));
    return out;
}

std::vector<std::uint32_t> AccessorReader::indices(int index, const std::string& pointer)
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
    spend(accessor.count * sizeof(std::uint32_t), pointer);
    std::vector<std::uint32_t> out(accessor.count);
    for_each_element(
        source_, accessor, size, fmt::format("/accessors/{}", index),
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
