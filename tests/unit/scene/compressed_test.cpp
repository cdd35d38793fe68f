// Compression extensions: what the libraries' own encoders wrote comes back, and what is damaged is refused.
#include <draco/compression/encode.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <meshoptimizer.h>

#include <random>

#include "engine/scene/compressed.h"
#include "tests/support/errors.h"
#include "tests/unit/scene/gltf_writer.h"

namespace etalon {
namespace {

using test::GltfWriter;
using test::message_of;
using testing::HasSubstr;

std::vector<std::byte> as_bytes(const std::vector<unsigned char>& in)
{
    const auto* data = reinterpret_cast<const std::byte*>(in.data());
    return {data, data + in.size()};
}

std::vector<std::byte> encoded_positions(const std::vector<float>& values)
{
    std::vector<unsigned char> out(meshopt_encodeVertexBufferBound(values.size() / 3, 12));
    out.resize(meshopt_encodeVertexBuffer(out.data(), out.size(), values.data(), values.size() / 3, 12));
    return as_bytes(out);
}

std::vector<std::byte> encoded_triangles(const std::vector<unsigned>& indices, std::size_t vertices)
{
    std::vector<unsigned char> out(meshopt_encodeIndexBufferBound(indices.size(), vertices));
    out.resize(meshopt_encodeIndexBuffer(out.data(), out.size(), indices.data(), indices.size()));
    return as_bytes(out);
}

// A triangle whose positions and indices are meshopt's.
std::vector<std::byte> meshopt_file(const std::string& extension, const std::vector<std::byte>& positions)
{
    const std::vector<std::byte> triangles = encoded_triangles({0, 1, 2}, 3);
    std::vector<std::byte> binary = positions;
    while (binary.size() % 4 != 0) binary.push_back(std::byte{0});
    const std::size_t at = binary.size();
    binary.insert(binary.end(), triangles.begin(), triangles.end());
    const std::string json = fmt::format(
        R"({{"asset":{{"version":"2.0"}},"extensionsUsed":["{0}"],"extensionsRequired":["{0}"],)"
        R"("buffers":[{{"byteLength":{1}}},{{"byteLength":48,"extensions":{{"{0}":{{"fallback":true}}}}}}],"bufferViews":[)"
        R"({{"buffer":1,"byteLength":36,"byteStride":12,"extensions":{{"{0}":{{"buffer":0,"byteLength":{2},"byteStride":12,"count":3,"mode":"ATTRIBUTES"}}}}}},)"
        R"({{"buffer":1,"byteOffset":36,"byteLength":6,"extensions":{{"{0}":{{"buffer":0,"byteOffset":{3},"byteLength":{4},"byteStride":2,"count":3,"mode":"TRIANGLES"}}}}}}],)"
        R"("accessors":[{{"bufferView":0,"componentType":5126,"type":"VEC3","count":3,"min":[0,0,0],"max":[1,1,0]}},{{"bufferView":1,"componentType":5123,"type":"SCALAR","count":3}}],)"
        R"("meshes":[{{"primitives":[{{"attributes":{{"POSITION":0}},"indices":1}}]}}],"nodes":[{{"mesh":0}}]}})",
        extension, binary.size(), positions.size(), at, triangles.size());
    return GltfWriter::glb(json, binary);
}

TEST(Compressed, meshopt_views_are_read_as_what_they_were)
{
    for (const char* name : {"EXT_meshopt_compression", "KHR_meshopt_compression"}) {
        const Scene scene = parse_gltf(meshopt_file(name, encoded_positions(test::kTriangle)), "", "test.glb");
        const Primitive& p = scene.meshes.at(0).primitives.at(0);
        EXPECT_THAT(p.positions, testing::ElementsAre(vec3(0, 0, 0), vec3(1, 0, 0), vec3(0, 1, 0))) << name;
    }
}

TEST(Compressed, meshopt_says_what_it_cannot_read)
{
    std::vector<std::byte> newer = encoded_positions(test::kTriangle);
    newer[0] = std::byte{0xa1};
    EXPECT_THAT(message_of([&] { decode_meshopt(newer, MeshoptMode::attributes, MeshoptFilter::none, 3, 12); }),
                HasSubstr("version 1"));
    std::vector<std::byte> cut = encoded_positions(test::kTriangle);
    cut.pop_back();
    EXPECT_THAT(message_of([&] { decode_meshopt(cut, MeshoptMode::attributes, MeshoptFilter::none, 3, 12); }),
                HasSubstr("damaged"));
    EXPECT_THAT(message_of([&] { parse_gltf(meshopt_file("EXT_meshopt_compression", newer), "", "test.glb"); }),
                HasSubstr("/bufferViews/0/extensions/EXT_meshopt_compression"));
}

TEST(Compressed, meshopt_filters_give_back_directions)
{
    const std::vector<float> directions = {0.6f, 0.8f, 0, 1, 0, -0.6f, -0.8f, 1};
    std::vector<std::uint32_t> packed(2);
    meshopt_encodeFilterOct(packed.data(), 2, 4, 8, directions.data());
    std::vector<unsigned char> coded(meshopt_encodeVertexBufferBound(2, 4));
    coded.resize(meshopt_encodeVertexBuffer(coded.data(), coded.size(), packed.data(), 2, 4));
    const std::vector<std::byte> out =
        decode_meshopt(as_bytes(coded), MeshoptMode::attributes, MeshoptFilter::octahedral, 2, 4);
    const auto component = [&](std::size_t i) { return std::to_integer<std::int8_t>(out[i]) / 127.0; };
    EXPECT_NEAR(component(0), 0.6, 0.02);
    EXPECT_NEAR(component(1), 0.8, 0.02);
    EXPECT_NEAR(component(5), -0.6, 0.02);
    EXPECT_NEAR(component(6), -0.8, 0.02);
}

// Two triangles that share an edge; ids 0 (positions) and 1 (colours of 8 bits).
std::vector<std::byte> draco_payload(int method)
{
    draco::Mesh mesh;
    mesh.set_num_points(4);
    draco::GeometryAttribute positions, colors;
    positions.Init(draco::GeometryAttribute::POSITION, nullptr, 3, draco::DT_FLOAT32, false, 12, 0);
    colors.Init(draco::GeometryAttribute::COLOR, nullptr, 4, draco::DT_UINT8, true, 4, 0);
    const int p = mesh.AddAttribute(positions, true, 4);
    const int c = mesh.AddAttribute(colors, true, 4);
    for (std::uint32_t i = 0; i < 4; ++i) {
        const float at[3] = {static_cast<float>(i % 2), static_cast<float>(i / 2), 0.5f};
        const std::uint8_t color[4] = {static_cast<std::uint8_t>(10 * i), 0, 255, 255};
        mesh.attribute(p)->SetAttributeValue(draco::AttributeValueIndex(i), at);
        mesh.attribute(c)->SetAttributeValue(draco::AttributeValueIndex(i), color);
    }
    mesh.AddFace({draco::PointIndex(0), draco::PointIndex(1), draco::PointIndex(2)});
    mesh.AddFace({draco::PointIndex(2), draco::PointIndex(1), draco::PointIndex(3)});
    draco::Encoder encoder;
    encoder.SetEncodingMethod(method);
    draco::EncoderBuffer buffer;
    if (!encoder.EncodeMeshToBuffer(mesh, &buffer).ok()) return {};
    const auto* data = reinterpret_cast<const std::byte*>(buffer.data());
    return {data, data + buffer.size()};
}

const std::vector<DracoWish> kWishes = {{.id = 0, .component_type = test::kFloat, .components = 3, .count = 4},
                                        {.id = 1, .component_type = test::kUnsignedByte, .components = 4, .count = 4}};

TEST(Compressed, draco_meshes_come_back_whole)
{
    for (const int method : {draco::MESH_SEQUENTIAL_ENCODING, draco::MESH_EDGEBREAKER_ENCODING}) {
        const DracoMesh mesh = decode_draco(draco_payload(method), kWishes);
        ASSERT_EQ(mesh.corners.size(), 6u);
        double area = 0;
        for (std::size_t i = 0; i < 6; i += 3) {
            const auto corner = [&](std::size_t c) {
                std::array<float, 3> v{};
                std::memcpy(v.data(), &mesh.attributes[0][12 * mesh.corners[i + c]], 12);
                return dvec3(v[0], v[1], v[2]);
            };
            area += cross(corner(1) - corner(0), corner(2) - corner(0)).z / 2;
            for (std::size_t c = 0; c < 3; ++c) {
                const double red = std::to_integer<int>(mesh.attributes[1][4 * mesh.corners[i + c]]);
                EXPECT_EQ(red, 10 * (corner(c).x + 2 * corner(c).y)) << "colours stay with their vertices";
            }
        }
        EXPECT_EQ(area, 1) << "both faces, wound as they were";
    }
}

TEST(Compressed, draco_that_is_not_what_the_accessors_say_is_refused)
{
    const std::vector<std::byte> payload = draco_payload(draco::MESH_EDGEBREAKER_ENCODING);
    std::vector<DracoWish> wishes = kWishes;
    wishes[0].id = 7;
    EXPECT_THAT(message_of([&] { decode_draco(payload, wishes); }), HasSubstr("no attribute 7"));
    wishes = kWishes;
    wishes[0].count = 5;
    EXPECT_THAT(message_of([&] { decode_draco(payload, wishes); }), HasSubstr("its accessor has 5"));
    wishes = kWishes;
    wishes[1].components = 3;
    EXPECT_THAT(message_of([&] { decode_draco(payload, wishes); }), HasSubstr("of 3"));
}

TEST(Compressed, cut_and_flipped_draco_payloads_decode_or_are_refused)
{
    const std::vector<std::byte> payload = draco_payload(draco::MESH_EDGEBREAKER_ENCODING);
    std::mt19937 random(4);
    int refused = 0;
    const auto attempt = [&](const std::vector<std::byte>& broken) {
        try {
            const DracoClaim claim = read_draco_header(broken);
            if (claim.vertices > 4 || claim.faces > 2) return;  // what preflight refuses
            const DracoMesh mesh = decode_draco(broken, kWishes);
            for (const std::uint32_t corner : mesh.corners) EXPECT_LT(corner, 4u);
        } catch (const Error&) {
            ++refused;
        }
    };
    for (std::size_t size = 0; size < payload.size(); ++size)
        attempt({payload.begin(), payload.begin() + static_cast<std::ptrdiff_t>(size)});
    for (int i = 0; i < 300; ++i) {
        std::vector<std::byte> broken = payload;
        broken[random() % broken.size()] ^= static_cast<std::byte>(1u << random() % 8);
        attempt(broken);
    }
    EXPECT_GT(refused, 0);
}

}  // namespace
}  // namespace etalon
