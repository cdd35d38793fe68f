#include "engine/measure/relations.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <memory>
#include <random>

#include "engine/base/error.h"
#include "engine/scene/builder.h"

namespace etalon {
namespace {

/// Everything below one new node that holds `world_from_old`.
void put_under(Scene& scene, const dmat4& world_from_old)
{
    SceneRoot& root = scene.roots.front();
    Node node;
    node.name = "relation";
    node.parent_from_node = world_from_old;
    node.children = root.nodes;
    scene.nodes.push_back(std::move(node));
    root.nodes = {static_cast<Index>(scene.nodes.size() - 1)};
}

/// R1: lengths × s, radiance as it was; the intensity of a point of light is radiance times an area.
std::optional<Variant> scaled(const Scene& scene, double s)
{
    Variant out{.scene = scene};
    dmat4 scale(s);
    scale[3][3] = 1;
    put_under(out.scene, scale);
    for (Light& light : out.scene.lights) {
        if (light.type != LightType::directional) light.intensity *= s * s;
        light.range *= s;
    }
    for (Camera& camera : out.scene.cameras) {
        camera.xmag *= s;
        camera.ymag *= s;
        camera.znear *= s;
        if (camera.lens) camera.lens = ThinLens{camera.lens->aperture_radius * s, camera.lens->focus_distance * s};
    }
    for (Material& material : out.scene.materials)
        if (material.layers) material.layers->attenuation_distance *= s;
    return out;
}

std::optional<Variant> scaled_down(const Scene& scene, double s)
{
    return scaled(scene, 1 / s);
}

/// R2: an environment is infinitely far and stays.
std::optional<Variant> moved(const Scene& scene, double metres)
{
    Variant out{.scene = scene};
    put_under(out.scene, translation(dvec3(0.48, 0.6, -0.64) * metres));
    return out;
}

/// R3: about the vertical, the environment too.
std::optional<Variant> turned(const Scene& scene, double degrees)
{
    Variant out{.scene = scene};
    const double angle = degrees * kPi / 180;
    put_under(out.scene, rotation_y(angle));
    if (auto& environment = out.scene.roots.front().environment) environment->rotation += angle;
    return out;
}

bool uses_tangents(const Scene& scene)
{
    return std::any_of(scene.materials.begin(), scene.materials.end(), [](const Material& material) {
        return material.normal_texture.present() ||
               (material.layers &&
                (material.layers->anisotropy != 0 || material.layers->clearcoat_normal_texture.present()));
    });
}

/// R4: left and right of the world exchanged, and of the eye: the eye is the last node of the canonical scene. Which
/// way a bitangent goes in a mirrored mesh is not said by glTF in so many words.
std::optional<Variant> mirrored(const Scene& scene, double /*size*/)
{
    if (uses_tangents(scene)) return std::nullopt;
    Variant out{.scene = scene, .mirrored = true};
    dmat4 mirror(1);
    mirror[0][0] = -1;
    SceneRoot& root = out.scene.roots.front();
    const Index eye = root.nodes.back();
    root.nodes.pop_back();
    put_under(out.scene, mirror);
    out.scene.nodes[eye].parent_from_node = mirror * out.scene.nodes[eye].parent_from_node * mirror;
    root.nodes.push_back(eye);
    if (auto& environment = root.environment) {
        environment->rotation = -environment->rotation;
        if (environment->map) {
            auto map = std::make_shared<Image>(*environment->map);
            const auto channels = std::size_t(map->channels);
            for (int y = 0; y < map->height; ++y)
                for (int x = 0; x < map->width; ++x)
                    for (std::size_t c = 0; c < channels; ++c)
                        map->values[(std::size_t(y) * std::size_t(map->width) + std::size_t(x)) * channels + c] =
                            environment->map
                                ->values[(std::size_t(y) * std::size_t(map->width) + std::size_t(map->width - 1 - x)) *
                                             channels +
                                         c];
            environment->map = std::move(map);
        }
    }
    return out;
}

/// R5: so many nodes between the root and the rest.
std::optional<Variant> nested(const Scene& scene, double nodes)
{
    Variant out{.scene = scene};
    for (int i = 0; i < static_cast<int>(nodes); ++i) put_under(out.scene, dmat4(1));
    return out;
}

bool has_blend(const Scene& scene)
{
    return std::any_of(scene.materials.begin(), scene.materials.end(),
                       [](const Material& material) { return material.alpha_mode == AlphaMode::blend; });
}

template <typename Function>
bool for_triangle_meshes(Scene& scene, const Function& change)
{
    bool any = false;
    for (Mesh& mesh : scene.meshes) {
        for (Primitive& primitive : mesh.primitives) {
            if (primitive.topology != Topology::triangles || primitive.indices.empty()) continue;
            change(primitive.indices);
            any = true;
        }
    }
    return any;
}

/// R6: the triangles of each draw in another order. Blended ones are drawn in the order of the file, which counts.
std::optional<Variant> shuffled(const Scene& scene, double seed)
{
    if (has_blend(scene)) return std::nullopt;
    Variant out{.scene = scene};
    std::mt19937_64 random(static_cast<std::uint64_t>(seed));
    const bool any = for_triangle_meshes(out.scene, [&](std::vector<std::uint32_t>& indices) {
        std::vector<std::array<std::uint32_t, 3>> triangles(indices.size() / 3);
        for (std::size_t i = 0; i < triangles.size(); ++i)
            triangles[i] = {indices[3 * i], indices[3 * i + 1], indices[3 * i + 2]};
        std::shuffle(triangles.begin(), triangles.end(), random);
        for (std::size_t i = 0; i < indices.size(); ++i) indices[i] = triangles[i / 3].at(i % 3);
    });
    return any ? std::optional(std::move(out)) : std::nullopt;
}

/// R7: each triangle begins with another of its vertices.
std::optional<Variant> rotated_vertices(const Scene& scene, double by)
{
    Variant out{.scene = scene};
    const bool any = for_triangle_meshes(out.scene, [&](std::vector<std::uint32_t>& indices) {
        for (std::size_t i = 0; i + 3 <= indices.size(); i += 3)
            std::rotate(indices.begin() + std::ptrdiff_t(i), indices.begin() + std::ptrdiff_t(i) + int(by),
                        indices.begin() + std::ptrdiff_t(i) + 3);
    });
    return any ? std::optional(std::move(out)) : std::nullopt;
}

/// The attributes of a new vertex halfway between two. Normals stay as long as the mean is: what is interpolated in
/// between is then what it was.
std::uint32_t add_middle(Primitive& p, std::uint32_t a, std::uint32_t b)
{
    const auto middle = [&](auto& list) {
        if (!list.empty()) list.push_back((list[a] + list[b]) * 0.5f);
    };
    middle(p.positions);
    middle(p.normals);
    if (!p.tangents.empty()) {
        vec4 tangent = (p.tangents[a] + p.tangents[b]) * 0.5f;
        tangent.w = p.tangents[a].w;
        p.tangents.push_back(tangent);
    }
    for (auto& set : p.uv) middle(set);
    middle(p.colors);
    return static_cast<std::uint32_t>(p.positions.size() - 1);
}

bool subdivide(Primitive& p)
{
    if (p.topology != Topology::triangles || p.indices.empty() || p.is_deformable()) return false;
    std::map<std::pair<std::uint32_t, std::uint32_t>, std::uint32_t> middles;
    const auto middle = [&](std::uint32_t a, std::uint32_t b) {
        const auto [found, added] = middles.try_emplace(std::minmax(a, b), 0u);
        if (added) found->second = add_middle(p, found->first.first, found->first.second);
        return found->second;
    };
    std::vector<std::uint32_t> out;
    for (std::size_t i = 0; i + 3 <= p.indices.size(); i += 3) {
        const std::uint32_t a = p.indices[i], b = p.indices[i + 1], c = p.indices[i + 2];
        const std::uint32_t ab = middle(a, b), bc = middle(b, c), ca = middle(c, a);
        for (const std::uint32_t v : {a, ab, ca, ab, b, bc, ca, bc, c, ab, bc, ca}) out.push_back(v);
    }
    p.indices = std::move(out);
    return true;
}

/// R8: each triangle as four by the middles of its edges, so many times; all are cut, so that none meets a corner
/// within an edge. Left alone where that would be more than some million triangles.
std::optional<Variant> subdivided(const Scene& scene, double times)
{
    constexpr std::size_t kMostIndices = 12'000'000;
    if (uses_tangents(scene) || has_blend(scene)) return std::nullopt;
    Variant out{.scene = scene};
    bool any = false;
    std::size_t indices = 0;
    for (const Mesh& mesh : scene.meshes)
        for (const Primitive& primitive : mesh.primitives) indices += primitive.indices.size();
    for (int i = 0; i < static_cast<int>(times); ++i) {
        indices *= 4;
        if (indices > kMostIndices) return std::nullopt;
        for (Mesh& mesh : out.scene.meshes)
            for (Primitive& primitive : mesh.primitives) any |= subdivide(primitive);
    }
    return any ? std::optional(std::move(out)) : std::nullopt;
}

/// R9: every instance a node of its own.
std::optional<Variant> flattened(const Scene& scene, double /*size*/)
{
    Variant out{.scene = scene};
    bool any = false;
    for (std::size_t i = 0; i < scene.nodes.size(); ++i) {
        if (scene.nodes[i].instances.empty()) continue;
        any = true;
        for (const dmat4& node_from_instance : scene.nodes[i].instances) {
            Node single;
            single.parent_from_node = node_from_instance;
            single.mesh = scene.nodes[i].mesh;
            out.scene.nodes.push_back(std::move(single));
            out.scene.nodes[i].children.push_back(static_cast<Index>(out.scene.nodes.size() - 1));
        }
        out.scene.nodes[i].mesh = kNone;
        out.scene.nodes[i].instances.clear();
    }
    return any ? std::optional(std::move(out)) : std::nullopt;
}

/// R10: all that gives light × k.
std::optional<Variant> brighter(const Scene& scene, double k)
{
    Variant out{.scene = scene, .radiance = k};
    for (Light& light : out.scene.lights) light.intensity *= k;
    for (Material& material : out.scene.materials) {
        if (material.model == BsdfModel::unlit) return std::nullopt;  // its radiance is its colour, at most 1
        material.emission *= k;
    }
    if (auto& environment = out.scene.roots.front().environment) environment->scale *= k;
    return out;
}

std::optional<Variant> dimmer(const Scene& scene, double k)
{
    return brighter(scene, 1 / k);
}

/// R13: each punctual light as so many of an n-th.
std::optional<Variant> split_lights(const Scene& scene, double n)
{
    if (scene.lights.empty()) return std::nullopt;
    Variant out{.scene = scene};
    for (Light& light : out.scene.lights) light.intensity /= n;
    for (std::size_t i = 0; i < scene.nodes.size(); ++i) {
        if (scene.nodes[i].light == kNone) continue;
        for (int copy = 1; copy < static_cast<int>(n); ++copy) {
            Node same;
            same.light = scene.nodes[i].light;
            out.scene.nodes.push_back(std::move(same));
            out.scene.nodes[i].children.push_back(static_cast<Index>(out.scene.nodes.size() - 1));
        }
    }
    return out;
}

/// R16: whole texture widths further, where textures repeat.
std::optional<Variant> uv_shifted(const Scene& scene, double by)
{
    const bool all_repeat = std::all_of(scene.textures.begin(), scene.textures.end(), [](const Texture& texture) {
        return texture.sampler.wrap_u == Wrap::repeat && texture.sampler.wrap_v == Wrap::repeat;
    });
    if (!all_repeat || scene.textures.empty()) return std::nullopt;
    Variant out{.scene = scene};
    bool any = false;
    for (Mesh& mesh : out.scene.meshes) {
        for (Primitive& primitive : mesh.primitives) {
            for (std::vector<vec2>& set : primitive.uv) {
                for (vec2& uv : set) uv += vec2(static_cast<float>(by), -static_cast<float>(by));
                any = any || !set.empty();
            }
        }
    }
    return any ? std::optional(std::move(out)) : std::nullopt;
}

/// R28: every key and the picture so many seconds later.
std::optional<Variant> played_later(const Scene& scene, double seconds)
{
    if (scene.animations.empty()) return std::nullopt;
    Variant out{.scene = scene, .later = seconds};
    for (Animation& animation : out.scene.animations) {
        animation.duration += seconds;
        for (AnimationSampler& sampler : animation.samplers)
            for (double& time : sampler.times) time += seconds;
    }
    return out;
}

std::optional<Variant> drawn_with(const Scene& scene, std::function<void(RenderSettings&)> settings)
{
    return Variant{.scene = scene, .settings = std::move(settings)};
}

/// R20: ways to the same mean.
std::optional<Variant> without_roulette(const Scene& scene, double /*size*/)
{
    return drawn_with(scene, [](RenderSettings& settings) { settings.russian_roulette = false; });
}

std::optional<Variant> with_pcg(const Scene& scene, double /*size*/)
{
    return drawn_with(scene, [](RenderSettings& settings) { settings.sampler = Sequence::pcg; });
}

std::optional<Variant> by_reference(const Scene& scene, double /*size*/)
{
    return drawn_with(scene, [](RenderSettings& settings) { settings.renderer = Renderer::reference; });
}

/// R25: a near plane nearer still cuts nothing.
std::optional<Variant> nearer_plane(const Scene& scene, double by)
{
    Variant out{.scene = scene};
    for (Camera& camera : out.scene.cameras) camera.znear /= by;
    return out;
}

constexpr std::array kRelations = {
    Relation{.id = "R1", .name = "scale up", .unit = "×", .start = 2, .promised = 1e6, .most = 1e12, .apply = scaled},
    Relation{
        .id = "R1", .name = "scale down", .unit = "÷", .start = 2, .promised = 1e6, .most = 1e12, .apply = scaled_down},
    Relation{.id = "R2", .name = "translation", .unit = "m", .start = 1, .promised = 1e6, .most = 1e9, .apply = moved},
    Relation{.id = "R3", .name = "turn", .unit = "°", .start = 90, .promised = 217.3, .most = 217.3, .apply = turned},
    Relation{.id = "R4",
             .name = "mirrored",
             .unit = "",
             .start = 1,
             .promised = 1,
             .most = 1,
             .raster = false,
             .apply = mirrored},
    Relation{
        .id = "R5", .name = "node depth", .unit = "nodes", .start = 1, .promised = 1e3, .most = 1e4, .apply = nested},
    Relation{.id = "R6", .name = "triangle order", .unit = "", .start = 1, .promised = 1, .most = 1, .apply = shuffled},
    Relation{.id = "R7",
             .name = "vertex order",
             .unit = "",
             .start = 1,
             .promised = 2,
             .most = 2,
             .apply = rotated_vertices},
    Relation{.id = "R8",
             .name = "triangles split",
             .unit = "times",
             .start = 1,
             .promised = 1,
             .most = 4,
             .apply = subdivided},
    Relation{.id = "R9",
             .name = "instances flattened",
             .unit = "",
             .start = 1,
             .promised = 1,
             .most = 1,
             .apply = flattened},
    Relation{
        .id = "R10", .name = "brighter", .unit = "×", .start = 2, .promised = 1e12, .most = 1e20, .apply = brighter},
    Relation{.id = "R10", .name = "dimmer", .unit = "÷", .start = 2, .promised = 1e12, .most = 1e20, .apply = dimmer},
    Relation{.id = "R13",
             .name = "lights split",
             .unit = "parts",
             .start = 2,
             .promised = 8,
             .most = 64,
             .apply = split_lights},
    Relation{.id = "R16", .name = "uv shift", .unit = "", .start = 1, .promised = 64, .most = 1e5, .apply = uv_shifted},
    Relation{.id = "R20",
             .name = "no Russian roulette",
             .unit = "",
             .start = 1,
             .promised = 1,
             .most = 1,
             .raster = false,
             .apply = without_roulette},
    Relation{.id = "R20",
             .name = "independent samples",
             .unit = "",
             .start = 1,
             .promised = 1,
             .most = 1,
             .raster = false,
             .apply = with_pcg},
    Relation{.id = "R20",
             .name = "unbiased (reference)",
             .unit = "",
             .start = 1,
             .promised = 1,
             .most = 1,
             .raster = false,
             .apply = by_reference},
    Relation{.id = "R28",
             .name = "played later",
             .unit = "s",
             .start = 1,
             .promised = 1e6,
             .most = 1e9,
             .apply = played_later},
    Relation{.id = "R25",
             .name = "near plane nearer",
             .unit = "÷",
             .start = 2,
             .promised = 1e6,
             .most = 1e12,
             .path = false,
             .apply = nearer_plane},
};

}  // namespace

std::span<const Relation> relations()
{
    return kRelations;
}

Scene canonical_scene(const PosedScene& posed, const PoseSettings& settings)
{
    Scene scene = *posed.scene;
    SceneRoot only = scene.roots.at(settings.root.value_or(scene.default_root));
    Node eye;
    eye.name = "eye";
    eye.parent_from_node = posed.view.world_from_camera;
    eye.camera = 0;
    for (Node& node : scene.nodes) node.camera = kNone;
    scene.nodes.push_back(std::move(eye));
    scene.cameras = {posed.view.camera};
    only.nodes.push_back(static_cast<Index>(scene.nodes.size() - 1));
    only.environment = posed.environment;
    scene.roots = {std::move(only)};
    scene.default_root = 0;
    return scene;
}

PoseSettings canonical_view(const PosedScene& posed, const PoseSettings& settings)
{
    return {.size = ivec2(posed.view.width, posed.view.height),
            .no_environment = posed.environment.is_black(),
            .time = settings.time,
            .animation = settings.animation};
}

}  // namespace etalon
