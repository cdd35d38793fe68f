// What preflight itself decides; bad_input_test.cpp has the same from the outside.
#include "engine/scene/preflight.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "engine/base/files.h"
#include "engine/scene/compressed_header.h"
#include "engine/scene/data_uris.h"
#include "engine/scene/forest.h"
#include "tests/support/errors.h"
#include "tests/support/files.h"
#include "tests/unit/scene/gltf_writer.h"

namespace etalon {
namespace {

using test::bytes_of;
using test::GltfWriter;
using test::message_of;
using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;

std::string refusal_of(const std::vector<std::byte>& bytes, const Limits& limits = Limits())
{
    return message_of([&] { preflight(bytes, "", limits); });
}

std::string document(const std::string& members)
{
    return R"({"asset":{"version":"2.0"},)" + members + "}";
}

std::vector<std::byte> payload_of(std::initializer_list<unsigned> values)
{
    std::vector<std::byte> out;
    for (const unsigned value : values) out.push_back(static_cast<std::byte>(value));
    return out;
}

TEST(Preflight, whole_numbers_are_integers_however_they_are_written)
{
    const auto bytes = bytes_of(document(
        R"("buffers":[{"byteLength":1.2e1,"uri":"data:;base64,AAAAAAAAgD8AAABA"}],"scene":-0,"scenes":[{}],
           "bufferViews":[{"buffer":0.0,"byteLength":12.0}],"nodes":[{"translation":[-0.0,0.5,3.0]}])"));
    const CheckedGltf checked = preflight(bytes, "");
    EXPECT_THAT(checked.json,
                AllOf(HasSubstr(R"("byteLength":12)"), HasSubstr("[-0.0,0.5,3]"), HasSubstr(R"("scene":0)")));
    EXPECT_THAT(refusal_of(bytes_of(document(R"("scene":0.5,"scenes":[{}])"))), HasSubstr("TYPE_MISMATCH"));
    EXPECT_THAT(refusal_of(bytes_of(document(R"("scene":-1,"scenes":[{}])"))), HasSubstr("INVALID_INDEX"));
}

TEST(Preflight, pointers_name_members_with_slashes_and_tildes_as_rfc_6901_does)
{
    const std::string text =
        document(R"("meshes":[{"primitives":[{"attributes":{"POSITION":0}},{"attributes":{"a/b~c":7}}]}],)"
                 R"("accessors":[{"componentType":5126,"type":"VEC3","count":3}])");
    EXPECT_THAT(refusal_of(bytes_of(text)), AllOf(HasSubstr("/meshes/0/primitives/1/attributes/a~1b~0c"),
                                                  HasSubstr("UNRESOLVED_REFERENCE"), HasSubstr("/accessors has 1")));
}

TEST(Preflight, long_data_uris_are_not_copied_with_the_document)
{
    const std::string zeros(std::size_t{1} << 20, 'A');
    const auto bytes = bytes_of(document(R"("buffers":[{"byteLength":786432,"uri":"data:;base64,)" + zeros +
                                         R"("}],"images":[{"uri":"data:image/png;base64,)" + zeros + R"("}])"));
    const CheckedGltf checked = preflight(bytes, "");
    EXPECT_EQ(checked.buffers[0].bytes.size(), 786432u);
    EXPECT_EQ(checked.images[0].source().size(), zeros.size() + 22);
    EXPECT_GE(checked.images[0].source().data(), reinterpret_cast<const char*>(bytes.data()));
    EXPECT_LT(checked.images[0].source().data(), reinterpret_cast<const char*>(bytes.data() + bytes.size()));
    EXPECT_LT(checked.images[0].uri.size(), 20u);
    EXPECT_LT(checked.json.size(), 200u);
}

TEST(Preflight, lifting_leaves_all_other_text_alone)
{
    const std::string uri = "data:;base64," + std::string(5000, 'A');
    const std::string escaped = "data:;base64,\\/" + std::string(5000, 'A');
    for (const std::string& text :
         {std::string(), std::string("\""), std::string(R"(["a\"b"])"), std::string(R"("\\"x")"),
          "[\"" + escaped + "\"]", "[\"" + uri, std::string(R"(["data:,short"])"), "[\"x" + uri + "\"]"}) {
        const LiftedText lifted(text);
        EXPECT_EQ(lifted.text(), text);
        EXPECT_EQ(lifted.uri("data:@0"), "data:@0");
    }
    const std::string text = R"({"\"data:":")" + uri + R"(","b":")" + uri + R"(!"})";
    const LiftedText lifted(text);
    EXPECT_EQ(lifted.text(), R"({"\"data:":"data:@0","b":"data:@1"})");
    EXPECT_EQ(lifted.uri("data:@0"), uri);
    EXPECT_EQ(lifted.uri("data:@1"), uri + "!");
    for (const char* none : {"data:@2", "data:@", "data:@0x", "data:@-1", "data:@99999999999999999999", "x"})
        EXPECT_EQ(lifted.uri(none), none);
}

TEST(Preflight, buffers_are_read_as_far_as_declared_and_are_few_together)
{
    const test::TemporaryDirectory folder;
    replace_file(folder / "a.bin", std::string(1000, 'x'));
    const auto load = [&](const std::string& buffers, std::uint64_t limit) {
        Limits limits;
        limits.resource_bytes = limit;
        const auto bytes = bytes_of(document(R"("buffers":[)" + buffers + "]"));
        return preflight(bytes, folder.path(), limits);
    };
    const std::string one = R"({"byteLength":8,"uri":"a.bin"})";
    EXPECT_EQ(load(one, 8).buffers[0].owned.size(), 8u);
    EXPECT_THAT(message_of([&] { load(one, 7); }), HasSubstr("limit"));
    EXPECT_EQ(load(one + "," + one, 16).buffers.size(), 2u);
    EXPECT_THAT(message_of([&] { load(one + "," + one, 15); }), AllOf(HasSubstr("/buffers/1/uri"), HasSubstr("limit")));
    EXPECT_THAT(message_of([&] { load(R"({"byteLength":1001,"uri":"a.bin"})", 2000); }),
                HasSubstr("BUFFER_BYTE_LENGTH_MISMATCH"));
}

TEST(Preflight, accessors_over_buffers_without_data_count_as_zero_filled)
{
    const std::string text = document(
        R"("buffers":[{"byteLength":9223372036854775807}],"bufferViews":[{"buffer":0,"byteLength":9223372036854775807}],)"
        R"("accessors":[{"bufferView":0,"componentType":5126,"type":"VEC4","count":1000000000000}])");
    EXPECT_THAT(refusal_of(bytes_of(text)), HasSubstr("without data"));
}

TEST(Preflight, doubles_only_with_their_extension)
{
    const std::string accessor = R"("accessors":[{"componentType":5130,"type":"SCALAR","count":3}])";
    EXPECT_THAT(refusal_of(bytes_of(document(accessor))), HasSubstr("VALUE_NOT_IN_LIST"));
    const auto used = bytes_of(document(R"("extensionsUsed":["KHR_accessor_float64"],)" + accessor));
    EXPECT_NO_THROW(preflight(used, ""));
}

TEST(Preflight, what_a_few_bytes_multiply_has_limits)
{
    Limits limits;
    limits.instances = limits.keyframes = limits.morph_targets = limits.joints = 3;
    const std::string accessor = R"("accessors":[{"componentType":5126,"type":"SCALAR","count":2}],)";
    const auto expect = [&](const std::string& members, const char* pointer) {
        EXPECT_THAT(refusal_of(bytes_of(document(accessor + members)), limits), HasSubstr(pointer));
        EXPECT_NO_THROW(preflight(bytes_of(document(accessor + members)), ""));
    };
    const std::string instancing = R"({"extensions":{"EXT_mesh_gpu_instancing":{"attributes":{"TRANSLATION":0}}}})";
    expect(R"("nodes":[)" + instancing + "," + instancing + "]",
           "/nodes/1/extensions/EXT_mesh_gpu_instancing/attributes/TRANSLATION");
    expect(R"("animations":[{"samplers":[{"input":0,"output":0},{"input":0,"output":0}],"channels":[]}])",
           "/animations/0/samplers/1/input");
    expect(R"("meshes":[{"primitives":[{"attributes":{},"targets":[{},{},{},{}]}]}])",
           "/meshes/0/primitives/0/targets");
    expect(R"("nodes":[{},{},{},{}],"skins":[{"joints":[0,1,2,3]}])", "/skins/0/joints");
}

TEST(Preflight, forests_have_a_limit_of_depth_and_no_duplicates)
{
    EXPECT_NO_THROW(check_forest({{1}, {2}, {}}, {{0}}, 3));
    EXPECT_THAT(message_of([] { check_forest({{1}, {2}, {}}, {{0}}, 2); }), HasSubstr("/nodes/2"));
    EXPECT_THAT(message_of([] { check_forest({{1, 1}, {}}, {}, 9); }), HasSubstr("DUPLICATE_ELEMENTS"));
    EXPECT_THAT(message_of([] { check_forest({{}}, {{0, 0}}, 9); }), HasSubstr("DUPLICATE_ELEMENTS"));
}

TEST(Preflight, what_a_glb_breaks_without_harm_is_a_warning)
{
    const auto chunk = [](std::string type, std::string body) {
        const auto size = static_cast<char>(body.size());
        return std::string{size, 0, 0, 0} + type + body;
    };
    const auto warnings = [&](const std::string& chunks, const std::string& behind = {}) {
        const std::string head =
            std::string("glTF\2\0\0\0", 8) + std::string{static_cast<char>(12 + chunks.size()), 0, 0, 0};
        const auto bytes = bytes_of(head + chunks + behind);
        return preflight(bytes, "").warnings;
    };
    const std::string json = chunk("JSON", R"({"asset":{"version":"2.0"}}  )" + std::string(3, '\0'));
    const std::string binary = chunk(std::string("BIN\0", 4), "1234");
    EXPECT_THAT(warnings(json + binary), ElementsAre());
    EXPECT_THAT(warnings(json + binary, "more"), ElementsAre(HasSubstr("GLB_EXTRA_DATA")));
    EXPECT_THAT(warnings(json + chunk("ABCD", "1234") + binary),
                ElementsAre(HasSubstr("GLB_UNKNOWN_CHUNK_TYPE"), HasSubstr("GLB_UNEXPECTED_BIN_CHUNK")));
    EXPECT_THAT(warnings(json + binary + json), ElementsAre(HasSubstr("GLB_DUPLICATE_CHUNK")));
    EXPECT_THAT(warnings(json + chunk(std::string("BIN\0", 4), "123")),
                ElementsAre(HasSubstr("GLB_CHUNK_LENGTH_UNALIGNED")));
}

// A header as the Draco bitstream specification 2.2 lays it out: sequential (0) or edgebreaker (1).
std::vector<std::byte> draco(unsigned method, std::initializer_list<unsigned> rest, unsigned flags = 0)
{
    auto out = payload_of({'D', 'R', 'A', 'C', 'O', 2, 2, 1, method, 0, flags});
    for (const unsigned value : rest) out.push_back(static_cast<std::byte>(value));
    return out;
}

TEST(CompressedHeader, draco_counts_are_read_in_both_encodings_and_behind_metadata)
{
    const DracoClaim sequential = read_draco_header(draco(0, {0x80, 0x02, 5, 1}));
    EXPECT_EQ(sequential.faces, 256u);
    EXPECT_EQ(sequential.vertices, 5u);
    const DracoClaim edgebreaker = read_draco_header(draco(1, {0, 7, 9, 1, 9, 2}));
    EXPECT_EQ(edgebreaker.faces, 9u);
    EXPECT_EQ(edgebreaker.vertices, 7u);
    // One attribute with one entry "a" = 0x05; the geometry with a level "b" that is empty.
    const DracoClaim behind = read_draco_header(
        draco(0, {1, 0, 1, 1, 'a', 1, 5, 0, /* geometry */ 0, 1, 1, 'b', 0, 0, /* counts */ 3, 4, 1}, 0x80));
    EXPECT_EQ(behind.faces, 3u);
    EXPECT_EQ(behind.vertices, 4u);
}

TEST(CompressedHeader, draco_payloads_that_lie_or_end_early_are_refused)
{
    const std::vector<std::byte> whole = draco(1, {0, 7, 9, 1, 9, 2});
    for (std::size_t size = 0; size < whole.size(); ++size)
        EXPECT_THAT(message_of([&] { read_draco_header(std::span(whole).first(size)); }), HasSubstr("ends")) << size;
    EXPECT_THAT(message_of([] { read_draco_header(payload_of({'D', 'R', 'A', 'C', 'X'})); }), HasSubstr("not Draco"));
    EXPECT_THAT(message_of([] { read_draco_header(payload_of({'D', 'R', 'A', 'C', 'O', 1, 3})); }), HasSubstr("1.3"));
    EXPECT_THAT(message_of([] {
                    read_draco_header(payload_of({'D', 'R', 'A', 'C', 'O', 2, 2, 0}));
                }),
                HasSubstr("point cloud"));
    EXPECT_THAT(message_of([] { read_draco_header(draco(2, {})); }), HasSubstr("method 2"));
    EXPECT_THAT(message_of([] { read_draco_header(draco(1, {0, 7, 9, 1, 10, 2})); }), HasSubstr("10 symbols"));
    EXPECT_THAT(message_of([] { read_draco_header(draco(1, {0, 7, 9, 1, 3, 4})); }), HasSubstr("4 splits"));
    EXPECT_THAT(message_of([] {
                    read_draco_header(draco(0, {0xff, 0xff, 0xff, 0xff, 0x0f, 1, 1}));
                }),
                HasSubstr("4294967295 faces"));
    EXPECT_THAT(message_of([] {
                    read_draco_header(draco(0, {0xff, 0xff, 0xff, 0xff, 0x1f, 1, 1}));
                }),
                HasSubstr("32 bits"));
    std::vector<std::byte> deep = draco(0, {0}, 0x80);
    for (int i = 0; i < 100'000; ++i)
        for (const unsigned value : {0, 1, 0}) deep.push_back(static_cast<std::byte>(value));
    EXPECT_THAT(message_of([&] { read_draco_header(deep); }), HasSubstr("nested"));
}

TEST(CompressedHeader, meshopt_payloads_are_as_long_as_their_codec_needs)
{
    const auto check = [](unsigned head, std::size_t size, MeshoptMode mode, std::uint64_t count,
                          std::uint64_t stride) {
        std::vector<std::byte> payload(size);
        if (size > 0) payload[0] = static_cast<std::byte>(head);
        check_meshopt_payload(payload, mode, count, stride);
    };
    EXPECT_NO_THROW(check(0xe1, 17 + 100, MeshoptMode::triangles, 300, 4));
    EXPECT_THAT(message_of([&] { check(0xe1, 16 + 100, MeshoptMode::triangles, 300, 4); }), HasSubstr("cannot hold"));
    EXPECT_NO_THROW(check(0xd1, 305, MeshoptMode::indices, 300, 2));
    EXPECT_THAT(message_of([&] { check(0xd1, 304, MeshoptMode::indices, 300, 2); }), HasSubstr("cannot hold"));
    // 4 blocks of 256 vertices of 12 bytes: 4 bytes of bit counts for each byte of the stride.
    EXPECT_NO_THROW(check(0xa0, 1 + 4 * 12 * 4 + 12, MeshoptMode::attributes, 1024, 12));
    EXPECT_THAT(message_of([&] { check(0xa0, 4 * 12 * 4 + 12, MeshoptMode::attributes, 1024, 12); }),
                HasSubstr("cannot hold"));
    EXPECT_NO_THROW(check(0xa1, 1 + 4 * 3 + 12, MeshoptMode::attributes, 1024, 12));
    for (const unsigned head : {0x00u, 0xa2u, 0xe1u, 0xd1u})
        EXPECT_THAT(message_of([&] { check(head, 1000, MeshoptMode::attributes, 1, 12); }), HasSubstr("no stream"));
    EXPECT_THAT(message_of([&] { check(0, 0, MeshoptMode::indices, 1, 2); }), HasSubstr("no stream"));
    EXPECT_THAT(message_of([&] { check(0xa0, 1000, MeshoptMode::attributes, std::uint64_t{1} << 60, 256); }),
                HasSubstr("elements"));
}

// A file with a Draco triangle of `faces` faces and `vertices` vertices, behind accessors that say 3 of each.
GltfWriter draco_file(unsigned faces, unsigned vertices)
{
    GltfWriter file;
    const int view = file.add_view(draco(0, {faces, vertices, 1}));
    file.add("accessors", R"({"componentType":5126,"type":"VEC3","count":3})");
    file.add("accessors", R"({"componentType":5123,"type":"SCALAR","count":3})");
    file.show(fmt::format(R"("attributes":{{"POSITION":0}},"indices":1,"extensions":{{"KHR_draco_mesh_compression":)"
                          R"({{"bufferView":{},"attributes":{{"POSITION":0}}}}}})",
                          view));
    return file;
}

TEST(CompressedHeader, draco_claims_are_held_against_the_accessors)
{
    EXPECT_NO_THROW(preflight(draco_file(1, 3).glb(), ""));
    EXPECT_THAT(refusal_of(draco_file(2, 3).glb()), AllOf(HasSubstr("6 corners"), HasSubstr("/meshes/0/primitives/0")));
    EXPECT_THAT(refusal_of(draco_file(1, 4).glb()), HasSubstr("4 vertices"));
    GltfWriter huge;
    huge.add_view(draco(0, {1, 3, 1}));
    huge.add("accessors", R"({"componentType":5126,"type":"VEC3","count":100000000})");
    huge.show(
        R"("attributes":{"POSITION":0},"extensions":{"KHR_draco_mesh_compression":{"bufferView":0,"attributes":{"POSITION":0}}})");
    EXPECT_THAT(refusal_of(huge.glb()), HasSubstr("are to fill"));
}

TEST(CompressedHeader, meshopt_views_are_held_against_their_extension)
{
    const auto file = [](const std::string& more, const std::string& length = "36") {
        std::vector<std::byte> payload(128);
        payload[0] = std::byte{0xa0};
        GltfWriter out;
        out.add_view(payload);
        out.add("bufferViews", R"({"buffer":0,"byteLength":)" + length +
                                   R"(,"extensions":{"EXT_meshopt_compression":{"buffer":0,"count":3,)" + more + "}}}");
        return out.glb();
    };
    const std::string good = R"("byteLength":64,"byteStride":12,"mode":"ATTRIBUTES")";
    EXPECT_NO_THROW(preflight(file(good), ""));
    const std::string at = "/bufferViews/1/extensions/EXT_meshopt_compression";
    EXPECT_THAT(refusal_of(file(R"("byteLength":129,"byteStride":12,"mode":"ATTRIBUTES")")),
                AllOf(HasSubstr(at), HasSubstr("BUFFER_VIEW_TOO_LONG")));
    EXPECT_THAT(refusal_of(file(R"("byteLength":64,"byteStride":10,"mode":"ATTRIBUTES")")),
                HasSubstr(at + "/byteStride"));
    EXPECT_THAT(refusal_of(file(R"("byteLength":64,"byteStride":12,"mode":"SQUARES")")), HasSubstr(at + "/mode"));
    EXPECT_THAT(refusal_of(file(R"("byteLength":64,"byteStride":12,"mode":"ATTRIBUTES","filter":"QUATERNION")")),
                HasSubstr(at + "/filter"));
    EXPECT_THAT(refusal_of(file(R"("byteLength":64,"byteStride":2,"mode":"TRIANGLES")", "6")), HasSubstr("no stream"));
    EXPECT_THAT(refusal_of(file(good, "40")), HasSubstr(at + "/count"));
    EXPECT_THAT(refusal_of(file(R"("byteLength":30,"byteStride":36,"mode":"ATTRIBUTES")", "108")),
                HasSubstr("cannot hold"));
}

}  // namespace
}  // namespace etalon
