#include "engine/scene/pose.h"

#include <fmt/format.h>

#include <algorithm>
#include <limits>
#include <map>
#include <tuple>

#include "engine/base/error.h"
#include "engine/scene/builder.h"
#include "engine/scene/environment.h"
#include "engine/scene/morph.h"
#include "engine/scene/simplify.h"
#include "engine/scene/skin.h"
#include "engine/scene/view.h"

namespace etalon {

namespace {

// Up to here bounds come from every vertex, beyond from the boxes of the primitives.
constexpr std::size_t kExactVertices = std::size_t{1} << 24;

std::string node_label(const Scene& scene, Index index)
{
    return fmt::format("/nodes/{}{}", index,
                       scene.nodes[index].name.empty() ? "" : " \"" + scene.nodes[index].name + "\"");
}

// A node whose mesh is not drawn as stored.
struct Deformation {
    Index node;
    std::size_t first_draw;
    dmat4 world_from_node;
};

// The walk over the forest below one root. Depth-first in node order, without recursion: files may be 10^6 deep.
class Walk {
 public:
    Walk(const Scene& scene, const Motion& motion, const SceneRoot& root, std::uint64_t most_draws, PosedScene& out)
        : scene_(scene), motion_(motion), most_draws_(most_draws), out_(out), seen_(scene.nodes.size())
    {
        for (auto it = root.nodes.rbegin(); it != root.nodes.rend(); ++it) stack_.push_back({*it, true, dmat4(1)});
        while (!stack_.empty()) {
            const Pending next = stack_.back();
            stack_.pop_back();
            visit(next.node, next.visible, next.world_from_parent);
        }
    }

    std::vector<PlacedCamera> cameras;
    std::vector<Deformation> deformations;

 private:
    struct Pending {
        Index node;
        bool visible;
        dmat4 world_from_parent;
    };

    void visit(Index index, bool parent_visible, const dmat4& world_from_parent)
    {
        assume(index < scene_.nodes.size());
        if (seen_[index])
            throw Error(Blame::input,
                        node_label(scene_, index) + " is reached twice: it has two parents or is its own ancestor");
        seen_[index] = true;
        const Node& node = scene_.nodes[index];
        const dmat4 world = world_from_parent * parent_from_node(scene_, motion_, index);
        for (int column = 0; column < 4; ++column)
            if (!is_finite(dvec3(world[column])))
                throw Error(Blame::input, node_label(scene_, index) + ": the world matrix is not finite",
                            "repair the scales and translations above this node");
        // A camera stays usable in a hidden subtree: visibility is about what is drawn.
        if (node.camera != kNone) {
            const auto moved = motion_.cameras.find(node.camera);
            cameras.push_back({node.camera, index, world,
                               moved == motion_.cameras.end() ? scene_.cameras[node.camera] : moved->second});
        }
        const auto shown = motion_.visible.find(index);
        const bool visible = parent_visible && (shown == motion_.visible.end() ? node.visible : shown->second);
        if (visible && node.mesh != kNone) add_draws(node, index, world);
        if (visible && node.sphere) add_sphere(node, index, world);
        if (visible && node.light != kNone) add_light(node, index, world);
        for (auto it = node.children.rbegin(); it != node.children.rend(); ++it)
            stack_.push_back({*it, visible, world});
    }

    void add_draws(const Node& node, Index index, const dmat4& world)
    {
        assume(node.mesh < scene_.meshes.size());
        const auto& primitives = scene_.meshes[node.mesh].primitives;
        const std::size_t copies = std::max<std::size_t>(node.instances.size(), 1);
        if (primitives.size() * copies > most_draws_ - std::min<std::uint64_t>(out_.draws.size(), most_draws_))
            throw Error(Blame::input,
                        fmt::format("{} asks for {} draws; the limit is {}", node_label(scene_, index),
                                    primitives.size() * copies, most_draws_),
                        "use fewer instances");
        if (std::any_of(primitives.begin(), primitives.end(), [](const Primitive& p) { return p.is_deformable(); }))
            deformations.push_back({index, out_.draws.size(), world});
        for (std::size_t copy = 0; copy < copies; ++copy) {
            const dmat4 placed = node.instances.empty() ? world : world * node.instances[copy];
            for (std::size_t p = 0; p < primitives.size(); ++p)
                if (!primitives[p].indices.empty())
                    out_.draws.push_back({node.mesh, static_cast<Index>(p), index, placed});
        }
    }

    void add_sphere(const Node& node, Index index, const dmat4& world)
    {
        const dmat3 linear(world);
        const double scale = std::cbrt(std::abs(glm::determinant(linear)));
        const double spread = std::max({length(linear[0]), length(linear[1]), length(linear[2])}) -
                              std::min({length(linear[0]), length(linear[1]), length(linear[2])});
        if (spread > 1e-6 * scale)
            out_.notes.push_back(node_label(scene_, index) +
                                 ": a sphere under uneven scale is drawn round, of the same volume");
        const double radius = node.sphere->radius * scale;
        if (radius > 0) out_.spheres.push_back({dvec3(world[3]), radius, node.sphere->material, index});
    }

    void add_light(const Node& node, Index index, const dmat4& world)
    {
        assume(node.light < scene_.lights.size());
        dvec3 direction = -normalize(dvec3(world[2]));
        if (!is_finite(direction)) {
            direction = dvec3(0, 0, -1);
            out_.notes.push_back(node_label(scene_, index) +
                                 ": a light whose node has no extent in z shines towards -Z");
        }
        const auto moved = motion_.lights.find(node.light);
        out_.lights.push_back(
            {moved == motion_.lights.end() ? scene_.lights[node.light] : moved->second, dvec3(world[3]), direction});
    }

    const Scene& scene_;
    const Motion& motion_;
    std::uint64_t most_draws_;
    PosedScene& out_;
    std::vector<bool> seen_;
    std::vector<Pending> stack_;
};

// Shapes the primitives of nodes with skins and morph targets.
class Deformer {
 public:
    Deformer(const Scene& scene, const Motion& motion, std::uint64_t most_bytes, PosedScene& out)
        : scene_(scene), motion_(motion), most_bytes_(most_bytes), out_(out)
    {}

    void deform(const Deformation& at)
    {
        const Node& node = scene_.nodes[at.node];
        const auto moved = motion_.weights.find(at.node);
        const auto moved_mesh = motion_.mesh_weights.find(node.mesh);
        const std::vector<double>& weights = moved != motion_.weights.end() ? moved->second
                                             : !node.weights.empty()        ? node.weights
                                             : moved_mesh != motion_.mesh_weights.end()
                                                 ? moved_mesh->second
                                                 : scene_.meshes[node.mesh].weights;
        const bool reshaped = std::any_of(weights.begin(), weights.end(), [](double w) { return w != 0; });
        const auto& primitives = scene_.meshes[node.mesh].primitives;
        const auto drawn = static_cast<std::size_t>(
            std::count_if(primitives.begin(), primitives.end(), [](const Primitive& p) { return !p.indices.empty(); }));
        for (std::size_t d = at.first_draw; d < out_.draws.size() && out_.draws[d].node == at.node; ++d) {
            Draw& draw = out_.draws[d];
            const Primitive& base = scene_.meshes[draw.mesh].primitives[draw.primitive];
            const bool has_skin = node.skin != kNone && !base.influences.empty();
            const bool is_morphed = reshaped && !base.targets.empty();
            if (!has_skin && !is_morphed) continue;
            // Instances of one node, and nodes at the same weights, share what is alike.
            const Key key{draw.mesh, draw.primitive, has_skin ? at.node : kNone, weights};
            const auto [known, is_new] = made_.try_emplace(key);
            try {
                if (is_new) known->second = make(base, weights, is_morphed, has_skin ? &at : nullptr);
            } catch (Error& error) {
                throw error.at(node_label(scene_, at.node));
            }
            draw.deformed = known->second.index;
            if (!has_skin) continue;
            // A skin forgets where its node is: what is left of an instance is its own matrix.
            const std::size_t copy = (d - at.first_draw) / drawn;
            draw.world_from_object = translation(known->second.origin);
            if (!node.instances.empty()) draw.world_from_object = node.instances.at(copy) * draw.world_from_object;
        }
    }

 private:
    using Key = std::tuple<Index, Index, Index, std::vector<double>>;
    struct Made {
        Index index = kNone;
        dvec3 origin{0};
    };

    Made make(const Primitive& base, const std::vector<double>& weights, bool is_morphed, const Deformation* skin)
    {
        Made made{.index = static_cast<Index>(out_.deformed.size())};
        bytes_ += base.positions.size() * (2 * sizeof(vec3) + 3 * sizeof(vec4)) + base.indices.size() * sizeof(Index);
        if (bytes_ > most_bytes_)
            throw Error(Blame::input,
                        fmt::format("the skins and morph targets of the scene make {} bytes of vertices and more; the "
                                    "limit is {}",
                                    bytes_, most_bytes_),
                        "show fewer nodes with them, or lift the limits with --limits none");
        Primitive shaped = is_morphed ? morphed(base, weights) : base;
        if (skin != nullptr) {
            Skinned placed =
                skinned(std::move(shaped), joints_of(scene_.nodes[skin->node].skin), skin->world_from_node);
            shaped = std::move(placed.primitive);
            made.origin = placed.origin;
        }
        finish_deformed(shaped, is_morphed);
        out_.deformed.push_back(std::move(shaped));
        return made;
    }

    const std::vector<dmat4>& joints_of(Index skin)
    {
        if (world_from_node_.empty()) world_from_node_ = world_matrices(scene_, motion_);
        const auto [known, is_new] = joints_.try_emplace(skin);
        if (is_new) known->second = joint_matrices(scene_, scene_.skins.at(skin), world_from_node_);
        return known->second;
    }

    const Scene& scene_;
    const Motion& motion_;
    std::uint64_t most_bytes_;
    PosedScene& out_;
    std::map<Key, Made> made_;
    std::vector<dmat4> world_from_node_;
    std::map<Index, std::vector<dmat4>> joints_;
    std::uint64_t bytes_ = 0;
};

Motion motion_of(const Scene& scene, const PoseSettings& settings, std::vector<std::string>& notes)
{
    if (!settings.time && !settings.animation) return {};
    const double time = settings.time.value_or(0);
    Motion motion;
    if (!std::isfinite(time))
        throw Error(Blame::input, fmt::format("{} is no time", time), "seconds from the animation's start");
    if (scene.animations.empty() && (!settings.animation || settings.animation == kEveryAnimation)) {
        notes.push_back("no animation: the rest pose at any time");
    } else if (settings.animation == kEveryAnimation) {
        for (const Animation& animation : scene.animations) evaluate(scene, animation, time, motion);
    } else {
        const Animation& animation =
            settings.animation ? find_animation(scene, *settings.animation) : scene.animations.front();
        evaluate(scene, animation, time, motion);
    }
    return motion;
}

// Does this surface light the others? A texture of glowing parts at ordinary strength is decoration: without a lamp in
// the file such models (DamagedHelmet) are meant to be lit from outside.
bool shines(const Material& material)
{
    const double strongest = std::max({material.emission.x, material.emission.y, material.emission.z});
    return strongest > (material.emissive_texture.present() ? 1 : 0);
}

bool has_light(const PosedScene& posed)
{
    const auto& materials = posed.materials();
    return !posed.lights.empty() || std::any_of(posed.draws.begin(), posed.draws.end(), [&](const Draw& d) {
        return shines(posed.material(d));
    }) || std::any_of(posed.spheres.begin(), posed.spheres.end(), [&](const PosedSphere& s) {
        return shines(materials[s.material]);
    });
}

// Calls `with(point, radius)` for points whose box and sphere contain the scene's.
template <typename Function>
void for_each_extreme(const PosedScene& posed, Function with)
{
    std::size_t vertices = 0;
    for (const Draw& draw : posed.draws) vertices += posed.primitive(draw).indices.size();
    std::map<const Primitive*, std::pair<vec3, vec3>> boxes;
    for (const Draw& draw : posed.draws) {
        const Primitive& primitive = posed.primitive(draw);
        const auto world = [&](const dvec3& p) { return dvec3(draw.world_from_object * dvec4(p, 1)); };
        if (vertices <= kExactVertices) {
            for (const std::uint32_t i : primitive.indices) with(world(dvec3(primitive.positions[i])), 0.0);
        } else {
            const auto [box, is_new] = boxes.try_emplace(&primitive);
            if (is_new) box->second = bounds(primitive);
            const auto& [low, high] = box->second;
            for (int corner = 0; corner < 8; ++corner)
                with(
                    world(dvec3(corner & 1 ? high.x : low.x, corner & 2 ? high.y : low.y, corner & 4 ? high.z : low.z)),
                    0.0);
        }
    }
    for (const PosedSphere& sphere : posed.spheres) with(sphere.center, sphere.radius);
}

Subject measure_bounds(PosedScene& posed)
{
    dvec3 low(std::numeric_limits<double>::infinity());
    dvec3 high = -low;
    for_each_extreme(posed, [&](const dvec3& p, double radius) {
        low = glm::min(low, p - radius);
        high = glm::max(high, p + radius);
    });
    if (!(low.x <= high.x)) return {};
    if (!is_finite(low) || !is_finite(high))
        throw Error(Blame::input, "the scene reaches beyond every number", "repair its scales and translations");
    posed.bounds_min = low;
    posed.bounds_max = high;
    Subject subject{.center = low + (high - low) / 2.0, .radius = 0};
    for_each_extreme(posed, [&](const dvec3& p, double radius) {
        subject.radius = std::max(subject.radius, length(p - subject.center) + radius);
    });
    if (!(subject.radius > 0) || !std::isfinite(subject.radius)) subject.radius = 1;
    return subject;
}

Subject around(const std::pair<dvec3, dvec3>& box)
{
    const dvec3 half = (box.second - box.first) / 2.0;
    const double radius = length(half);
    return {.center = box.first + half, .radius = radius > 0 && std::isfinite(radius) ? radius : 1};
}

}  // namespace

PosedScene pose(const Scene& scene, const PoseSettings& settings)
{
    PosedScene posed = pose_whole(scene, settings);
    simplify(posed);
    return posed;
}

PosedScene pose_whole(const Scene& scene, const PoseSettings& settings)
{
    assume(!scene.roots.empty());
    const Index chosen = settings.root.value_or(scene.default_root);
    if (chosen >= scene.roots.size())
        throw Error(Blame::input, fmt::format("no scene {} in {}", chosen, scene.name),
                    fmt::format("it has {}: 0 to {}", scene.roots.size(), scene.roots.size() - 1));
    const SceneRoot& root = scene.roots[chosen];

    PosedScene posed;
    posed.scene = &scene;
    const ivec2 size = picture_size(settings, root.hints);
    const Motion motion = motion_of(scene, settings, posed.notes);
    if (!motion.materials.empty()) {
        posed.moved_materials = scene.materials;
        for (const auto& [index, material] : motion.materials) posed.moved_materials.at(index) = material;
    }
    const Walk walk(scene, motion, root, settings.limits.draws, posed);
    Deformer deformer(scene, motion, settings.limits.posed_bytes, posed);
    for (const Deformation& deformation : walk.deformations) deformer.deform(deformation);
    Subject subject = measure_bounds(posed);
    if (settings.framed) subject = around(*settings.framed);
    posed.view = choose_view(scene, walk.cameras, subject, size, settings, posed.notes);
    posed.environment = resolve_environment(root, settings, has_light(posed), posed.notes);
    return posed;
}

}  // namespace etalon
