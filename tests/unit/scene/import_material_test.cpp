// Materials, textures, lights, cameras, nodes and extras of glTF, on files made in memory.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "engine/base/error.h"
#include "engine/image/io.h"
#include "engine/scene/pose.h"
#include "tests/support/errors.h"
#include "tests/support/files.h"
#include "tests/unit/scene/gltf_writer.h"

namespace etalon {
namespace {

using test::GltfWriter;
using testing::ElementsAre;
using testing::HasSubstr;

// A PNG of one colour.
std::vector<std::byte> png(float r, float g, float b)
{
    Image image(2, 2, 3);
    for (int y = 0; y < 2; ++y)
        for (int x = 0; x < 2; ++x) {
            image.at(x, y, 0) = r;
            image.at(x, y, 1) = g;
            image.at(x, y, 2) = b;
        }
    return encode_png(image, {});
}

// A triangle with uv and a material, given as JSON; two textures (0 and 1) with one image each.
GltfWriter textured_file(const std::string& material, const std::string& samplers = "{}")
{
    GltfWriter file;
    file.add_floats(test::kTriangle, 3);
    file.add_floats({0, 1, 1, 1, 0, 0}, 2);
    file.add_floats({0, 0, 1, 0, 0, 1, 0, 0, 1}, 3);
    for (const float red : {1.0f, 0.0f})
        file.add("images", fmt::format(R"({{"bufferView":{},"mimeType":"image/png"}})", file.add_view(png(red, 0, 1))));
    file.add("samplers", samplers);
    file.add("textures", R"({"source":0,"sampler":0})");
    file.add("textures", R"({"source":1,"sampler":0})");
    file.add("materials", material);
    file.show(R"("attributes":{"POSITION":0,"TEXCOORD_0":1,"NORMAL":2},"material":0)");
    return file;
}

TEST(ImportMaterial, reads_the_metallic_roughness_model_with_all_its_textures)
{
    const Scene scene =
        textured_file(
            R"({"name":"all","doubleSided":true,"alphaMode":"MASK","alphaCutoff":0.25,"emissiveFactor":[0.5,0.25,0],
        "pbrMetallicRoughness":{"baseColorFactor":[0.1,0.2,0.3,0.4],"metallicFactor":0.5,"roughnessFactor":0.75,
        "baseColorTexture":{"index":0},"metallicRoughnessTexture":{"index":1}},"normalTexture":{"index":0,"scale":0.5},
        "occlusionTexture":{"index":1,"strength":0.25},"emissiveTexture":{"index":0}})")
            .load();
    const Material& m = scene.materials.at(0);
    EXPECT_EQ(m.name, "all");
    EXPECT_TRUE(m.double_sided);
    EXPECT_EQ(m.alpha_mode, AlphaMode::mask);
    EXPECT_EQ(m.alpha_cutoff, 0.25);
    EXPECT_EQ(m.base_color, dvec4(0.1, 0.2, 0.3, 0.4));
    EXPECT_EQ(m.metallic, 0.5);
    EXPECT_EQ(m.roughness, 0.75);
    EXPECT_EQ(m.emission, dvec3(0.5, 0.25, 0));
    EXPECT_EQ(m.normal_scale, 0.5);
    EXPECT_EQ(m.occlusion_strength, 0.25);
    EXPECT_EQ(m.base_color_texture.texture, m.normal_texture.texture);
    EXPECT_EQ(m.metallic_roughness_texture.texture, m.occlusion_texture.texture);
    EXPECT_TRUE(m.emissive_texture.present());
    ASSERT_EQ(scene.images.size(), 2u);
    EXPECT_EQ(scene.images[scene.textures[m.base_color_texture.texture].image].bytes[0], 255);
    EXPECT_EQ(scene.images[scene.textures[m.metallic_roughness_texture.texture].image].bytes[0], 0);
    EXPECT_EQ(scene.meshes[0].primitives[0].tangents.size(), 3u) << "a normal map asks for tangents";
}

TEST(ImportMaterial, decodes_no_image_that_no_material_shows)
{
    GltfWriter file = textured_file(R"({"pbrMetallicRoughness":{"baseColorTexture":{"index":1}}})");
    file.add("images", R"({"uri":"nowhere.png"})");
    const Scene scene = file.load();
    EXPECT_EQ(scene.textures.size(), 1u);
    EXPECT_EQ(scene.images.size(), 1u);
}

TEST(ImportMaterial, reads_samplers)
{
    const auto sampler = [](const std::string& json) {
        return textured_file(R"({"pbrMetallicRoughness":{"baseColorTexture":{"index":0}}})", json)
            .load()
            .textures.at(0)
            .sampler;
    };
    const Sampler standard = sampler("{}");
    EXPECT_TRUE(standard.mipmapped);
    EXPECT_EQ(standard.wrap_u, Wrap::repeat);
    EXPECT_EQ(standard.mag, Filter::linear);
    const Sampler nearest = sampler(R"({"magFilter":9728,"minFilter":9728,"wrapS":33071,"wrapT":33648})");
    EXPECT_FALSE(nearest.mipmapped);
    EXPECT_EQ(nearest.mag, Filter::nearest);
    EXPECT_EQ(nearest.min, Filter::nearest);
    EXPECT_EQ(nearest.wrap_u, Wrap::clamp_to_edge);
    EXPECT_EQ(nearest.wrap_v, Wrap::mirrored_repeat);
    const Sampler mixed = sampler(R"({"minFilter":9986})");  // NEAREST_MIPMAP_LINEAR
    EXPECT_TRUE(mixed.mipmapped);
    EXPECT_EQ(mixed.min, Filter::nearest);
    EXPECT_EQ(mixed.mip, Filter::linear);
}

TEST(ImportMaterial, transforms_textures_as_the_extension_says)
{
    const Scene scene =
        textured_file(R"({"pbrMetallicRoughness":{"baseColorTexture":{"index":0,"texCoord":0,"extensions":
        {"KHR_texture_transform":{"offset":[0.25,0.5],"rotation":0.5,"scale":[2,3],"texCoord":1}}}}})")
            .load();
    const TextureUse& use = scene.materials[0].base_color_texture;
    EXPECT_EQ(use.uv_set, 1);
    const dvec3 at = use.transform * dvec3(0.3, 0.7, 1);
    // Scale, then turn with v growing downwards, then move.
    const double u = 0.6, v = 2.1;
    EXPECT_NEAR(at.x, 0.25 + std::cos(0.5) * u + std::sin(0.5) * v, 1e-12);
    EXPECT_NEAR(at.y, 0.5 - std::sin(0.5) * u + std::cos(0.5) * v, 1e-12);
}

TEST(ImportMaterial, names_the_formats_of_textures_that_it_does_not_read)
{
    const auto load = [](const std::string& texture) {
        GltfWriter file = textured_file(R"({"pbrMetallicRoughness":{"baseColorTexture":{"index":2}}})");
        file.add("textures", texture);
        return file.load();
    };
    for (const auto& [extension, format] :
         {std::pair("KHR_texture_basisu", "KTX 2"), std::pair("EXT_texture_avif", "AVIF"),
          std::pair("MSFT_texture_dds", "DDS")}) {
        const Scene alone = load(fmt::format(R"({{"extensions":{{"{}":{{"source":0}}}}}})", extension));
        EXPECT_THAT(alone.warnings, ElementsAre(testing::AllOf(HasSubstr("/textures/2"), HasSubstr(format))));
        EXPECT_FALSE(alone.materials[0].base_color_texture.present());
        const Scene with_another =
            load(fmt::format(R"({{"source":1,"extensions":{{"{}":{{"source":0}}}}}})", extension));
        EXPECT_TRUE(with_another.materials[0].base_color_texture.present()) << "the PNG is read instead";
    }
    const std::pair<const char*, std::string> files[] = {{"KTX 2", "\xabKTX 20\xbb\r\n\x1a\n"},
                                                         {"DDS", "DDS |"},
                                                         {"AVIF", std::string("\0\0\0\x1c"
                                                                              "ftypavif",
                                                                              12)}};
    for (const auto& [format, head] : files) {
        GltfWriter file = textured_file(R"({"pbrMetallicRoughness":{"baseColorTexture":{"index":2}}})");
        file.add("images",
                 fmt::format(R"({{"bufferView":{},"mimeType":"image/png"}})", file.add_view(test::bytes_of(head))));
        file.add("textures", R"({"source":2})");
        EXPECT_THAT(test::message_of([&] { file.load(); }), HasSubstr(fmt::format("it is {}, which", format)));
    }
}

TEST(ImportMaterial, shows_the_materials_of_the_chosen_variant)
{
    GltfWriter file = test::triangle_file();
    file.add("materials", R"({"name":"plain"})");
    file.add("materials", R"({"name":"red"})");
    file.member(
        R"("extensions":{"KHR_materials_variants":{"variants":[{"name":"blue"},{"name":"red"},{"name":"new"}]}})");
    file.show(R"("attributes":{"POSITION":0},"material":0,"extensions":{"KHR_materials_variants":{"mappings":
        [{"material":0,"variants":[0]},{"material":1,"variants":[1,2]}]}})");
    const auto shown = [&](const std::optional<std::string>& variant) {
        const Scene scene = file.load({.variant = variant});
        return scene.materials.at(scene.meshes.at(1).primitives.at(0).material).name;
    };
    EXPECT_EQ(shown({}), "plain");
    EXPECT_EQ(shown("blue"), "plain");
    EXPECT_EQ(shown("red"), "red");
    EXPECT_EQ(shown("new"), "red");
    EXPECT_THAT(test::message_of([&] { shown("rad"); }), HasSubstr("did you mean \"red\"?"));
    EXPECT_THAT(test::message_of([&] { shown("unlike any"); }), HasSubstr("blue, red, new"));
    EXPECT_THAT(test::message_of([] { test::triangle_file().load({.variant = "red"}); }),
                HasSubstr("no material variants"));
}

TEST(ImportMaterial, keeps_what_the_metadata_says_of_the_asset)
{
    const std::string text = R"({"asset":{"version":"2.0","extensions":{"KHR_xmp_json_ld":{"packet":1}}},
        "extensions":{"KHR_xmp_json_ld":{"packets":[{"dc:title":"other"},{"@context":{"dc":"http://purl.org/dc/"},
        "dc:title":{"@type":"rdf:Alt","rdf:_1":{"@language":"en","@value":"A chair"}},
        "dc:creator":{"@list":["Ada","Bo"]},"xmp:Rating":5}]}}})";
    const Scene scene = parse_gltf(test::bytes_of(text), "", "test.gltf");
    std::vector<std::string> lines;
    for (const Metadata& row : scene.metadata) lines.push_back(row.name + ": " + row.value);
    EXPECT_THAT(lines, testing::UnorderedElementsAre("dc:title: A chair", "dc:creator: Ada; Bo", "xmp:Rating: 5"));
}

TEST(ImportMaterial, reads_unlit_and_emissive_strength)
{
    GltfWriter file;
    file.add("materials", R"({"extensions":{"KHR_materials_unlit":{}},"emissiveFactor":[1,1,1]})");
    file.add("materials",
             R"({"emissiveFactor":[1,0.5,0],"extensions":{"KHR_materials_emissive_strength":{"emissiveStrength":8}}})");
    const Scene scene = file.load();
    EXPECT_EQ(scene.materials[0].model, BsdfModel::unlit);
    EXPECT_EQ(scene.materials[0].emission, dvec3(0));
    EXPECT_EQ(scene.materials[1].emission, dvec3(8, 4, 0));
}

TEST(ImportMaterial, reads_the_exact_BSDFs_of_extras_over_what_glTF_says)
{
    GltfWriter file;
    const auto add = [&](const std::string& bsdf) {
        file.add("materials", R"({"pbrMetallicRoughness":{"baseColorFactor":[1,1,1,1]},"extras":{"etalon":{"bsdf":)" +
                                  bsdf + R"(,"emission":"front"}}})");
    };
    add(R"({"type":"lambert","reflectance":[0.1,0.2,0.3]})");
    add(R"({"type":"mirror","reflectance":[0.9,0.8,0.7]})");
    add(R"({"type":"rough_conductor","distribution":"ggx","alpha":0.25,"eta":[1,2,3],"k":[4,5,6]})");
    add(R"({"type":"dielectric","ior":1.33})");
    add(R"({"type":"rough_dielectric","distribution":"ggx","alpha":0.125,"ior":1.5})");
    const auto m = file.load().materials;
    EXPECT_EQ(m[0].model, BsdfModel::lambert);
    EXPECT_EQ(dvec3(m[0].base_color), dvec3(0.1, 0.2, 0.3));
    EXPECT_TRUE(m[0].emits_front_only);
    EXPECT_EQ(m[1].model, BsdfModel::mirror);
    EXPECT_EQ(m[2].model, BsdfModel::rough_conductor);
    EXPECT_EQ(m[2].eta, dvec3(1, 2, 3));
    EXPECT_EQ(m[2].k, dvec3(4, 5, 6));
    EXPECT_EQ(m[2].ggx_alpha, 0.25);
    EXPECT_EQ(m[3].model, BsdfModel::dielectric);
    EXPECT_EQ(m[3].eta.x, 1.33);
    EXPECT_EQ(m[4].model, BsdfModel::rough_dielectric);
    EXPECT_EQ(m[4].ggx_alpha, 0.125);
    EXPECT_THROW(([&] {
                     GltfWriter bad;
                     bad.add("materials", R"({"extras":{"etalon":{"bsdf":{"type":"velvet"}}}})");
                     bad.load();
                 })(),
                 Error);
}

TEST(ImportNode, reads_matrices_and_translation_rotation_scale)
{
    GltfWriter file;
    file.add("nodes",
             R"({"translation":[1,2,3],"rotation":[0,0.7071067811865476,0,0.7071067811865476],"scale":[2,3,4]})");
    file.add("nodes", R"({"matrix":[0,0,-2,0, 0,3,0,0, 4,0,0,0, 1,2,3,1]})");
    const Scene scene = file.load();
    for (const Node& node : scene.nodes) {
        const dvec4 at = node.parent_from_node * dvec4(1, 1, 1, 1);
        EXPECT_NEAR(at.x, 1 + 4, 1e-12);
        EXPECT_NEAR(at.y, 2 + 3, 1e-12);
        EXPECT_NEAR(at.z, 3 - 2, 1e-12);
    }
}

TEST(ImportNode, reads_cameras_with_infinite_depth_orthographic_ones_and_lenses)
{
    GltfWriter file;
    file.add("cameras", R"({"type":"perspective","perspective":{"yfov":0.7,"znear":0.1}})");
    file.add("cameras", R"({"type":"orthographic","orthographic":{"xmag":2,"ymag":3,"znear":0,"zfar":9}})");
    file.add(
        "cameras",
        R"({"type":"perspective","perspective":{"yfov":0.7,"znear":0.1,"aspectRatio":2},"extras":{"etalon":{"thin_lens":{"aperture_radius":0.15,"focus_distance":7}}}})");
    const auto cameras = file.load().cameras;
    EXPECT_EQ(cameras[0].yfov, 0.7);
    EXPECT_FALSE(cameras[0].aspect);
    EXPECT_TRUE(cameras[1].orthographic);
    EXPECT_EQ(cameras[1].ymag, 3);
    EXPECT_EQ(cameras[2].lens.value().aperture_radius, 0.15);
    EXPECT_EQ(cameras[2].lens.value().focus_distance, 7);
}

TEST(ImportNode, reads_lights_visibility_and_instances)
{
    GltfWriter file = test::triangle_file();
    file.member(
        R"("extensions":{"KHR_lights_punctual":{"lights":[{"type":"point","color":[1,0.5,0.25],"intensity":3,"range":4},
        {"type":"spot","spot":{"innerConeAngle":0.1,"outerConeAngle":0.2}},{"type":"directional"}]}})");
    const int translations = file.add_floats({1, 0, 0, 0, 2, 0}, 3);
    const int rotations = file.add_accessor(file.add_view(std::vector<std::int16_t>{0, 0, 0, 32767, 0, 32767, 0, 0}),
                                            test::kShort, "VEC4", 2, R"(,"normalized":true)");
    file.add(
        "nodes",
        fmt::format(
            R"({{"mesh":0,"extensions":{{"KHR_lights_punctual":{{"light":1}},"KHR_node_visibility":{{"visible":false}},
        "EXT_mesh_gpu_instancing":{{"attributes":{{"TRANSLATION":{},"ROTATION":{}}}}}}}}})",
            translations, rotations));
    const Scene scene = file.load();
    ASSERT_EQ(scene.lights.size(), 3u);
    EXPECT_EQ(scene.lights[0].color, dvec3(1, 0.5, 0.25));
    EXPECT_EQ(scene.lights[0].range, 4);
    EXPECT_EQ(scene.lights[1].type, LightType::spot);
    EXPECT_EQ(scene.lights[1].outer_cone, 0.2);
    EXPECT_EQ(scene.lights[2].type, LightType::directional);
    EXPECT_EQ(scene.lights[2].intensity, 1);
    const Node& node = scene.nodes[1];
    EXPECT_EQ(node.light, 1u);
    EXPECT_FALSE(node.visible);
    ASSERT_EQ(node.instances.size(), 2u);
    EXPECT_EQ(dvec3(node.instances[0] * dvec4(1, 0, 0, 1)), dvec3(2, 0, 0));
    const dvec3 turned(node.instances[1] * dvec4(1, 0, 0, 1));  // half a turn about y, then up
    EXPECT_NEAR(turned.x, -1, 1e-12);
    EXPECT_NEAR(turned.y, 2, 1e-12);
}

TEST(ImportNode, reads_several_scenes_and_shows_loose_nodes_when_there_is_none)
{
    GltfWriter file = test::triangle_file();
    file.show(R"("attributes":{"POSITION":0})");
    file.add("nodes", R"({"children":[1]})");
    EXPECT_THAT(file.load().roots.at(0).nodes, ElementsAre(0, 2));
    file.add("scenes", R"({"name":"a","nodes":[0]})");
    file.add("scenes", R"({"name":"b","nodes":[2]})");
    file.member(R"("scene":1)");
    const Scene scene = file.load();
    ASSERT_EQ(scene.roots.size(), 2u);
    EXPECT_EQ(scene.default_root, 1u);
    EXPECT_EQ(pose(scene).draws.at(0).node, 1u);
    EXPECT_EQ(pose(scene, {.root = 0, .camera = {}, .orbit = {}, .size = {}, .environment = {}}).draws.at(0).node, 0u);
}

TEST(ImportNode, reads_the_scene_extras_of_etalon)
{
    const test::TemporaryDirectory folder;
    Image map(4, 2, 3);
    map.values.assign(24, 0.5f);
    write_png(map, {}, folder / "sky.png");
    GltfWriter file;
    file.add("materials", "{}");
    file.add("nodes", R"({"scale":[2,2,2],"extras":{"etalon":{"shape":{"type":"sphere","radius":0.5},"material":0}}})");
    file.add("scenes", R"({"nodes":[0],"extras":{"etalon":{"film":{"width":64,"height":32},"integrator":{"max_depth":5},
        "environment":{"file":"sky.png","rotation":0.7,"scale":2}}}})");
    file.add("scenes", R"({"nodes":[0],"extras":{"etalon":{"environment":{"radiance":[1,2,3]}}}})");
    const Scene scene = parse_gltf(file.glb(), folder.path(), "test.glb");
    EXPECT_EQ(scene.roots[0].hints.size.value(), ivec2(64, 32));
    EXPECT_EQ(scene.roots[0].hints.max_depth.value(), 5);
    ASSERT_TRUE(scene.roots[0].environment && scene.roots[0].environment->map);
    EXPECT_EQ(scene.roots[0].environment->map->width, 4);
    EXPECT_EQ(scene.roots[0].environment->rotation, 0.7);
    EXPECT_EQ(scene.roots[0].environment->scale, 2);
    EXPECT_EQ(scene.roots[1].environment.value().radiance, dvec3(1, 2, 3));
    const PosedScene posed = pose(scene);
    ASSERT_EQ(posed.spheres.size(), 1u);
    EXPECT_DOUBLE_EQ(posed.spheres[0].radius, 1);
    EXPECT_EQ(posed.view.width, 64);
}

TEST(ImportExtensions, refuses_a_required_one_that_is_lacking_by_name)
{
    GltfWriter file = test::triangle_file();
    file.member(R"("extensionsRequired":["KHR_texture_basisu"],"extensionsUsed":["KHR_texture_basisu"])");
    try {
        file.load();
        FAIL() << "loaded";
    } catch (const Error& error) {
        EXPECT_THAT(error.what(), HasSubstr("KHR_texture_basisu"));
        EXPECT_THAT(error.mend(), HasSubstr("gltf-transform"));
        EXPECT_EQ(error.exit_code(), 2);
    }
}

TEST(ImportExtensions, warns_once_of_an_optional_one_and_refuses_it_when_strict)
{
    GltfWriter file = test::triangle_file();
    file.member(R"("extensionsUsed":["VENDOR_sheen","KHR_materials_unlit","VENDOR_thing"])");
    EXPECT_THAT(file.load().warnings, ElementsAre(HasSubstr("VENDOR_sheen"), HasSubstr("VENDOR_thing")));
    EXPECT_THROW(file.load({.strict = true}), Error);
    GltfWriter flawless;
    flawless.add_accessor(flawless.add_view(test::kTriangle), test::kFloat, "VEC3", 3,
                          R"(,"min":[0,0,0],"max":[1,1,0])");
    flawless.show(R"("attributes":{"POSITION":0})");
    EXPECT_NO_THROW(flawless.load({.strict = true}));
}

TEST(ImportExtensions, lists_variants_and_animations)
{
    GltfWriter file = test::triangle_file();
    file.member(
        R"("extensionsUsed":["KHR_materials_variants"],"extensions":{"KHR_materials_variants":{"variants":[{"name":"red"},{"name":"blue"}]}})");
    file.add_floats({0, 1}, 1);
    file.add_floats({0, 0, 0, 1, 1, 1}, 3);
    file.add(
        "animations",
        R"({"name":"hop","channels":[{"sampler":0,"target":{"node":0,"path":"translation"}}],"samplers":[{"input":1,"output":2}]})");
    const Scene scene = file.load();
    EXPECT_THAT(scene.variants, ElementsAre("red", "blue"));
    ASSERT_EQ(scene.animations.size(), 1u);
    EXPECT_EQ(scene.animations[0].name, "hop");
    EXPECT_THAT(scene.warnings, ElementsAre());
}

}  // namespace
}  // namespace etalon
