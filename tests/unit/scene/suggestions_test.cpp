// What is told to the author of a scene: the right place, what it would spare, and nothing that pictures need.
#include "engine/scene/suggestions.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <map>

#include "engine/scene/animation.h"
#include "engine/scene/builder.h"
#include "engine/scene/simplify.h"

namespace etalon {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using Texel = std::array<std::uint8_t, 4>;

struct Bench {
    SceneBuilder build{"bench"};
    Material material{};
    Primitive primitive = make_rectangle({0, 0, 0}, {1, 0, 0}, {0, 1, 0});

    Bench() { material.base_color_texture = picture(5); }

    TextureUse constant(Texel texel)
    {
        return build.texture("t", 8, 8, {}, [&](int, int) { return texel; });
    }
    TextureUse picture(int seed)
    {
        return build.texture("t", 8, 8, {}, [&](int x, int y) {
            return Texel{std::uint8_t(x * seed), std::uint8_t(y), 3, std::uint8_t(200 + x)};
        });
    }
    Scene scene()
    {
        build.show("wall", primitive, build.material(material));
        Scene out = std::move(build).finish();
        share_equal_images(out);
        return out;
    }
    std::vector<Suggestion> suggestions() { return suggest(scene()); }
};

TEST(Suggestions, of_a_scene_without_waste_are_none)
{
    EXPECT_THAT(Bench().suggestions(), IsEmpty());
}

TEST(Suggestions, flat_normal_maps_are_named_with_their_memory)
{
    Bench bench;
    bench.material.normal_texture = bench.constant({127, 128, 255, 255});
    bench.build.show("other", bench.primitive, bench.build.material(bench.material));
    bench.material.name = "another";
    bench.material.roughness = 0.5;
    const std::vector<Suggestion> all = bench.suggestions();
    ASSERT_EQ(all.size(), 1u);
    EXPECT_EQ(all[0].what, "normal map on 2 materials is flat (to 0.3 degrees)");
    EXPECT_THAT(all[0].pointers, ElementsAre("/materials/0/normalTexture", "/materials/1/normalTexture"));
    EXPECT_EQ(all[0].bytes, 8u * 8 * 4 * 4 / 3);

    Bench bent;
    bent.material.normal_texture = bent.constant({130, 128, 255, 255});
    EXPECT_THAT(bent.suggestions(), IsEmpty());  // it tilts everything, which no factor says
}

TEST(Suggestions, an_image_goes_only_with_all_its_uses)
{
    Bench bench;
    bench.material.emissive_texture = bench.constant({9, 9, 9, 255});
    bench.material.emission = dvec3(1);
    EXPECT_EQ(bench.suggestions().at(0).bytes, 8u * 8 * 4 * 4 / 3);

    Bench shared;
    shared.material.emissive_texture = shared.material.base_color_texture;
    const std::vector<Suggestion> all = shared.suggestions();
    ASSERT_EQ(all.size(), 1u);
    EXPECT_THAT(all[0].what, HasSubstr("not read"));
    EXPECT_EQ(all[0].bytes, 0u);
}

TEST(Suggestions, images_that_repeat_are_found_by_their_texels)
{
    Bench bench;
    bench.material.emission = dvec3(1);
    bench.material.emissive_texture = bench.picture(5);
    const std::vector<Suggestion> all = bench.suggestions();
    ASSERT_EQ(all.size(), 1u);
    EXPECT_THAT(all[0].pointers, ElementsAre("/materials/0/emissiveTexture"));
    EXPECT_EQ(all[0].bytes, 8u * 8 * 4 * 4 / 3);
}

TEST(Suggestions, carry_the_codes_of_the_khronos_validator)
{
    Bench bench;
    bench.primitive.uv[1] = bench.primitive.uv[0];
    bench.primitive.tangents.assign(4, vec4(1, 0, 0, 1));
    bench.material.layers.emplace().thickness = 1;
    bench.build.material(Material{.name = "nobody's"});
    std::map<std::string, std::vector<std::string>> said;
    for (const Suggestion& one : bench.suggestions()) said[one.code] = one.pointers;
    EXPECT_THAT(said["MESH_PRIMITIVE_UNUSED_TEXCOORD"], ElementsAre("/meshes/0/primitives/0/attributes/TEXCOORD_1"));
    EXPECT_THAT(said["UNUSED_MESH_TANGENT"], ElementsAre("/meshes/0/primitives/0/attributes/TANGENT"));
    EXPECT_THAT(said["KHR_MATERIALS_VOLUME_NO_TRANSMISSION"],
                ElementsAre("/materials/1/extensions/KHR_materials_volume"));
    EXPECT_THAT(said["UNUSED_OBJECT"], ElementsAre("/materials/0"));
    EXPECT_EQ(said.size(), 4u);
}

TEST(Suggestions, alpha_modes_colours_and_targets_without_effect)
{
    Bench bench;
    bench.material.base_color_texture = {};
    bench.material.alpha_mode = AlphaMode::blend;
    bench.primitive.uv = {};
    bench.primitive.colors.assign(4, vec4(1));
    bench.primitive.targets.push_back({.positions = std::vector<vec3>(4), .normals = {}, .tangents = {}});
    std::vector<std::string> pointers;
    for (const Suggestion& one : bench.suggestions())
        pointers.insert(pointers.end(), one.pointers.begin(), one.pointers.end());
    EXPECT_THAT(pointers,
                testing::UnorderedElementsAre("/materials/0/alphaMode", "/meshes/0/primitives/0/attributes/COLOR_0",
                                              "/meshes/0/primitives/0/targets/0"));
}

TEST(Suggestions, channels_that_stay_at_rest)
{
    Bench bench;
    Scene scene = bench.scene();
    scene.nodes[0].trs = Trs{.translation = dvec3(1, 2, 3)};
    const auto place = find_property("/nodes/0/translation");
    ASSERT_TRUE(place);
    Animation animation{.name = "still", .samplers = {}, .channels = {}, .duration = 1};
    animation.samplers.push_back({.width = 3, .times = {0, 1}, .values = {1, 2, 3, 1, 2, 3}});
    animation.channels.push_back({.sampler = 0, .property = place->property, .object = 0});
    scene.animations.push_back(animation);
    const std::vector<Suggestion> all = suggest(scene);
    ASSERT_EQ(all.size(), 1u);
    EXPECT_THAT(all[0].pointers, ElementsAre("/animations/0, of /nodes/0/translation"));
    scene.animations[0].samplers[0].values[5] = 4;  // it moves
    EXPECT_THAT(suggest(scene), IsEmpty());
    scene.animations[0].samplers[0].values = {1, 2, 4, 1, 2, 4};  // it stands elsewhere
    EXPECT_THAT(suggest(scene), IsEmpty());
}

}  // namespace
}  // namespace etalon
