#include "engine/scene/compressed.h"

#include <fmt/format.h>

#include <cstring>

#include "engine/scene/gltf_import.h"

namespace etalon::gltf {

namespace {

std::size_t whole(const Value& object, const char* key, std::size_t standard)
{
    const Value* found = member(object, key);
    return found == nullptr ? standard : static_cast<std::size_t>(found->GetNumberAsDouble());
}

std::string text(const Value& object, const char* key)
{
    const Value* found = member(object, key);
    return found != nullptr && found->IsString() ? found->Get<std::string>() : std::string();
}

class Decoder {
 public:
    Decoder(const Model& model, const CheckedGltf& file, const Limits& limits)
        : model_(model), file_(file), most_(limits.decoded_bytes)
    {
        for (std::size_t i = 0; i < model_.bufferViews.size(); ++i)
            for (const char* name : {"EXT_meshopt_compression", "KHR_meshopt_compression"})
                if (const Value* extension = member(model_.bufferViews[i].extensions, name))
                    guarded(fmt::format("/bufferViews/{}/extensions/{}", i, name), [&] { view(i, *extension); });
        for (std::size_t m = 0; m < model_.meshes.size(); ++m)
            for (std::size_t p = 0; p < model_.meshes[m].primitives.size(); ++p)
                if (const Value* extension =
                        member(model_.meshes[m].primitives[p].extensions, "KHR_draco_mesh_compression"))
                    guarded(fmt::format("/meshes/{}/primitives/{}/extensions/KHR_draco_mesh_compression", m, p),
                            [&] { mesh(model_.meshes[m].primitives[p], *extension); });
    }

    Decoded result() && { return std::move(out_); }

 private:
    template <typename Function>
    static void guarded(const std::string& pointer, const Function& decode)
    {
        try {
            decode();
        } catch (Error& error) {
            throw error.at(pointer);
        }
    }

    void take(std::size_t bytes)
    {
        if (__builtin_add_overflow(bytes_, bytes, &bytes_) || bytes_ > most_)
            throw Error(
                Blame::input,
                fmt::format("what is compressed takes {} bytes and more once decoded; the limit is {}", bytes_, most_),
                "split the file, or lift the limits with --limits none");
    }

    std::span<const std::byte> bytes_of(std::size_t buffer, std::size_t offset, std::size_t length) const
    {
        const auto& bytes = file_.buffers.at(buffer).bytes;
        assume(offset <= bytes.size() && length <= bytes.size() - offset);  // preflight has seen to it
        return bytes.subspan(offset, length);
    }

    void view(std::size_t index, const Value& extension)
    {
        const std::string mode = text(extension, "mode");
        const std::string filter = text(extension, "filter");
        const std::size_t count = whole(extension, "count", 0);
        const std::size_t stride = whole(extension, "byteStride", 0);
        if (filter == "COLOR")
            throw Error(Blame::input, "meshopt: the filter COLOR is not read",
                        "compress the file again with an encoder for EXT_meshopt_compression");
        take(count * stride);
        out_.views[index] = decode_meshopt(bytes_of(whole(extension, "buffer", 0), whole(extension, "byteOffset", 0),
                                                    whole(extension, "byteLength", 0)),
                                           mode == "TRIANGLES" ? MeshoptMode::triangles
                                           : mode == "INDICES" ? MeshoptMode::indices
                                                               : MeshoptMode::attributes,
                                           filter == "OCTAHEDRAL"    ? MeshoptFilter::octahedral
                                           : filter == "QUATERNION"  ? MeshoptFilter::quaternion
                                           : filter == "EXPONENTIAL" ? MeshoptFilter::exponential
                                                                     : MeshoptFilter::none,
                                           count, stride);
    }

    void mesh(const tinygltf::Primitive& primitive, const Value& extension)
    {
        if (primitive.indices < 0 || primitive.mode != TINYGLTF_MODE_TRIANGLES)
            throw Error(Blame::input, "only indexed triangles are read from Draco",
                        "compress the mesh again as triangles");
        std::vector<DracoWish> wishes;
        std::vector<std::size_t> accessors;
        // The parser drops objects without members: preflight has seen one.
        const Value* attributes = member(extension, "attributes");
        for (const std::string& name : attributes == nullptr ? std::vector<std::string>() : attributes->Keys()) {
            const int accessor = primitive.attributes.at(name);
            const auto& in = model_.accessors.at(static_cast<std::size_t>(accessor));
            accessors.push_back(static_cast<std::size_t>(accessor));
            wishes.push_back({.id = static_cast<std::uint32_t>(whole(*attributes, name.c_str(), 0)),
                              .component_type = in.componentType,
                              .components = static_cast<std::size_t>(
                                  tinygltf::GetNumComponentsInType(static_cast<std::uint32_t>(in.type))),
                              .count = in.count});
            take(wishes.back().components * in.count * sizeof(float));
        }
        const auto& view = model_.bufferViews.at(whole(extension, "bufferView", 0));
        DracoMesh decoded =
            decode_draco(bytes_of(static_cast<std::size_t>(view.buffer), view.byteOffset, view.byteLength), wishes);
        for (std::size_t i = 0; i < wishes.size(); ++i) out_.accessors[accessors[i]] = std::move(decoded.attributes[i]);
        corners(static_cast<std::size_t>(primitive.indices), decoded.corners);
    }

    // As the accessor of the indices wants them.
    void corners(std::size_t index, const std::vector<std::uint32_t>& corners)
    {
        const auto& accessor = model_.accessors.at(index);
        if (accessor.count != corners.size())
            throw Error(Blame::input,
                        fmt::format("Draco: {} corners of triangles; accessor {} has {}", corners.size(), index,
                                    accessor.count),
                        "compress the mesh again");
        const int size = tinygltf::GetComponentSizeInBytes(static_cast<std::uint32_t>(accessor.componentType));
        assume(size > 0);
        const auto width = std::min<std::size_t>(static_cast<std::size_t>(size), sizeof(std::uint32_t));
        take(corners.size() * width);
        std::vector<std::byte>& out = out_.accessors[index];
        out.resize(corners.size() * width);
        for (std::size_t i = 0; i < corners.size(); ++i) {
            if (width < sizeof(std::uint32_t) && corners[i] >> (8 * width) != 0)
                throw Error(Blame::input,
                            fmt::format("Draco: vertex {} does not fit the indices of accessor {}", corners[i], index),
                            "compress the mesh again");
            std::memcpy(&out[i * width], &corners[i], width);  // little-endian
        }
    }

    const Model& model_;
    const CheckedGltf& file_;
    Decoded out_;
    std::uint64_t most_;
    std::uint64_t bytes_ = 0;
};

}  // namespace

Decoded decode_compressed(const Model& model, const CheckedGltf& file, const Limits& limits)
{
    return Decoder(model, file, limits).result();
}

}  // namespace etalon::gltf
