// The one includer of Draco.
#include <draco/compression/decode.h>
#include <fmt/format.h>

#include <cstring>

#include "engine/base/error.h"
#include "engine/scene/compressed.h"

namespace etalon {

namespace {

Error bad(std::string what)
{
    return Error(Blame::input, std::move(what),
                 "compress the mesh again, or decode it: gltf-transform copy in.glb out.glb writes it uncompressed");
}

template <typename T>
std::vector<std::byte> values(const draco::PointAttribute& attribute, const DracoWish& wish)
{
    std::vector<std::byte> out(wish.count * wish.components * sizeof(T));
    std::vector<T> element(wish.components);
    for (std::size_t i = 0; i < wish.count; ++i) {
        const auto at = attribute.mapped_index(draco::PointIndex(static_cast<std::uint32_t>(i)));
        if (at.value() >= attribute.size() ||
            !attribute.ConvertValue<T>(at, static_cast<std::int8_t>(wish.components), element.data()))
            throw bad(fmt::format("Draco: attribute {} has no value for vertex {}", wish.id, i));
        std::memcpy(&out[i * wish.components * sizeof(T)], element.data(), wish.components * sizeof(T));
    }
    return out;
}

std::vector<std::byte> values(const draco::PointAttribute& attribute, const DracoWish& wish)
{
    switch (wish.component_type) {
        case 5120:
            return values<std::int8_t>(attribute, wish);
        case 5121:
            return values<std::uint8_t>(attribute, wish);
        case 5122:
            return values<std::int16_t>(attribute, wish);
        case 5123:
            return values<std::uint16_t>(attribute, wish);
        case 5125:
            return values<std::uint32_t>(attribute, wish);
        case 5126:
            return values<float>(attribute, wish);
        default:
            throw bad(
                fmt::format("Draco: component type {} cannot be had from attribute {}", wish.component_type, wish.id));
    }
}

}  // namespace

DracoMesh decode_draco(std::span<const std::byte> payload, std::span<const DracoWish> wishes)
{
    draco::DecoderBuffer buffer;
    buffer.Init(reinterpret_cast<const char*>(payload.data()), payload.size());
    draco::Decoder decoder;
    const auto decoded = decoder.DecodeMeshFromBuffer(&buffer);
    if (!decoded.ok()) throw bad(fmt::format("Draco: {}", decoded.status().error_msg_string()));
    const draco::Mesh& mesh = *decoded.value();
    DracoMesh out;
    for (std::uint32_t f = 0; f < mesh.num_faces(); ++f)
        for (const draco::PointIndex& corner : mesh.face(draco::FaceIndex(f))) {
            if (corner.value() >= mesh.num_points())
                throw bad(fmt::format("Draco: face {} names vertex {} of {}", f, corner.value(), mesh.num_points()));
            out.corners.push_back(corner.value());
        }
    for (const DracoWish& wish : wishes) {
        const draco::PointAttribute* attribute = mesh.GetAttributeByUniqueId(wish.id);
        if (attribute == nullptr) throw bad(fmt::format("Draco: the mesh has no attribute {}", wish.id));
        if (mesh.num_points() != wish.count || attribute->num_components() != static_cast<std::int8_t>(wish.components))
            throw bad(fmt::format("Draco: attribute {} has {} elements of {} numbers; its accessor has {} of {}",
                                  wish.id, mesh.num_points(), attribute->num_components(), wish.count,
                                  wish.components));
        // Its conversion reads bytes of the payload as bool, whatever they are; glTF has no such type.
        if (attribute->data_type() == draco::DT_BOOL)
            throw bad(fmt::format("Draco: attribute {} holds truth values", wish.id));
        out.attributes.push_back(values(*attribute, wish));
    }
    return out;
}

}  // namespace etalon
