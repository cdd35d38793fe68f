// Material extensions of glTF that add layers, on files made in memory.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "engine/base/error.h"
#include "engine/image/io.h"
#include "tests/support/errors.h"
#include "tests/unit/scene/gltf_writer.h"

namespace etalon {
namespace {

using test::GltfWriter;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

// A triangle with a material, and six textures of one image.
GltfWriter file_with(const std::string& material, const std::string& attributes = R"("TEXCOORD_0":1,)")
{
    Image image(1, 1, 3);
    image.values.assign(3, 0.5f);
    GltfWriter file;
    file.add_floats(test::kTriangle, 3);
    file.add_floats({0, 1, 1, 1, 0, 0}, 2);
    file.add_floats({0, 0, 1, 0, 0, 1, 0, 0, 1}, 3);
    file.add("images",
             fmt::format(R"({{"bufferView":{},"mimeType":"image/png"}})", file.add_view(encode_png(image, {}))));
    for (int i = 0; i < 6; ++i) file.add("textures", R"({"source":0})");
    file.add("materials", material);
    file.show(fmt::format(R"("attributes":{{"POSITION":0,{}"NORMAL":2}},"material":0)", attributes));
    return file;
}

// A dielectric with these extensions.
Scene load(const std::string& extensions)
{
    return file_with(R"({"pbrMetallicRoughness":{"metallicFactor":0},"extensions":{)" + extensions + "}}").load();
}

MaterialLayers layers_of(const std::string& extensions)
{
    return load(extensions).materials.at(0).layers.value();
}

TEST(ImportLayers, reads_every_value_and_texture_of_each_extension)
{
    const MaterialLayers a = layers_of(
        R"("KHR_materials_ior":{"ior":1.33},
        "KHR_materials_specular":{"specularFactor":0.25,"specularTexture":{"index":0},"specularColorFactor":[0.5,2,3],
        "specularColorTexture":{"index":1,"texCoord":1}},
        "KHR_materials_clearcoat":{"clearcoatFactor":0.5,"clearcoatTexture":{"index":2},"clearcoatRoughnessFactor":0.75,
        "clearcoatRoughnessTexture":{"index":3},"clearcoatNormalTexture":{"index":4,"scale":0.125}},
        "KHR_materials_sheen":{"sheenColorFactor":[0.1,0.2,0.3],"sheenColorTexture":{"index":0},
        "sheenRoughnessFactor":0.4,"sheenRoughnessTexture":{"index":5}})");
    EXPECT_EQ(a.ior, 1.33);
    EXPECT_EQ(a.specular, 0.25);
    EXPECT_EQ(a.specular_color, dvec3(0.5, 2, 3)) << "may be above 1";
    EXPECT_EQ(a.specular_texture.texture, 0u);
    EXPECT_EQ(a.specular_color_texture.texture, 1u);
    EXPECT_EQ(a.specular_color_texture.uv_set, 1);
    EXPECT_EQ(a.clearcoat, 0.5);
    EXPECT_EQ(a.clearcoat_roughness, 0.75);
    EXPECT_EQ(a.clearcoat_normal_scale, 0.125);
    EXPECT_EQ(a.sheen_color, dvec3(0.1, 0.2, 0.3));
    EXPECT_EQ(a.sheen_roughness, 0.4);
    EXPECT_EQ(a.sheen_color_texture.texture, a.specular_texture.texture);
    for (const TextureUse* use : {&a.clearcoat_texture, &a.clearcoat_roughness_texture, &a.clearcoat_normal_texture,
                                  &a.sheen_roughness_texture})
        EXPECT_TRUE(use->present());

    const MaterialLayers b = layers_of(
        R"("KHR_materials_transmission":{"transmissionFactor":0.5,"transmissionTexture":{"index":0}},
        "KHR_materials_volume":{"thicknessFactor":2,"thicknessTexture":{"index":1},"attenuationDistance":3,
        "attenuationColor":[0.5,0.25,0]},"KHR_materials_dispersion":{"dispersion":4},
        "KHR_materials_iridescence":{"iridescenceFactor":0.5,"iridescenceTexture":{"index":2},"iridescenceIor":1.75,
        "iridescenceThicknessMinimum":500,"iridescenceThicknessMaximum":200,"iridescenceThicknessTexture":{"index":3}},
        "KHR_materials_anisotropy":{"anisotropyStrength":0.5,"anisotropyRotation":-7,"anisotropyTexture":{"index":4}},
        "KHR_materials_diffuse_transmission":{"diffuseTransmissionFactor":0.25,"diffuseTransmissionTexture":{"index":5},
        "diffuseTransmissionColorFactor":[0.1,0.2,0.3],"diffuseTransmissionColorTexture":{"index":0,
        "extensions":{"KHR_texture_transform":{"offset":[0.5,0.25]}}}})");
    EXPECT_EQ(b.transmission, 0.5);
    EXPECT_EQ(b.thickness, 2);
    EXPECT_EQ(b.attenuation_distance, 3);
    EXPECT_EQ(b.attenuation_color, dvec3(0.5, 0.25, 0));
    EXPECT_EQ(b.dispersion, 4);
    EXPECT_TRUE(b.volumetric());
    EXPECT_EQ(b.iridescence, 0.5);
    EXPECT_EQ(b.iridescence_ior, 1.75);
    EXPECT_EQ(b.iridescence_thickness_min, 500) << "may be above the maximum";
    EXPECT_EQ(b.iridescence_thickness_max, 200);
    EXPECT_EQ(b.anisotropy, 0.5);
    EXPECT_EQ(b.anisotropy_rotation, -7);
    EXPECT_EQ(b.diffuse_transmission, 0.25);
    EXPECT_EQ(b.diffuse_transmission_color, dvec3(0.1, 0.2, 0.3));
    EXPECT_EQ(b.diffuse_transmission_color_texture.transform[2], dvec3(0.5, 0.25, 1));
    for (const TextureUse* use :
         {&b.transmission_texture, &b.thickness_texture, &b.iridescence_texture, &b.iridescence_thickness_texture,
          &b.anisotropy_texture, &b.diffuse_transmission_texture, &b.diffuse_transmission_color_texture})
        EXPECT_TRUE(use->present());
}

TEST(ImportLayers, are_left_out_where_they_change_nothing_and_decode_nothing)
{
    for (const char* inert : {
             R"("KHR_materials_ior":{"ior":1.5})",
             R"("KHR_materials_specular":{})",
             R"("KHR_materials_clearcoat":{"clearcoatRoughnessFactor":0.5,"clearcoatTexture":{"index":0},
             "clearcoatNormalTexture":{"index":1}})",
             R"("KHR_materials_sheen":{"sheenRoughnessFactor":1,"sheenColorTexture":{"index":0}})",
             R"("KHR_materials_transmission":{"transmissionTexture":{"index":0}})",
             R"("KHR_materials_volume":{"thicknessFactor":1,"thicknessTexture":{"index":0}},
             "KHR_materials_dispersion":{"dispersion":1})",
             R"("KHR_materials_iridescence":{"iridescenceTexture":{"index":0}})",
             R"("KHR_materials_iridescence":{"iridescenceFactor":1,"iridescenceThicknessMaximum":0})",
             R"("KHR_materials_anisotropy":{"anisotropyRotation":1,"anisotropyTexture":{"index":0}})",
             R"("KHR_materials_diffuse_transmission":{"diffuseTransmissionColorFactor":[1,0,0]})",
         }) {
        const Scene scene = load(inert);
        EXPECT_FALSE(scene.materials[0].layers) << inert;
        EXPECT_THAT(scene.images, IsEmpty()) << inert;
        EXPECT_THAT(scene.warnings, IsEmpty()) << inert;
        EXPECT_THAT(scene.meshes[0].primitives[0].tangents, IsEmpty()) << inert;
    }
}

TEST(ImportLayers, of_an_animated_material_are_kept_since_they_may_show_later)
{
    GltfWriter file = file_with(
        R"({"emissiveTexture":{"index":1},"extensions":{"KHR_materials_clearcoat":{"clearcoatTexture":{"index":0}}}})");
    const int times = file.add_floats({0, 1}, 1);
    const int strengths = file.add_floats({0, 1}, 1);
    file.add("animations", fmt::format(R"({{"channels":[{{"sampler":0,"target":{{"path":"pointer","extensions":{{
        "KHR_animation_pointer":{{"pointer":"/materials/0/extensions/KHR_materials_clearcoat/clearcoatFactor"}}}}}}}}],
        "samplers":[{{"input":{},"output":{}}}]}})",
                                       times, strengths));
    const Material material = file.load().materials.at(0);
    ASSERT_TRUE(material.layers);
    EXPECT_EQ(material.layers->clearcoat, 0);
    EXPECT_TRUE(material.layers->clearcoat_texture.present());
    EXPECT_TRUE(material.emissive_texture.present());
}

TEST(ImportLayers, of_the_dielectric_part_do_not_show_on_a_metal)
{
    const auto with_base = [](const std::string& base) {
        return file_with(R"({"pbrMetallicRoughness":{)" + base +
                         R"(},"extensions":{"KHR_materials_ior":{"ior":2},"KHR_materials_specular":{"specularFactor":0},
        "KHR_materials_transmission":{"transmissionFactor":1},"KHR_materials_volume":{"thicknessFactor":1},
        "KHR_materials_diffuse_transmission":{"diffuseTransmissionFactor":1}}})")
            .load()
            .materials.at(0)
            .layers;
    };
    EXPECT_FALSE(with_base(R"("metallicFactor":1)"));
    EXPECT_TRUE(with_base(R"("metallicFactor":0.5)").value().volumetric());
    EXPECT_TRUE(with_base(R"("metallicRoughnessTexture":{"index":0})").value().volumetric());
}

TEST(ImportLayers, values_out_of_range_are_drawn_as_the_nearest_within_and_said)
{
    const auto warning = [](const std::string& extensions) {
        const Scene scene = load(extensions);
        EXPECT_EQ(scene.warnings.size(), 1u) << extensions;
        return scene.warnings.empty() ? std::string() : scene.warnings.front();
    };
    EXPECT_THAT(warning(R"("KHR_materials_clearcoat":{"clearcoatFactor":1.5})"),
                HasSubstr("/materials/0/extensions/KHR_materials_clearcoat/clearcoatFactor: 1.5 is taken as 1 "
                          "[VALUE_NOT_IN_RANGE]"));
    EXPECT_THAT(warning(R"("KHR_materials_ior":{"ior":0.5})"), HasSubstr("taken as 1"));
    EXPECT_THAT(warning(R"("KHR_materials_volume":{"attenuationDistance":0})"), HasSubstr("nothing is absorbed"));
    EXPECT_THAT(warning(R"("KHR_materials_sheen":{"sheenColorFactor":[0,-1,0]})"), HasSubstr("-1 is taken as 0"));
    EXPECT_EQ(layers_of(R"("KHR_materials_ior":{"ior":0})").ior, 0) << "infinite";
    EXPECT_EQ(layers_of(R"("KHR_materials_iridescence":{"iridescenceFactor":1,"iridescenceIor":0.5})").iridescence_ior,
              1);
}

TEST(ImportLayers, wrong_types_and_indices_are_refused_with_their_place)
{
    const auto message = [](const std::string& extensions) { return test::message_of([&] { load(extensions); }); };
    EXPECT_THAT(message(R"("KHR_materials_sheen":{"sheenColorFactor":[1,1]})"),
                HasSubstr("/materials/0/extensions/KHR_materials_sheen/sheenColorFactor"));
    EXPECT_THAT(message(R"("KHR_materials_ior":{"ior":"high"})"), HasSubstr("KHR_materials_ior/ior"));
    EXPECT_THAT(message(R"("KHR_materials_sheen":3)"), HasSubstr("TYPE_MISMATCH"));
    EXPECT_THAT(message(R"("KHR_materials_clearcoat":{"clearcoatTexture":{"index":99}})"),
                HasSubstr("UNRESOLVED_REFERENCE"));
    EXPECT_THAT(message(R"("KHR_materials_clearcoat":{"clearcoatFactor":1,"clearcoatTexture":{"texCoord":1}})"),
                HasSubstr("UNDEFINED_PROPERTY"));
    EXPECT_THAT(message(R"("KHR_materials_pbrSpecularGlossiness":{"diffuseFactor":[1,1,1]})"),
                HasSubstr("diffuseFactor"));
}

TEST(ImportLayers, specular_glossiness_takes_the_place_of_the_metallic_roughness_model)
{
    const Scene scene =
        file_with(
            R"({"pbrMetallicRoughness":{"baseColorFactor":[1,0,0,1],"metallicRoughnessTexture":{"index":5}},
        "extensions":{"KHR_materials_pbrSpecularGlossiness":{"diffuseFactor":[0.1,0.2,0.3,0.5],
        "diffuseTexture":{"index":0},"specularFactor":[0.4,0.5,0.6],"glossinessFactor":0.75,
        "specularGlossinessTexture":{"index":1}},"KHR_materials_ior":{"ior":2}}})")
            .load();
    const Material& m = scene.materials.at(0);
    EXPECT_EQ(m.model, BsdfModel::specular_glossiness);
    EXPECT_EQ(m.base_color, dvec4(0.1, 0.2, 0.3, 0.5));
    EXPECT_EQ(m.k, dvec3(0.4, 0.5, 0.6));
    EXPECT_EQ(m.roughness, 0.25);
    EXPECT_EQ(m.base_color_texture.texture, 0u);
    EXPECT_EQ(m.metallic_roughness_texture.texture, 1u);
    EXPECT_EQ(scene.textures.size(), 2u) << "the other model's textures are not shown";
    EXPECT_FALSE(m.layers);
    EXPECT_THAT(scene.warnings, ElementsAre(HasSubstr("MULTIPLE_EXTENSIONS")));
    const Material standard = load(R"("KHR_materials_pbrSpecularGlossiness":{})").materials.at(0);
    EXPECT_EQ(standard.base_color, dvec4(1));
    EXPECT_EQ(standard.k, dvec3(1));
    EXPECT_EQ(standard.roughness, 0);
}

TEST(ImportLayers, unlit_materials_have_none)
{
    const Scene scene = load(
        R"("KHR_materials_unlit":{},"KHR_materials_clearcoat":{"clearcoatFactor":1,"clearcoatTexture":{"index":0}})");
    EXPECT_EQ(scene.materials[0].model, BsdfModel::unlit);
    EXPECT_FALSE(scene.materials[0].layers);
    EXPECT_THAT(scene.images, IsEmpty());
    EXPECT_THAT(scene.warnings, ElementsAre(HasSubstr("KHR_materials_clearcoat")));
}

TEST(ImportLayers, anisotropy_and_coat_normals_have_tangents_of_their_uv_set)
{
    const auto tangents = [](const std::string& extensions, const std::string& attributes) {
        const Scene scene = file_with(R"({"extensions":{)" + extensions + "}}", attributes).load();
        return std::pair(scene.meshes[0].primitives[0].tangents.size(), scene.warnings);
    };
    const std::string brushed = R"("KHR_materials_anisotropy":{"anisotropyStrength":0.5})";
    const std::string brushed_by_map =
        R"("KHR_materials_anisotropy":{"anisotropyStrength":0.5,"anisotropyTexture":{"index":0,"texCoord":1}})";
    const std::string coat = R"("KHR_materials_clearcoat":{"clearcoatFactor":1,"clearcoatNormalTexture":{"index":0}})";
    EXPECT_EQ(tangents(brushed, R"("TEXCOORD_0":1,)"), std::pair(std::size_t{3}, std::vector<std::string>{}));
    EXPECT_EQ(tangents(coat, R"("TEXCOORD_0":1,)"), std::pair(std::size_t{3}, std::vector<std::string>{}));
    EXPECT_EQ(tangents(brushed_by_map, R"("TEXCOORD_1":1,)"), std::pair(std::size_t{3}, std::vector<std::string>{}));
    EXPECT_THAT(tangents(brushed_by_map, R"("TEXCOORD_0":1,)").second, ElementsAre(HasSubstr("no TEXCOORD_1")));
    EXPECT_THAT(tangents(brushed, "").second, ElementsAre(HasSubstr("its direction is arbitrary")));
}

}  // namespace
}  // namespace etalon
