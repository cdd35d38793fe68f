#include <fmt/format.h>

#include <algorithm>
#include <map>

#include "engine/scene/gltf_accessor.h"
#include "engine/scene/gltf_import.h"
#include "engine/scene/topology.h"

namespace etalon::gltf {

namespace {

// Bytes that a primitive's own copy of its vertices and indices takes: primitives may share accessors, copies do not.
double bytes_of(const Model& model, const tinygltf::Primitive& primitive)
{
    const auto count = [&](int accessor) {
        return static_cast<double>(model.accessors.at(static_cast<std::size_t>(accessor)).count);
    };
    const auto position = primitive.attributes.find("POSITION");
    if (position == primitive.attributes.end()) return 0;
    const double vertices = count(position->second);
    const double indices = primitive.indices < 0 ? vertices : count(primitive.indices);
    const double attributes = static_cast<double>(primitive.attributes.size()) * sizeof(vec4);
    double displacements = 0;
    for (const auto& target : primitive.targets) displacements += static_cast<double>(target.size()) * sizeof(vec3);
    return (attributes + displacements) * std::min(vertices, indices) + 3 * sizeof(std::uint32_t) * indices;
}

// The vertices that `indices` name, increasing, where they are under half of all: primitives of one mesh often share
// one long list. The indices then refer to places in the result.
Subset take_used(std::vector<std::uint32_t>& indices, std::size_t vertices)
{
    if (indices.size() >= vertices / 2) return std::nullopt;
    std::vector<std::uint32_t> used = indices;
    std::sort(used.begin(), used.end());
    used.erase(std::unique(used.begin(), used.end()), used.end());
    for (std::uint32_t& i : indices)
        i = static_cast<std::uint32_t>(std::lower_bound(used.begin(), used.end(), i) - used.begin());
    return used;
}

class Meshes {
 public:
    Meshes(const Source& source, Scene& scene) : source_(source), scene_(scene), reader_(source)
    {
        check_memory();
        for (std::size_t m = 0; m < source_.model.meshes.size(); ++m) {
            const tinygltf::Mesh& in = source_.model.meshes[m];
            Mesh out;
            out.name = in.name;
            for (std::size_t p = 0; p < in.primitives.size(); ++p) {
                tinygltf::Primitive primitive = in.primitives[p];
                primitive.material = material_in_variant(primitive);
                convert(primitive, fmt::format("/meshes/{}/primitives/{}", m, p), out);
            }
            read_weights(in, fmt::format("/meshes/{}", m), out);
            scene_.meshes.push_back(std::move(out));
        }
    }

 private:
    void check_memory() const
    {
        double bytes = 0;
        for (const tinygltf::Mesh& mesh : source_.model.meshes)
            for (const tinygltf::Primitive& primitive : mesh.primitives) bytes += bytes_of(source_.model, primitive);
        if (bytes > double(source_.limits.vertex_bytes))
            throw fault("/meshes",
                        fmt::format("the vertices of all primitives need {:.3g} GiB; the limit is {:.3g}",
                                    bytes / (1 << 30), double(source_.limits.vertex_bytes) / (1 << 30)),
                        "give each primitive its own part of the vertices, or split the file");
    }

    void convert(const tinygltf::Primitive& in, const std::string& pointer, Mesh& mesh)
    {
        if (!in.attributes.contains("POSITION")) {
            scene_.warnings.push_back(pointer + ": no POSITION: nothing is drawn");
            return;
        }
        const auto mode = unrolled_mode(in.mode);
        if (!mode)
            throw fault(pointer + "/mode", fmt::format("{} [VALUE_NOT_IN_LIST]", in.mode),
                        "0 (points) to 6 (triangle fan)");
        const std::size_t vertices = reader_.count(in.attributes.at("POSITION"));
        std::vector<std::uint32_t> indices = read_indices(in, pointer, vertices);
        const Subset used = take_used(indices, vertices);
        Primitive out;
        read_attributes(in, pointer, vertices, used, out);
        read_influences(in, pointer, vertices, used, out);
        read_targets(in, pointer, vertices, used, out);
        out.topology = topology_of(*mode);
        out.indices = unrolled(*mode, std::move(indices));
        out.material = material_of(in, out);
        // What moves may gain an area that it does not have at rest.
        if (out.topology == Topology::triangles && !out.is_deformable()) drop_triangles_without_area(out);
        finish_normals(out);
        finish_tangents(in, pointer, out);
        mesh.primitives.push_back(std::move(out));
    }

    static std::optional<DrawMode> unrolled_mode(int mode)
    {
        if (mode < 0 || mode > 6) return std::nullopt;
        return static_cast<DrawMode>(mode);
    }

    void read_attributes(const tinygltf::Primitive& in, const std::string& pointer, std::size_t vertices,
                         const Subset& used, Primitive& out)
    {
        const auto attribute = [&](const char* name, std::initializer_list<std::size_t> components) -> Floats {
            const auto found = in.attributes.find(name);
            if (found == in.attributes.end()) return {};
            const std::string at = fmt::format("{}/attributes/{}", pointer, name);
            check_count(found->second, vertices, at);
            return reader_.floats(found->second, components, at, used);
        };
        out.positions = triples(attribute("POSITION", {3}));
        out.normals = triples(attribute("NORMAL", {3}));
        out.has_normals = !out.normals.empty();
        for (std::size_t set = 0; set < 2; ++set) {
            const Floats uv = attribute(set == 0 ? "TEXCOORD_0" : "TEXCOORD_1", {2});
            for (std::size_t i = 0; i < uv.count; ++i) out.uv[set].emplace_back(uv.at(i, 0), uv.at(i, 1));
        }
        const Floats color = attribute("COLOR_0", {3, 4});
        for (std::size_t i = 0; i < color.count; ++i)
            out.colors.emplace_back(color.at(i, 0), color.at(i, 1), color.at(i, 2),
                                    color.components == 4 ? color.at(i, 3) : 1.0f);
        // glTF 2.0 §3.7.2.1: without normals given tangents are ignored.
        if (!out.has_normals || !wants_tangents(in.material)) return;
        const Floats tangent = attribute("TANGENT", {4});
        for (std::size_t i = 0; i < tangent.count; ++i) {
            const vec3 direction(tangent.at(i, 0), tangent.at(i, 1), tangent.at(i, 2));
            const float l = length(direction);
            out.tangents.emplace_back(l > 0 ? direction / l : vec3(1, 0, 0), tangent.at(i, 3) < 0 ? -1.0f : 1.0f);
        }
    }

    void check_count(int accessor, std::size_t vertices, const std::string& pointer) const
    {
        if (const std::size_t count = reader_.count(accessor); count != vertices)
            throw fault(pointer, fmt::format("{} elements for {} positions [MESH_PRIMITIVE_UNEQUAL_ACCESSOR_COUNT]",
                                             count, vertices));
    }

    static std::vector<vec3> triples(const Floats& in)
    {
        std::vector<vec3> values;
        values.reserve(in.count);
        for (std::size_t i = 0; i < in.count; ++i) values.emplace_back(in.at(i, 0), in.at(i, 1), in.at(i, 2));
        return values;
    }

    // JOINTS_n and WEIGHTS_n, from set 0 on, as many sets as there are.
    void read_influences(const tinygltf::Primitive& in, const std::string& pointer, std::size_t vertices,
                         const Subset& used, Primitive& out)
    {
        std::size_t sets = 0;
        while (in.attributes.contains(fmt::format("JOINTS_{}", sets)) &&
               in.attributes.contains(fmt::format("WEIGHTS_{}", sets)))
            ++sets;
        out.influences_per_vertex = 4 * sets;
        out.influences.resize(out.positions.size() * out.influences_per_vertex);
        for (std::size_t set = 0; set < sets; ++set) {
            const std::string joints_at = fmt::format("{}/attributes/JOINTS_{}", pointer, set);
            const std::string weights_at = fmt::format("{}/attributes/WEIGHTS_{}", pointer, set);
            const int joints = in.attributes.at(fmt::format("JOINTS_{}", set));
            const int weights = in.attributes.at(fmt::format("WEIGHTS_{}", set));
            check_count(joints, vertices, joints_at);
            check_count(weights, vertices, weights_at);
            const std::vector<std::uint32_t> joint = reader_.joints(joints, joints_at, used);
            const Floats weight = reader_.floats(weights, {4}, weights_at, used);
            for (std::size_t v = 0; v < out.positions.size(); ++v)
                for (std::size_t i = 0; i < 4; ++i) {
                    const float w = weight.at(v, i);
                    if (w < 0)
                        throw fault(weights_at,
                                    fmt::format("vertex {} has the weight {} [ACCESSOR_WEIGHTS_NEGATIVE]", v, w));
                    // A joint without weight may have any number in the file.
                    if (w > 0) out.influences[v * out.influences_per_vertex + 4 * set + i] = {joint[4 * v + i], w};
                }
        }
    }

    void read_targets(const tinygltf::Primitive& in, const std::string& pointer, std::size_t vertices,
                      const Subset& used, Primitive& out)
    {
        for (std::size_t t = 0; t < in.targets.size(); ++t) {
            MorphTarget target;
            for (const auto& offsets : in.targets[t]) {
                const std::string& name = offsets.first;
                const std::string at = fmt::format("{}/targets/{}/{}", pointer, t, name);
                const auto read = [&] {
                    check_count(offsets.second, vertices, at);
                    return triples(reader_.floats(offsets.second, {3}, at, used));
                };
                if (name == "POSITION")
                    target.positions = read();
                else if (name == "NORMAL" && !out.normals.empty())
                    target.normals = read();
                else if (name == "TANGENT" && !out.tangents.empty())
                    target.tangents = read();
                else if (name != "NORMAL" && name != "TANGENT")
                    scene_.warnings.push_back(at + ": only POSITION, NORMAL and TANGENT are morphed");
            }
            out.targets.push_back(std::move(target));
        }
    }

    // One weight per target; primitives of one mesh should have equally many.
    void read_weights(const tinygltf::Mesh& in, const std::string& pointer, Mesh& out)
    {
        std::size_t targets = 0;
        for (const Primitive& primitive : out.primitives) targets = std::max(targets, primitive.targets.size());
        out.weights = in.weights;
        if (!out.weights.empty() && out.weights.size() != targets)
            scene_.warnings.push_back(fmt::format("{}/weights: {} for {} morph targets [MESH_INVALID_WEIGHTS_COUNT]",
                                                  pointer, out.weights.size(), targets));
        out.weights.resize(targets);
    }

    std::vector<std::uint32_t> read_indices(const tinygltf::Primitive& in, const std::string& pointer,
                                            std::size_t vertices)
    {
        std::vector<std::uint32_t> out;
        if (in.indices < 0) {
            if (vertices >= 0xffffffffu) throw fault(pointer, "over 2^32 - 2 vertices");
            out.resize(vertices);
            for (std::uint32_t i = 0; i < out.size(); ++i) out[i] = i;
            return out;
        }
        out = reader_.indices(in.indices, pointer + "/indices");
        const auto bad = std::find_if(out.begin(), out.end(), [&](std::uint32_t i) { return i >= vertices; });
        if (bad != out.end())
            throw fault(pointer + "/indices",
                        fmt::format("index {} is {}, but there are {} positions [ACCESSOR_INDEX_OOB]",
                                    bad - out.begin(), *bad, vertices));
        return out;
    }

    // KHR_materials_variants: the primitive's own material where the mapping does not name the variant.
    int material_in_variant(const tinygltf::Primitive& in) const
    {
        const Value* extension = member(in.extensions, "KHR_materials_variants");
        const Value* mappings = extension == nullptr ? nullptr : member(*extension, "mappings");
        for (std::size_t m = 0; mappings != nullptr && m < mappings->ArrayLen(); ++m) {
            const Value& mapping = mappings->Get(static_cast<int>(m));
            const Value* variants = member(mapping, "variants");
            for (std::size_t v = 0; variants != nullptr && v < variants->ArrayLen(); ++v)
                if (variants->Get(static_cast<int>(v)).GetNumberAsInt() == static_cast<int>(source_.variant))
                    return static_cast<int>(number(mapping, "material", "", in.material, 0, 1e9));
        }
        return in.material;
    }

    bool wants_tangents(int material) const
    {
        return material >= 0 && tangent_use(scene_.materials.at(static_cast<std::size_t>(material))) != nullptr;
    }

    // The texture in whose space a material needs tangents, which may be none but that of uv set 0 where a brushed
    // surface has no texture; null: it needs no tangents. The base's normal map goes before the coat's: a vertex has
    // one tangent.
    static const TextureUse* tangent_use(const Material& material)
    {
        if (material.normal_texture.present()) return &material.normal_texture;
        if (!material.layers) return nullptr;
        if (material.layers->clearcoat_normal_texture.present()) return &material.layers->clearcoat_normal_texture;
        return material.layers->anisotropy > 0 ? &material.layers->anisotropy_texture : nullptr;
    }

    // The material's index. Points and lines without normals are drawn unlit (glTF 2.0 §3.7.2.1): in an unlit copy.
    Index material_of(const tinygltf::Primitive& in, const Primitive& primitive)
    {
        if (in.material < 0 && standard_ == kNone) {
            scene_.materials.emplace_back();
            scene_.materials.back().name = "(standard)";
            standard_ = static_cast<Index>(scene_.materials.size() - 1);
        }
        const Index own = in.material < 0 ? standard_ : static_cast<Index>(in.material);
        if (primitive.topology == Topology::triangles || primitive.has_normals ||
            scene_.materials[own].model == BsdfModel::unlit)
            return own;
        const auto [copy, is_new] = unlit_copy_.try_emplace(own, static_cast<Index>(scene_.materials.size()));
        if (is_new) {
            Material unlit = scene_.materials[own];
            unlit.name += " (unlit)";
            unlit.model = BsdfModel::unlit;
            unlit.layers.reset();
            scene_.materials.push_back(std::move(unlit));
        }
        return copy->second;
    }

    void finish_tangents(const tinygltf::Primitive& in, const std::string& pointer, Primitive& out)
    {
        const Material& material = scene_.materials[out.material];
        const TextureUse* use = tangent_use(material);
        if (use == nullptr || out.topology != Topology::triangles || !out.tangents.empty()) return;
        if (out.uv[static_cast<std::size_t>(use->uv_set)].empty()) {
            scene_.warnings.push_back(fmt::format(
                "{}: material {} has {}, but there is no TEXCOORD_{} [MESH_PRIMITIVE_TOO_FEW_TEXCOORDS]: {}", pointer,
                in.material, use->present() ? "a map in tangent space" : "anisotropy", use->uv_set,
                use->present() ? "it is not applied" : "its direction is arbitrary"));
            return;
        }
        add_tangents(out, use->uv_set);
    }

    const Source& source_;
    Scene& scene_;
    AccessorReader reader_;
    Index standard_ = kNone;
    std::map<Index, Index> unlit_copy_;
};

}  // namespace

void import_meshes(const Source& source, Scene& scene)
{
    const Meshes meshes(source, scene);
}

}  // namespace etalon::gltf
