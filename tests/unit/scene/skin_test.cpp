// Skins and morph targets: promises G36 and P8, glTF 2.0 §3.7.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <random>

#include "engine/base/error.h"
#include "engine/math/transform.h"
#include "engine/scene/builder.h"
#include "engine/scene/morph.h"
#include "engine/scene/pose.h"
#include "engine/scene/skin.h"
#include "tests/support/errors.h"
#include "tests/unit/scene/gltf_writer.h"

namespace etalon {
namespace {

using test::GltfWriter;
using testing::HasSubstr;

dquat turn(const dvec3& axis, double angle)
{
    const dvec3 v = std::sin(angle / 2) * normalize(axis);
    return dquat(std::cos(angle / 2), v.x, v.y, v.z);
}

// A box on node 0 whose vertices follow `joints` joints (nodes 1 …), each with random weights of sum 1.
Scene skinned_box(std::size_t joints, unsigned seed = 1)
{
    SceneBuilder build("box");
    build.show("box", make_box(dvec3(0.1, 0.2, 0.3), dvec3(1, 2, 3)), build.lambert("grey", dvec3(0.5)));
    Scene scene = std::move(build).finish();
    Primitive& p = scene.meshes[0].primitives[0];
    p.has_normals = true;
    std::mt19937 random(seed);
    std::uniform_real_distribution<float> unit(0, 1);
    p.influences_per_vertex = 4;
    for (std::size_t v = 0; v < p.positions.size(); ++v) {
        float sum = 0;
        std::array<Influence, 4> own;
        for (Influence& i : own) {
            i = {static_cast<std::uint32_t>(random() % joints), unit(random)};
            sum += i.weight;
        }
        for (Influence& i : own) p.influences.push_back({i.joint, i.weight / sum});
    }
    Skin skin;
    for (std::size_t j = 0; j < joints; ++j) {
        Node joint;
        joint.trs = Trs{};
        skin.joints.push_back(static_cast<Index>(scene.nodes.size()));
        skin.inverse_bind.emplace_back(1);
        scene.roots[0].nodes.push_back(skin.joints.back());
        scene.nodes.push_back(joint);
    }
    scene.skins.push_back(skin);
    scene.nodes[0].skin = 0;
    return scene;
}

void move_joints(Scene& scene, const dmat4& m)
{
    for (const Index joint : scene.skins[0].joints) scene.nodes[joint].parent_from_node = m;
}

dvec3 world(const Draw& draw, const vec3& p)
{
    return dvec3(draw.world_from_object * dvec4(dvec3(p), 1));
}

TEST(Skin, identity_joints_leave_every_bit_as_it_is)
{
    const Scene scene = skinned_box(7);
    const PosedScene posed = pose(scene);
    const Primitive& base = scene.meshes[0].primitives[0];
    ASSERT_EQ(posed.deformed.size(), 1u);
    const Primitive& moved = posed.primitive(posed.draws[0]);
    EXPECT_EQ(moved.positions, base.positions);
    EXPECT_EQ(moved.indices, base.indices);
    EXPECT_EQ(posed.draws[0].world_from_object, dmat4(1));
    for (std::size_t i = 0; i < base.normals.size(); ++i)
        EXPECT_LT(length(dvec3(moved.normals[i]) - dvec3(base.normals[i])), 1e-7);
    EXPECT_FALSE(moved.is_deformable());
}

TEST(Skin, forgets_where_its_node_is)
{
    Scene scene = skinned_box(3);
    const PosedScene there = pose(scene);
    scene.nodes[0].parent_from_node = translation(dvec3(100, 200, 300));
    const PosedScene elsewhere = pose(scene);
    EXPECT_EQ(there.deformed[0].positions, elsewhere.deformed[0].positions);
    EXPECT_EQ(there.bounds_min, elsewhere.bounds_min);
}

TEST(Skin, turning_all_joints_alike_is_turning_the_mesh)
{
    const dmat4 rigid = compose(dvec3(3, -2, 1), turn(dvec3(1, 2, 3), 2.5), dvec3(1));
    Scene scene = skinned_box(5);
    move_joints(scene, rigid);
    Scene plain = skinned_box(1);
    plain.nodes[0].skin = kNone;
    plain.nodes[0].parent_from_node = rigid;
    const PosedScene skin = pose(scene);
    const PosedScene node = pose(plain);
    const Primitive& a = skin.primitive(skin.draws[0]);
    const Primitive& b = node.primitive(node.draws[0]);
    const dmat3 turned(rigid);
    for (std::size_t i = 0; i < a.positions.size(); ++i) {
        EXPECT_LT(length(world(skin.draws[0], a.positions[i]) - world(node.draws[0], b.positions[i])), 1e-6);
        EXPECT_LT(length(dvec3(a.normals[i]) - turned * dvec3(b.normals[i])), 1e-6);
    }
    EXPECT_LT(length(skin.bounds_min - node.bounds_min) + length(skin.bounds_max - node.bounds_max), 1e-6);
}

TEST(Skin, keeps_its_shape_ten_million_metres_away)
{
    const dvec3 far(1e7, -2e7, 3e7);
    Scene scene = skinned_box(5);
    move_joints(scene, translation(far));
    const PosedScene posed = pose(scene);
    const Primitive& base = scene.meshes[0].primitives[0];
    for (std::size_t i = 0; i < base.positions.size(); ++i)
        EXPECT_LT(length(world(posed.draws[0], posed.deformed[0].positions[i]) - far - dvec3(base.positions[i])), 1e-6);
}

TEST(Skin, G36_weights_need_not_add_up_to_one)
{
    const dmat4 rigid = compose(dvec3(1, 2, 3), turn(dvec3(0, 1, 0), 1), dvec3(2, 1, 0.5));
    Scene scene = skinned_box(5);
    move_joints(scene, rigid);
    const PosedScene right = pose(scene);
    for (const float sum : {0.999f, 1e-30f, 1e30f}) {
        Scene off = scene;
        for (Influence& i : off.meshes[0].primitives[0].influences) i.weight *= sum;
        const PosedScene posed = pose(off);
        for (std::size_t i = 0; i < 8; ++i)
            EXPECT_LT(length(posed.deformed[0].positions[i] - right.deformed[0].positions[i]), 1e-6f) << sum;
    }
    // Without any weight: rigid to the node.
    Scene none = scene;
    for (Influence& i : none.meshes[0].primitives[0].influences) i.weight = 0;
    none.nodes[0].parent_from_node = rigid;
    const PosedScene posed = pose(none);
    for (std::size_t i = 0; i < 8; ++i)
        EXPECT_LT(length(posed.deformed[0].positions[i] - right.deformed[0].positions[i]), 1e-6f);
}

TEST(Skin, joints_that_mirror_keep_the_outside_outside)
{
    Scene scene = skinned_box(3);
    move_joints(scene, compose(dvec3(0), dquat(1, 0, 0, 0), dvec3(-1, 1, 1)));
    const PosedScene posed = pose(scene);
    const Primitive& p = posed.primitive(posed.draws[0]);
    for (std::size_t i = 0; i < p.indices.size(); i += 3) {
        const vec3 a = p.positions[p.indices[i]], b = p.positions[p.indices[i + 1]], c = p.positions[p.indices[i + 2]];
        EXPECT_GT(dot(cross(b - a, c - a), p.normals[p.indices[i]]), 0);
    }
}

TEST(Skin, uneven_scale_turns_normals_by_the_cofactor)
{
    Scene scene = skinned_box(2);
    scene.meshes[0].primitives[0].normals.assign(scene.meshes[0].primitives[0].positions.size(),
                                                 normalize(vec3(1, 1, 0)));
    move_joints(scene, compose(dvec3(0), dquat(1, 0, 0, 0), dvec3(1, 10, 1)));
    const PosedScene posed = pose(scene);
    // Perpendicular to the moved tangent (1, -10, 0).
    EXPECT_NEAR(dot(dvec3(posed.deformed[0].normals[0]), dvec3(1, -10, 0)), 0, 1e-6);
    EXPECT_NEAR(length(dvec3(posed.deformed[0].normals[0])), 1, 1e-6);
}

TEST(Skin, flat_normals_are_those_of_the_faces_as_they_are_now)
{
    Scene scene = skinned_box(9);
    scene.meshes[0].primitives[0].has_normals = false;
    std::mt19937 random(3);
    std::uniform_real_distribution<double> any(-1, 1);
    for (const Index joint : scene.skins[0].joints)
        scene.nodes[joint].parent_from_node = translation(dvec3(any(random), any(random), any(random)));
    const PosedScene posed = pose(scene);
    const Primitive& p = posed.primitive(posed.draws[0]);
    for (std::size_t i = 0; i < p.indices.size(); i += 3) {
        const dvec3 a(p.positions[p.indices[i]]), b(p.positions[p.indices[i + 1]]), c(p.positions[p.indices[i + 2]]);
        EXPECT_NEAR(dot(normalize(cross(b - a, c - a)), dvec3(p.normals[p.indices[i]])), 1, 1e-6);
    }
}

TEST(Skin, singular_and_infinite_joints_crush_or_are_refused)
{
    Scene scene = skinned_box(2);
    for (dmat4& m : scene.skins[0].inverse_bind) m = dmat4(0);
    const PosedScene posed = pose(scene);
    for (const vec3& p : posed.deformed[0].positions) EXPECT_EQ(p, vec3(0));
    for (const vec3& n : posed.deformed[0].normals) EXPECT_NEAR(length(n), 1, 1e-6f);
    move_joints(scene, compose(dvec3(1e300), dquat(1, 0, 0, 0), dvec3(1e300)));
    for (dmat4& m : scene.skins[0].inverse_bind) m = compose(dvec3(0), dquat(1, 0, 0, 0), dvec3(1e300));
    EXPECT_THROW(pose(scene), Error);
}

TEST(Morph, P8_no_weight_is_no_target_to_the_bit_and_weights_add_up)
{
    Scene scene = skinned_box(1);
    Primitive& p = scene.meshes[0].primitives[0];
    p.influences.clear();
    p.influences_per_vertex = 0;
    scene.nodes[0].skin = kNone;
    p.targets.resize(2);
    p.targets[0].positions.assign(p.positions.size(), vec3(1, 0, 0));
    p.targets[1].positions.assign(p.positions.size(), vec3(0, 2, 0));
    p.targets[1].normals.assign(p.positions.size(), vec3(0, 0, 5));
    scene.meshes[0].weights = {0, 0};
    EXPECT_EQ(pose(scene).draws[0].deformed, kNone);
    scene.meshes[0].weights = {0.5, -0.25};
    const PosedScene posed = pose(scene);
    const Primitive& moved = posed.primitive(posed.draws[0]);
    for (std::size_t i = 0; i < p.positions.size(); ++i) {
        EXPECT_LT(length(moved.positions[i] - (p.positions[i] + vec3(0.5f, -0.5f, 0))), 1e-6f);
        EXPECT_LT(length(moved.normals[i] - normalize(p.normals[i] + vec3(0, 0, -1.25f))), 1e-6f);
    }
    scene.nodes[0].weights = {0, 0};
    EXPECT_EQ(pose(scene).draws[0].deformed, kNone) << "the node's weights go before the mesh's";
    scene.nodes[0].weights = {1e300, 1e300};
    EXPECT_THROW(pose(scene), Error);
}

TEST(Morph, nodes_at_equal_weights_share_a_shape)
{
    Scene scene = skinned_box(1);
    Primitive& p = scene.meshes[0].primitives[0];
    p.influences.clear();
    p.influences_per_vertex = 0;
    p.targets.resize(1);
    p.targets[0].positions.assign(p.positions.size(), vec3(1, 0, 0));
    scene.nodes[0].skin = kNone;
    scene.meshes[0].weights = {1};
    for (const double weight : {1.0, 0.5}) {
        scene.roots[0].nodes.push_back(static_cast<Index>(scene.nodes.size()));
        scene.nodes.push_back(scene.nodes[0]);
        scene.nodes.back().weights = {weight};
    }
    const PosedScene posed = pose(scene);
    EXPECT_EQ(posed.draws.size(), 3u);
    EXPECT_EQ(posed.deformed.size(), 2u);
    EXPECT_EQ(posed.draws[0].deformed, posed.draws[1].deformed);
}

// One triangle whose three vertices follow two joints; node 1 is joint 0, node 2 below it joint 1.
GltfWriter skinned_file(const std::string& joints = R"([1,2])")
{
    GltfWriter file;
    file.add_floats(test::kTriangle, 3);
    file.add_accessor(file.add_view(std::vector<std::uint8_t>{0, 0, 0, 0, 0, 1, 0, 0, 1, 0, 0, 0}), test::kUnsignedByte,
                      "VEC4", 3);
    file.add_floats({1, 0, 0, 0, 0.5f, 0.5f, 0, 0, 1, 0, 0, 0}, 4);
    file.add("meshes", R"({"primitives":[{"attributes":{"POSITION":0,"JOINTS_0":1,"WEIGHTS_0":2}}]})");
    file.add("nodes", R"({"mesh":0,"skin":0})");
    file.add("nodes", R"({"children":[2]})");
    file.add("nodes", R"({"translation":[0,0,0]})");
    file.add("skins", fmt::format(R"({{"joints":{}}})", joints));
    file.add_floats({0, 1}, 1);
    file.add_floats({0, 0, 0, 0, 0, 4}, 3);
    return file;
}

TEST(ImportSkin, poses_a_file_at_the_time_asked_for)
{
    GltfWriter file = skinned_file();
    file.add(
        "animations",
        R"({"name":"lift","channels":[{"sampler":0,"target":{"node":2,"path":"translation"}}],"samplers":[{"input":3,"output":4}]})");
    const Scene scene = file.load();
    EXPECT_TRUE(scene.warnings.empty());
    EXPECT_EQ(scene.animations[0].duration, 1);
    EXPECT_EQ(pose(scene).bounds_max.z, 0);
    EXPECT_EQ(pose(scene, {.time = 0.5}).bounds_max.z, 2) << "vertex 2 follows joint 1 alone";
    EXPECT_EQ(pose(scene, {.time = 1e6}).bounds_max.z, 4);
    EXPECT_EQ(pose(scene, {.time = -1e6}).bounds_max.z, 0);
    const PosedScene posed = pose(scene, {.time = 1, .animation = "lift"});
    EXPECT_EQ(posed.deformed.at(0).positions.at(1).z, 2) << "half and half";
    EXPECT_THROW(pose(scene, {.time = NAN}), Error);
    EXPECT_THROW(pose(scene, {.animation = "drop"}), Error);
}

TEST(ImportSkin, refuses_what_cannot_be_meant)
{
    const auto message = [](const GltfWriter& file) { return test::message_of([&] { file.load(); }); };
    EXPECT_THAT(message(skinned_file("[1]")), HasSubstr("ACCESSOR_JOINTS_INDEX_OOB"));
    const auto animated = [](const std::vector<float>& times, const std::string& more) {
        GltfWriter file = skinned_file();
        file.add_floats(times, 1);
        file.add(
            "animations",
            fmt::format(
                R"({{"channels":[{{"sampler":0,"target":{{"node":2,"path":"translation"}}}}],"samplers":[{{"input":5,"output":4{}}}]}})",
                more));
        return file;
    };
    EXPECT_NO_THROW(animated({0, 1}, "").load());
    EXPECT_NO_THROW(animated({0, 0}, "").load());
    EXPECT_THAT(message(animated({1, 0}, "")), HasSubstr("NON_INCREASING"));
    EXPECT_THAT(message(animated({0, NAN}, "")), HasSubstr("ACCESSOR_INVALID_FLOAT"));
    EXPECT_THAT(message(animated({0, 1, 2}, "")), HasSubstr("INVALID_COUNT"));
    EXPECT_THAT(message(animated({0, 1}, R"(,"interpolation":"CUBICSPLINE")")), HasSubstr("INVALID_COUNT"));
    EXPECT_THAT(message(animated({0, 1}, R"(,"interpolation":"BEZIER")")), HasSubstr("VALUE_NOT_IN_LIST"));
}

TEST(ImportSkin, leaves_out_channels_that_lead_nowhere)
{
    GltfWriter file = skinned_file();
    const int node = file.add("nodes", R"({"matrix":[1,0,0,0,0,1,0,0,0,0,1,0,0,0,0,1]})");
    file.add(
        "animations",
        fmt::format(R"({{"channels":[{{"sampler":0,"target":{{"node":{},"path":"translation"}}}},)"
                    R"({{"sampler":0,"target":{{"node":2,"path":"weights"}}}},)"
                    R"({{"sampler":0,"target":{{"node":2,"path":"colour"}}}},)"
                    R"({{"sampler":0,"target":{{"path":"translation"}}}}],"samplers":[{{"input":3,"output":4}}]}})",
                    node));
    const Scene scene = file.load();
    EXPECT_TRUE(scene.animations.at(0).channels.empty());
    EXPECT_THAT(scene.warnings,
                testing::ElementsAre(HasSubstr("TARGET_NODE_MATRIX"), HasSubstr("NO_MORPHS"), HasSubstr("colour")));
    EXPECT_NO_THROW(pose(scene, {.time = 1}));
}

}  // namespace
}  // namespace etalon
