#include <fmt/format.h>

#include <algorithm>
#include <map>

#include "engine/scene/gltf_accessor.h"
#include "engine/scene/gltf_import.h"
#include "engine/scene/topology.h"

namespace etalon::gltf {

namespace {

constexpr double kMaxBytes = 8.0 * (1 << 30);

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
    return static_cast<double>(primitive.attributes.size()) * sizeof(vec4) * std::min(vertices, indices) +
           3 * sizeof(std::uint32_t) * indices;
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
            for (std::size_t p = 0; p < in.primitives.size(); ++p)
                convert(in.primitives[p], fmt::format("/meshes/{}/primitives/{}", m, p), out);
            scene_.meshes.push_back(std::move(out));
        }
    }

 private:
    void check_memory() const
    {
        double bytes = 0;
        for (const tinygltf::Mesh& mesh : source_.model.meshes)
            for (const tinygltf::Primitive& primitive : mesh.primitives) bytes += bytes_of(source_.model, primitive);
        if (bytes > kMaxBytes)
            throw fault(
                "/meshes",
                fmt::format("the vertices of all primitives need {:.3g} GiB; the limit is 8", bytes / (1 << 30)),
                "give each primitive its own part of the vertices, or split the file");
    }

    void convert(const tinygltf::Primitive& in, const std::string& pointer, Mesh& mesh)
    {
        if (!in.attributes.contains("POSITION")) {
            scene_.warnings.push_back(pointer + ": no POSITION: nothing is drawn");
            return;
        }
        if (!in.targets.empty()) has_morph_targets_ = true;
        const auto mode = unrolled_mode(in.mode);
        if (!mode)
            throw fault(pointer + "/mode", fmt::format("{} [VALUE_NOT_IN_LIST]", in.mode),
                        "0 (points) to 6 (triangle fan)");
        const std::size_t vertices = reader_.count(in.attributes.at("POSITION"));
        std::vector<std::uint32_t> indices = read_indices(in, pointer, vertices);
        const Subset used = take_used(indices, vertices);
        Primitive out;
        read_attributes(in, pointer, vertices, used, out);
        out.topology = topology_of(*mode);
        out.indices = unrolled(*mode, std::move(indices));
        out.material = material_of(in, out);
        if (out.topology == Topology::triangles) drop_triangles_without_area(out);
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
            if (const std::size_t count = reader_.count(found->second); count != vertices)
                throw fault(at, fmt::format("{} elements for {} positions [MESH_PRIMITIVE_UNEQUAL_ACCESSOR_COUNT]",
                                            count, vertices));
            return reader_.floats(found->second, components, at, used);
        };
        const auto triples = [](const Floats& in3) {
            std::vector<vec3> values;
            values.reserve(in3.count);
            for (std::size_t i = 0; i < in3.count; ++i) values.emplace_back(in3.at(i, 0), in3.at(i, 1), in3.at(i, 2));
            return values;
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

    bool wants_tangents(int material) const
    {
        return material >= 0 && scene_.materials.at(static_cast<std::size_t>(material)).normal_texture.present();
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
            scene_.materials.push_back(std::move(unlit));
        }
        return copy->second;
    }

    void finish_tangents(const tinygltf::Primitive& in, const std::string& pointer, Primitive& out)
    {
        const TextureUse& map = scene_.materials[out.material].normal_texture;
        if (!map.present() || out.topology != Topology::triangles || !out.tangents.empty()) return;
        if (out.uv[static_cast<std::size_t>(map.uv_set)].empty()) {
            scene_.warnings.push_back(
                fmt::format("{}: material {} has a normal map, but there is no TEXCOORD_{}: it is not applied", pointer,
                            in.material, map.uv_set));
            return;
        }
        add_tangents(out, map.uv_set);
    }

 public:
    bool has_morph_targets() const { return has_morph_targets_; }

 private:
    const Source& source_;
    Scene& scene_;
    AccessorReader reader_;
    Index standard_ = kNone;
    std::map<Index, Index> unlit_copy_;
    bool has_morph_targets_ = false;
};

}  // namespace

void import_meshes(const Source& source, Scene& scene)
{
    const Meshes meshes(source, scene);
    if (meshes.has_morph_targets())
        scene.warnings.push_back("/meshes: morph targets are not applied: the base shape is drawn");
    if (!source.model.skins.empty())
        scene.warnings.push_back(
            "/skins: joints are not applied: skinned meshes are drawn as stored, where their node is");
}

}  // namespace etalon::gltf
