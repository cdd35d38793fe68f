#include <fmt/format.h>

#include <array>

#include "engine/scene/compressed_header.h"
#include "engine/scene/preflight_parts.h"

namespace etalon::document {

namespace {

constexpr Unsigned kHarmlessBytes = Unsigned{64} << 20;  // claimed in all by any payload, however short

Unsigned capped_product(Unsigned a, Unsigned b)
{
    Unsigned out = 0;
    return __builtin_mul_overflow(a, b, &out) ? ~Unsigned{0} : out;
}

// The choice `key` of `object` among `names`; the first when absent and `is_optional`.
template <std::size_t N>
std::size_t choice(const json& object, std::string_view key, const std::string& pointer,
                   const std::array<std::string_view, N>& names, bool is_optional)
{
    const json* found = member(object, key);
    if (found == nullptr && is_optional) return 0;
    if (found == nullptr) throw fault(pointer, fmt::format("{} is missing [UNDEFINED_PROPERTY]", key));
    for (std::size_t i = 0; i < N; ++i)
        if (*found == names[i]) return i;
    throw fault(fmt::format("{}/{}", pointer, key), fmt::format("{} is not known [VALUE_NOT_IN_LIST]", brief(*found)));
}

void check_meshopt_layout(MeshoptMode mode, std::size_t filter, Unsigned count, Unsigned stride,
                          const std::string& pointer)
{
    const bool is_attributes = mode == MeshoptMode::attributes;
    const bool fits = is_attributes ? stride % 4 == 0 && stride >= 4 && stride <= 256 : stride == 2 || stride == 4;
    if (!fits)
        throw fault(pointer + "/byteStride", fmt::format("{} does not go with this mode [VALUE_NOT_IN_LIST]", stride));
    if (mode == MeshoptMode::triangles && count % 3 != 0)
        throw fault(pointer + "/count", fmt::format("{} corners are no triangles [VALUE_MULTIPLE_OF]", count));
    const std::array<bool, 5> filter_fits = {true, stride == 4 || stride == 8, stride == 8, true,
                                             stride == 4 || stride == 8};
    if (!filter_fits[filter] || (filter != 0 && !is_attributes))
        throw fault(pointer + "/filter", "does not go with this mode and stride [VALUE_NOT_IN_LIST]");
}

void check_meshopt_view(const json& extension, const std::string& pointer, const View& decoded,
                        std::span<const GltfBuffer> buffers)
{
    constexpr std::array<std::string_view, 3> kModes = {"ATTRIBUTES", "TRIANGLES", "INDICES"};
    constexpr std::array<std::string_view, 5> kFilters = {"NONE", "OCTAHEDRAL", "QUATERNION", "EXPONENTIAL", "COLOR"};
    const auto mode = static_cast<MeshoptMode>(choice(extension, "mode", pointer, kModes, false));
    const std::size_t filter = choice(extension, "filter", pointer, kFilters, true);
    const Unsigned count = unsigned_at(extension, "count", pointer);
    const Unsigned stride = unsigned_at(extension, "byteStride", pointer);
    const View coded{.length = unsigned_at(extension, "byteLength", pointer),
                     .stride = 0,
                     .buffer = unsigned_at(extension, "buffer", pointer),
                     .offset = unsigned_at(extension, "byteOffset", pointer, 0)};
    check_meshopt_layout(mode, filter, count, stride, pointer);
    if (capped_product(count, stride) != decoded.length)
        throw fault(pointer + "/count",
                    fmt::format("{} elements of {} bytes in a bufferView of {} [VALUE_NOT_IN_RANGE]", count, stride,
                                decoded.length));
    const Unsigned have = buffers[coded.buffer].declared;
    if (coded.offset > have || coded.length > have - coded.offset)
        throw fault(pointer,
                    fmt::format("{} bytes from byte {} do not fit in buffer {} of {} bytes [BUFFER_VIEW_TOO_LONG]",
                                coded.length, coded.offset, coded.buffer, have));
    if (buffers[coded.buffer].bytes.empty())
        throw fault(pointer + "/buffer", "has no data in this file [BUFFER_MISSING_GLB_DATA]");
    try {
        check_meshopt_payload(bytes_of(coded, buffers), mode, count, stride);
    } catch (Error& error) {
        throw error.at(pointer);
    }
}

// The accessors of a primitive that its Draco payload fills.
std::vector<std::size_t> filled_attributes(const json& primitive, const json& extension, const std::string& pointer)
{
    std::vector<std::size_t> out;
    const json* own = member(primitive, "attributes");
    const json* coded = member(extension, "attributes");
    if (coded == nullptr || !coded->is_object()) throw fault(pointer, "attributes is missing [UNDEFINED_PROPERTY]");
    for (const auto& [name, id] : coded->items()) {
        if (!id.is_number_unsigned())
            throw fault(fmt::format("{}/attributes/{}", pointer, name),
                        fmt::format("{} is no attribute of a Draco mesh [TYPE_MISMATCH]", brief(id)));
        const json* accessor = own == nullptr ? nullptr : member(*own, name);
        if (accessor == nullptr)
            throw fault(fmt::format("{}/attributes/{}", pointer, name),
                        "the primitive has no such attribute [UNRESOLVED_REFERENCE]");
        out.push_back(accessor->get<std::size_t>());
    }
    return out;
}

class DracoMesh {
 public:
    DracoMesh(const json& document, const json& primitive, const json& extension, std::string pointer)
        : accessors_(collection(document, "/accessors")), primitive_(primitive), pointer_(std::move(pointer))
    {
        attributes_ = filled_attributes(primitive, extension, pointer_);
        if (const json* accessor = member(primitive, "indices")) indices_ = accessor->get<std::size_t>();
    }

    void check(std::span<const std::byte> payload, const Limits& limits) const
    {
        DracoClaim claim;
        try {
            claim = read_draco_header(payload);
        } catch (Error& error) {
            throw error.at(pointer_);
        }
        Unsigned bytes = 0;  // of what is asked for: four floats for an element are the most
        for (const std::size_t accessor : attributes_) {
            compare(claim.vertices, accessor, "vertices");
            bytes += std::min(capped_product(count_of(accessor), 16), ~Unsigned{0} >> 8);
        }
        if (indices_) {
            const json* mode = member(primitive_, "mode");
            compare(mode == nullptr || *mode == 4 ? 3 * Unsigned{claim.faces} : claim.faces, *indices_, "corners");
            bytes += std::min(capped_product(count_of(*indices_), 4), ~Unsigned{0} >> 8);
        }
        if (bytes > kHarmlessBytes && bytes / limits.compressed_ratio > payload.size())
            throw fault(pointer_, fmt::format("{} bytes of Draco are to fill {} bytes: the limit is {} times",
                                              payload.size(), bytes, limits.compressed_ratio));
    }

    void mark(std::vector<bool>& is_filled) const
    {
        for (const std::size_t accessor : attributes_) is_filled[accessor] = true;
        if (indices_) is_filled[*indices_] = true;
    }

 private:
    Unsigned count_of(std::size_t accessor) const
    {
        return unsigned_at(accessors_[accessor], "count", fmt::format("/accessors/{}", accessor));
    }
    void compare(Unsigned claimed, std::size_t accessor, std::string_view what) const
    {
        if (claimed > count_of(accessor))
            throw fault(pointer_, fmt::format("the Draco payload holds {} {}, accessor {} only {}", claimed, what,
                                              accessor, count_of(accessor)));
    }

    const json& accessors_;
    const json& primitive_;
    std::string pointer_;
    std::vector<std::size_t> attributes_;
    std::optional<std::size_t> indices_;
};

}  // namespace

void check_compressed_views(const json& document, std::vector<View>& views, std::span<const GltfBuffer> buffers)
{
    std::size_t i = 0;
    for (const json& view : collection(document, "/bufferViews")) {
        View& out = views[i];
        for (const char* name : {"EXT_meshopt_compression", "KHR_meshopt_compression"}) {
            const json* extensions = member(view, "extensions");
            const json* extension = extensions == nullptr ? nullptr : member(*extensions, name);
            if (extension == nullptr) continue;
            check_meshopt_view(*extension, fmt::format("/bufferViews/{}/extensions/{}", i, name), out, buffers);
            out.is_decoded = true;
        }
        ++i;
    }
}

std::vector<bool> check_compressed_meshes(const json& document, std::span<const View> views,
                                          std::span<const GltfBuffer> buffers, const Limits& limits)
{
    std::vector<bool> is_filled(collection(document, "/accessors").size());
    for_each(document, "/meshes/*/primitives/*", [&](const json& primitive, const Place& place) {
        const json* extensions = member(primitive, "extensions");
        const json* extension = extensions == nullptr ? nullptr : member(*extensions, "KHR_draco_mesh_compression");
        if (extension == nullptr) return;
        const std::string pointer = place.pointer() + "/extensions/KHR_draco_mesh_compression";
        const View& view = views[unsigned_at(*extension, "bufferView", pointer)];
        if (buffers[view.buffer].bytes.empty())
            throw fault(pointer + "/bufferView", "its buffer has no data in this file [BUFFER_MISSING_GLB_DATA]");
        const DracoMesh mesh(document, primitive, *extension, pointer);
        mesh.check(bytes_of(view, buffers), limits);
        mesh.mark(is_filled);
    });
    return is_filled;
}

}  // namespace etalon::document
