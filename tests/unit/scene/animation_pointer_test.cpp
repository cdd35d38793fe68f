// KHR_animation_pointer: what a pointer moves is what a pose shows. KHR_accessor_float64: keys stay double.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "engine/base/error.h"
#include "engine/scene/animation.h"
#include "engine/scene/pose.h"
#include "engine/scene/requirements.h"
#include "tests/unit/scene/gltf_writer.h"

namespace etalon {
namespace {

using test::GltfWriter;
using testing::HasSubstr;

// A triangle with a material, a light, a camera, and an animation over one second of what `pointer` names from the
// first half of `values` to the second.
GltfWriter file_that_moves(const std::string& pointer, const std::vector<float>& values,
                           const std::string& interpolation = "LINEAR")
{
    GltfWriter file;
    file.add_floats(test::kTriangle, 3);
    file.add_floats({0, 1}, 1);
    file.add_floats(values, values.size() == 2 ? 1 : values.size() == 4 ? 2 : values.size() == 6 ? 3 : 4);
    file.add(
        "materials",
        R"({"emissiveFactor":[1,0.5,0.25],"extensions":{"KHR_materials_emissive_strength":{"emissiveStrength":4}}})");
    file.add("meshes", R"({"primitives":[{"attributes":{"POSITION":0},"material":0,"targets":[{"POSITION":0}]}]})");
    file.add("cameras", R"({"type":"perspective","perspective":{"yfov":1,"znear":0.1}})");
    file.add("nodes", R"({"mesh":0,"camera":0,"extensions":{"KHR_lights_punctual":{"light":0}}})");
    file.member(
        R"("extensionsUsed":["KHR_animation_pointer","KHR_lights_punctual"],"extensions":{"KHR_lights_punctual":{"lights":[{"type":"point","intensity":7}]}})");
    file.add(
        "animations",
        fmt::format(
            R"({{"channels":[{{"sampler":0,"target":{{"path":"pointer","extensions":{{"KHR_animation_pointer":{{"pointer":"{}"}}}}}}}}],)"
            R"("samplers":[{{"input":1,"output":2,"interpolation":"{}"}}]}})",
            pointer, interpolation));
    return file;
}

// The middle of the animation.
PosedScene halfway(const Scene& scene)
{
    EXPECT_TRUE(scene.warnings.empty()) << scene.warnings[0];
    return pose(scene, {.time = 0.5});
}
PosedScene halfway(Scene&&) = delete;  // a PosedScene refers to its scene

TEST(AnimationPointer, moves_nodes_and_weights_like_the_core_paths)
{
    const Scene moved = file_that_moves("/nodes/0/translation", {0, 0, 0, 2, 4, 6}).load();
    EXPECT_EQ(dvec3(halfway(moved).draws[0].world_from_object[3]), dvec3(1, 2, 3));
    const Scene turned = file_that_moves("/nodes/0/rotation", {0, 0, 0, 1, 0, 0, 1, 0}).load();
    EXPECT_NEAR(halfway(turned).draws[0].world_from_object[0].y, 1, 1e-15) << "a quarter turn, on the sphere";
    const Scene by_node = file_that_moves("/nodes/0/weights", {0, 2}).load();
    EXPECT_EQ(halfway(by_node).deformed.at(0).positions.at(1), vec3(2, 0, 0));
    const Scene by_mesh = file_that_moves("/meshes/0/weights", {0, 2}).load();
    EXPECT_EQ(halfway(by_mesh).deformed.at(0).positions.at(1), vec3(2, 0, 0));
}

TEST(AnimationPointer, moves_materials_and_leaves_the_scene_as_it_was)
{
    const Scene scene =
        file_that_moves("/materials/0/pbrMetallicRoughness/baseColorFactor", {1, 1, 1, 1, 0, 0.5f, 1, 1}).load();
    const PosedScene posed = halfway(scene);
    EXPECT_EQ(posed.material(posed.draws[0]).base_color, dvec4(0.5, 0.75, 1, 1));
    EXPECT_EQ(scene.materials[0].base_color, dvec4(1));
    EXPECT_EQ(pose(scene).material(posed.draws[0]).base_color, dvec4(1)) << "the rest pose";
    const Scene coated =
        file_that_moves("/materials/0/extensions/KHR_materials_clearcoat/clearcoatFactor", {0, 1}).load();
    const PosedScene with_coat = halfway(coated);
    ASSERT_TRUE(with_coat.material(with_coat.draws[0]).layers);
    EXPECT_EQ(with_coat.material(with_coat.draws[0]).layers->clearcoat, 0.5);
    EXPECT_TRUE(require(with_coat, {}).has(Feature::clearcoat));
    EXPECT_FALSE(require(pose(coated), {}).has(Feature::clearcoat));
}

TEST(AnimationPointer, emission_is_factor_times_strength_whichever_moves)
{
    const Scene by_factor = file_that_moves("/materials/0/emissiveFactor", {0, 0, 0, 1, 2, 3}).load();
    const PosedScene factor = halfway(by_factor);
    EXPECT_EQ(factor.material(factor.draws[0]).emission, dvec3(2, 4, 6));
    const Scene by_strength =
        file_that_moves("/materials/0/extensions/KHR_materials_emissive_strength/emissiveStrength", {0, 8}).load();
    const PosedScene strength = halfway(by_strength);
    EXPECT_EQ(strength.material(strength.draws[0]).emission, dvec3(4, 2, 1));
}

TEST(AnimationPointer, moves_lights_cameras_and_visibility)
{
    const Scene light = file_that_moves("/extensions/KHR_lights_punctual/lights/0/intensity", {0, 10}).load();
    EXPECT_EQ(halfway(light).lights.at(0).light.intensity, 5);
    const Scene camera = file_that_moves("/cameras/0/perspective/yfov", {0.5f, 1.5f}).load();
    EXPECT_EQ(halfway(camera).view.camera.yfov, 1);
    const Scene hidden = file_that_moves("/nodes/0/extensions/KHR_node_visibility/visible", {0, 1}, "STEP").load();
    EXPECT_TRUE(halfway(hidden).draws.empty());
    EXPECT_EQ(pose(hidden, {.time = 1}).draws.size(), 1u);
}

TEST(AnimationPointer, texture_transforms_move_by_their_parts)
{
    const std::string at = "/materials/0/pbrMetallicRoughness/baseColorTexture/extensions/KHR_texture_transform/";
    const auto transform = [&](const std::string& part, const std::vector<float>& values) {
        const Scene scene = file_that_moves(at + part, values).load();
        const PosedScene posed = halfway(scene);
        return posed.material(posed.draws[0]).base_color_texture.transform;
    };
    EXPECT_EQ(transform("offset", {0, 0, 1, 2})[2], dvec3(0.5, 1, 1));
    EXPECT_EQ(transform("scale", {1, 1, 3, 5})[0].x, 2);
    EXPECT_EQ(transform("scale", {1, 1, 3, 5})[1].y, 3);
    const dmat3 turned = transform("rotation", {0, static_cast<float>(kPi)});
    EXPECT_NEAR(turned[0].y, -1, 1e-7) << "a quarter turn takes u to -v";
}

TEST(AnimationPointer, holds_splines_to_what_a_property_can_be)
{
    const Scene scene = file_that_moves("/materials/0/pbrMetallicRoughness/metallicFactor", {0.5f, 9}).load();
    const PosedScene posed = halfway(scene);
    EXPECT_EQ(posed.material(posed.draws[0]).metallic, 1);
}

TEST(AnimationPointer, what_cannot_be_moved_is_a_warning)
{
    for (const char* pointer :
         {"/nodes/7/translation", "/nodes/0/translation/0", "/nodes//translation", "", "/materials/9/alphaCutoff",
          "/asset/version", "/nodes/-1/scale", "/nodes/99999999999999999999/scale"}) {
        const Scene scene = file_that_moves(pointer, {0, 0, 0, 1, 1, 1}).load();
        EXPECT_THAT(scene.warnings, testing::Contains(HasSubstr("nothing that can be animated"))) << pointer;
        EXPECT_TRUE(scene.animations.at(0).channels.empty());
    }
}

TEST(AnimationPointer, every_property_is_found_by_its_own_pointer)
{
    for (Index i = 0; i < animated_properties().size(); ++i) {
        std::string pointer = animated_properties()[i].pointer;
        pointer.replace(pointer.find("{}"), 2, "12");
        const auto place = find_property(pointer);
        ASSERT_TRUE(place) << pointer;
        EXPECT_EQ(place->property, i) << pointer;
        EXPECT_EQ(place->object, 12u);
    }
}

TEST(Float64, keys_and_what_they_move_stay_double)
{
    constexpr int kDouble = 5130;
    GltfWriter file;
    file.add_floats(test::kTriangle, 3);
    file.add_accessor(file.add_view(std::vector<double>{0, 1e6 + 1.0 / 3}), kDouble, "SCALAR", 2);
    file.add_accessor(file.add_view(std::vector<double>{1e9 + 0.125, 0, 0, 1e9 + 0.25, 0, 0}), kDouble, "VEC3", 2);
    file.show(R"("attributes":{"POSITION":0})");
    file.member(R"("extensionsUsed":["KHR_accessor_float64"])");
    file.add(
        "animations",
        R"({"channels":[{"sampler":0,"target":{"node":0,"path":"translation"}}],"samplers":[{"input":1,"output":2}]})");
    const Scene scene = file.load();
    EXPECT_EQ(scene.animations.at(0).duration, 1e6 + 1.0 / 3);
    EXPECT_EQ(pose(scene, {.time = 0}).draws.at(0).world_from_object[3].x, 1e9 + 0.125);
    EXPECT_EQ(pose(scene, {.time = 2e6}).draws.at(0).world_from_object[3].x, 1e9 + 0.25);
}

}  // namespace
}  // namespace etalon
