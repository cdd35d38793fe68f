// Geometry of glTF: every primitive mode, component type, layout and computed attribute, on files made in memory.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "engine/base/error.h"
#include "engine/scene/pose.h"
#include "tests/unit/scene/gltf_writer.h"

namespace etalon {
namespace {

using test::GltfWriter;
using testing::ElementsAre;
using testing::HasSubstr;

// Five points in the plane with their neighbours in a strip, a fan or a loop.
const std::vector<float> kFive = {0, 0, 0, 1, 0, 0, 0, 1, 0, 1, 1, 0, 0.5f, 2, 0};

const Primitive& only_primitive(const Scene& scene)
{
    return scene.meshes.at(0).primitives.at(0);
}

struct Mode {
    const char* name;
    int mode;
    Topology topology;
    std::vector<std::uint32_t> indices;
};

TEST(ImportMesh, unrolls_every_primitive_mode)
{
    for (const Mode& mode :
         {Mode{"points", 0, Topology::points, {0, 1, 2, 3, 4}}, Mode{"lines", 1, Topology::lines, {0, 1, 2, 3}},
          Mode{"loop", 2, Topology::lines, {0, 1, 1, 2, 2, 3, 3, 4, 4, 0}},
          Mode{"line strip", 3, Topology::lines, {0, 1, 1, 2, 2, 3, 3, 4}}}) {
        GltfWriter file;
        file.add_floats(kFive, 3);
        file.show(fmt::format(R"("attributes":{{"POSITION":0}},"mode":{})", mode.mode));
        const Scene scene = file.load();
        EXPECT_EQ(only_primitive(scene).topology, mode.topology) << mode.name;
        EXPECT_EQ(only_primitive(scene).indices, mode.indices) << mode.name;
    }
    // Triangles without normals have three vertices each: compare positions. The strip keeps the winding of its first.
    for (const Mode& mode : {Mode{"triangles", 4, Topology::triangles, {0, 1, 2}},
                             Mode{"strip", 5, Topology::triangles, {0, 1, 2, 1, 3, 2, 2, 3, 4}},
                             Mode{"fan", 6, Topology::triangles, {1, 2, 0, 2, 3, 0, 3, 4, 0}}}) {
        GltfWriter file;
        file.add_floats(kFive, 3);
        file.show(fmt::format(R"("attributes":{{"POSITION":0}},"mode":{})", mode.mode));
        const Scene scene = file.load();
        const Primitive& p = only_primitive(scene);
        ASSERT_EQ(p.indices.size(), mode.indices.size()) << mode.name;
        for (std::size_t i = 0; i < mode.indices.size(); ++i) {
            const std::size_t at = 3 * mode.indices[i];
            EXPECT_EQ(p.positions[p.indices[i]], vec3(kFive[at], kFive[at + 1], kFive[at + 2]))
                << mode.name << " corner " << i;
        }
    }
}

TEST(ImportMesh, draws_points_and_lines_without_normals_unlit)
{
    GltfWriter file;
    file.add_floats(kFive, 3);
    file.add("materials", R"({"name":"ink","pbrMetallicRoughness":{"baseColorFactor":[1,0,0,1]}})");
    file.show(R"("attributes":{"POSITION":0},"mode":1,"material":0)");
    const Scene scene = file.load();
    const Material& material = scene.materials.at(only_primitive(scene).material);
    EXPECT_EQ(material.model, BsdfModel::unlit);
    EXPECT_EQ(material.base_color, dvec4(1, 0, 0, 1));
    EXPECT_EQ(scene.materials.at(0).model, BsdfModel::metallic_roughness);
}

template <typename T>
void expect_indices(int component_type)
{
    GltfWriter file;
    file.add_floats(kFive, 3);
    file.add_floats({0, 0, 1, 0, 0, 1, 0, 0, 1, 0, 0, 1, 0, 0, 1}, 3);
    file.add_accessor(file.add_view(std::vector<T>{0, 1, 2, 2, 1, 3}), component_type, "SCALAR", 6);
    file.show(R"("attributes":{"POSITION":0,"NORMAL":1},"indices":2)");
    EXPECT_THAT(only_primitive(file.load()).indices, ElementsAre(0, 1, 2, 2, 1, 3));
}

TEST(ImportMesh, reads_indices_of_every_type)
{
    expect_indices<std::uint8_t>(test::kUnsignedByte);
    expect_indices<std::uint16_t>(test::kUnsignedShort);
    expect_indices<std::uint32_t>(test::kUnsignedInt);
}

TEST(ImportMesh, computes_flat_normals_and_leaves_out_triangles_without_area)
{
    GltfWriter file;
    file.add_floats({0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1, 2, 0, 0}, 3);
    // Up, towards -x … and two that are a point and a segment.
    file.add_accessor(file.add_view(std::vector<std::uint16_t>{0, 1, 2, 0, 2, 3, 1, 1, 2, 0, 1, 4}),
                      test::kUnsignedShort, "SCALAR", 12);
    file.show(R"("attributes":{"POSITION":0},"indices":1)");
    const Scene scene = file.load();
    const Primitive& p = only_primitive(scene);
    EXPECT_FALSE(p.has_normals);
    ASSERT_EQ(p.indices.size(), 6u);
    for (int i = 0; i < 3; ++i) EXPECT_EQ(p.normals[p.indices[std::size_t(i)]], vec3(0, 0, 1));
    for (int i = 3; i < 6; ++i) EXPECT_EQ(p.normals[p.indices[std::size_t(i)]], vec3(1, 0, 0));
}

TEST(ImportMesh, normalizes_given_normals_and_mends_zero_ones)
{
    GltfWriter file;
    file.add_floats(test::kTriangle, 3);
    file.add_floats({0, 3, 0, 0, 0, 0, 0, 0, -2}, 3);
    file.show(R"("attributes":{"POSITION":0,"NORMAL":1})");
    const Scene scene = file.load();
    EXPECT_TRUE(only_primitive(scene).has_normals);
    EXPECT_THAT(only_primitive(scene).normals, ElementsAre(vec3(0, 1, 0), vec3(0, 0, 1), vec3(0, 0, -1)));
}

TEST(ImportMesh, reads_interleaved_attributes)
{
    GltfWriter file;
    std::vector<float> both;
    for (std::size_t i = 0; i < 3; ++i) {
        both.insert(both.end(), test::kTriangle.begin() + std::ptrdiff_t(3 * i),
                    test::kTriangle.begin() + std::ptrdiff_t(3 * i + 3));
        both.insert(both.end(), {0, 0, 1, float(i), 1 - float(i)});
    }
    const int view = file.add_view(both, 32);
    file.add_accessor(view, test::kFloat, "VEC3", 3);
    file.add_accessor(view, test::kFloat, "VEC3", 3, R"(,"byteOffset":12)");
    file.add_accessor(view, test::kFloat, "VEC2", 3, R"(,"byteOffset":24)");
    file.show(R"("attributes":{"POSITION":0,"NORMAL":1,"TEXCOORD_0":2})");
    const Scene scene = file.load();
    const Primitive& p = only_primitive(scene);
    EXPECT_THAT(p.positions, ElementsAre(vec3(0, 0, 0), vec3(1, 0, 0), vec3(0, 1, 0)));
    EXPECT_THAT(p.uv[0], ElementsAre(vec2(0, 1), vec2(1, 0), vec2(2, -1)));
}

TEST(ImportMesh, reads_quantized_attributes)
{
    GltfWriter file;
    // Positions as plain shorts, normals and uv normalized (KHR_mesh_quantization), padded to four bytes.
    file.add_accessor(file.add_view(std::vector<std::int16_t>{0, 0, 0, 0, 100, 0, 0, 0, 0, -300, 0, 0}, 8),
                      test::kShort, "VEC3", 3);
    file.add_accessor(file.add_view(std::vector<std::int8_t>{0, 0, 127, 0, 0, 0, 127, 0, 0, 0, -128, 0}, 4),
                      test::kByte, "VEC3", 3, R"(,"normalized":true)");
    file.add_accessor(file.add_view(std::vector<std::uint16_t>{0, 65535, 32768, 0, 1, 2}, 4), test::kUnsignedShort,
                      "VEC2", 3, R"(,"normalized":true)");
    file.add_accessor(file.add_view(std::vector<std::uint8_t>{3, 4, 0, 0, 5, 6, 0, 0, 7, 8, 0, 0}, 4),
                      test::kUnsignedByte, "VEC2", 3);
    file.member(R"("extensionsRequired":["KHR_mesh_quantization"],"extensionsUsed":["KHR_mesh_quantization"])");
    file.show(R"("attributes":{"POSITION":0,"NORMAL":1,"TEXCOORD_0":2,"TEXCOORD_1":3})");
    const Scene scene = file.load();
    const Primitive& p = only_primitive(scene);
    EXPECT_THAT(p.positions, ElementsAre(vec3(0), vec3(100, 0, 0), vec3(0, -300, 0)));
    EXPECT_THAT(p.normals, ElementsAre(vec3(0, 0, 1), vec3(0, 0, 1), vec3(0, 0, -1)));
    EXPECT_THAT(p.uv[0], ElementsAre(vec2(0, 1), vec2(32768 / 65535.0f, 0), vec2(1 / 65535.0f, 2 / 65535.0f)));
    EXPECT_THAT(p.uv[1], ElementsAre(vec2(3, 4), vec2(5, 6), vec2(7, 8)));
    EXPECT_TRUE(scene.warnings.empty());
}

TEST(ImportMesh, reads_colours_with_and_without_alpha)
{
    GltfWriter file;
    file.add_floats(test::kTriangle, 3);
    file.add_floats({1, 0, 0, 0, 1, 0, 0, 0, 1}, 3);
    file.add_accessor(file.add_view(std::vector<std::uint8_t>{255, 0, 0, 51, 0, 255, 0, 102, 0, 0, 255, 255}),
                      test::kUnsignedByte, "VEC4", 3, R"(,"normalized":true)");
    file.show(R"("attributes":{"POSITION":0,"COLOR_0":1})");
    file.show(R"("attributes":{"POSITION":0,"COLOR_0":2})");
    const Scene scene = file.load();
    EXPECT_THAT(scene.meshes[0].primitives[0].colors,
                ElementsAre(vec4(1, 0, 0, 1), vec4(0, 1, 0, 1), vec4(0, 0, 1, 1)));
    EXPECT_THAT(scene.meshes[1].primitives[0].colors,
                ElementsAre(vec4(1, 0, 0, 0.2f), vec4(0, 1, 0, 0.4f), vec4(0, 0, 1, 1)));
}

TEST(ImportMesh, reads_sparse_accessors_with_and_without_a_base)
{
    GltfWriter file;
    const int base = file.add_view(test::kTriangle);
    const int places = file.add_view(std::vector<std::uint16_t>{1, 2});
    const int values = file.add_view(std::vector<float>{5, 0, 0, 0, 6, 0});
    const std::string sparse = fmt::format(
        R"(,"sparse":{{"count":2,"indices":{{"bufferView":{},"componentType":5123}},"values":{{"bufferView":{}}}}})",
        places, values);
    file.add_accessor(base, test::kFloat, "VEC3", 3, sparse);
    file.add("accessors", R"({"componentType":5126,"type":"VEC3","count":3)" + sparse + "}");
    file.show(R"("attributes":{"POSITION":0})");
    file.show(R"("attributes":{"POSITION":1})");
    const Scene scene = file.load();
    for (const Mesh& mesh : scene.meshes)
        EXPECT_THAT(mesh.primitives[0].positions, ElementsAre(vec3(0), vec3(5, 0, 0), vec3(0, 6, 0)));
}

TEST(ImportMesh, keeps_only_the_vertices_that_a_primitive_uses_of_a_long_shared_list)
{
    GltfWriter file;
    std::vector<float> many;
    for (int i = 0; i < 100; ++i) many.insert(many.end(), {float(i), float(i * i), 0});
    file.add_floats(many, 3);
    file.add_accessor(file.add_view(std::vector<std::uint16_t>{97, 98, 99}), test::kUnsignedShort, "SCALAR", 3);
    file.show(R"("attributes":{"POSITION":0},"indices":1,"mode":0)");
    const Scene scene = file.load();
    EXPECT_THAT(only_primitive(scene).positions,
                ElementsAre(vec3(97, 97 * 97, 0), vec3(98, 98 * 98, 0), vec3(99, 99 * 99, 0)));
    EXPECT_THAT(only_primitive(scene).indices, ElementsAre(0, 1, 2));
}

TEST(ImportMesh, skips_a_primitive_without_positions_with_a_warning)
{
    GltfWriter file;
    file.add_floats(test::kTriangle, 3);
    file.show(R"("attributes":{"NORMAL":0})");
    const Scene scene = file.load();
    EXPECT_TRUE(scene.meshes[0].primitives.empty());
    ASSERT_EQ(scene.warnings.size(), 1u);
    EXPECT_THAT(scene.warnings[0], HasSubstr("/meshes/0/primitives/0"));
}

TEST(ImportMesh, gives_primitives_without_a_material_the_standard_one)
{
    GltfWriter file = test::triangle_file();
    file.show(R"("attributes":{"POSITION":0})");
    const Scene scene = file.load();
    ASSERT_EQ(scene.materials.size(), 1u);
    EXPECT_EQ(scene.materials[0].metallic, 1);
    EXPECT_EQ(scene.materials[0].roughness, 1);
    EXPECT_EQ(scene.materials[0].base_color, dvec4(1));
    EXPECT_EQ(scene.meshes[1].primitives[0].material, 0u);
}

}  // namespace
}  // namespace etalon
