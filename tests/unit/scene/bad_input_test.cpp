// Broken and hostile files: each is refused with a message that says where and what, as input (exit code 2), and
// nothing else happens.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/stat.h>

#include <chrono>
#include <filesystem>

#include "engine/base/error.h"
#include "engine/base/files.h"
#include "engine/image/io.h"
#include "engine/scene/pose.h"
#include "engine/scene/resources.h"
#include "tests/support/files.h"
#include "tests/unit/scene/gltf_writer.h"

namespace etalon {
namespace {

using test::bytes_of;
using test::GltfWriter;
using testing::HasSubstr;

// Runs `act`, which must throw Error(input); gives its whole message.
template <typename Function>
std::string refusal(const Function& act)
{
    try {
        act();
    } catch (const Error& error) {
        EXPECT_EQ(error.exit_code(), 2) << error.message();
        return error.message();
    }
    ADD_FAILURE() << "accepted";
    return {};
}

std::string refusal_of(const std::vector<std::byte>& bytes, const std::filesystem::path& folder = {})
{
    return refusal([&] { parse_gltf(bytes, folder, "test"); });
}

std::string refusal_of(const std::string& json, const std::filesystem::path& folder = {})
{
    return refusal_of(bytes_of(json), folder);
}

TEST(BadInput, missing_files_and_folders_are_named)
{
    const test::TemporaryDirectory folder;
    EXPECT_THAT(refusal([&] { load_scene((folder / "nowhere.glb").string()); }), HasSubstr("nowhere.glb"));
    EXPECT_THAT(refusal([&] { load_scene(folder.path().string()); }), HasSubstr(folder.path().filename().string()));
    EXPECT_THAT(refusal([&] { load_scene("builtin:nothing"); }), HasSubstr("cornell"));
}

TEST(BadInput, a_pipe_does_not_hold_us)
{
    const test::TemporaryDirectory folder;
    ASSERT_EQ(::mkfifo((folder / "pipe.bin").c_str(), 0600), 0);
    EXPECT_THAT(
        refusal_of(R"({"asset":{"version":"2.0"},"buffers":[{"byteLength":4,"uri":"pipe.bin"}]})", folder.path()),
        HasSubstr("not a regular file"));
    EXPECT_THAT(refusal_of(R"({"asset":{"version":"2.0"},"buffers":[{"byteLength":4,"uri":"."}]})", folder.path()),
                HasSubstr("not a regular file"));
}

TEST(BadInput, every_truncation_of_a_glb_is_refused)
{
    const std::vector<std::byte> whole = test::triangle_file().glb();
    ASSERT_NO_THROW(parse_gltf(whole, "", "whole"));
    for (std::size_t size = 0; size < whole.size(); ++size)
        refusal_of(std::vector<std::byte>(whole.begin(), whole.begin() + std::ptrdiff_t(size)));
}

TEST(BadInput, every_changed_byte_of_a_glb_loads_or_is_refused)
{
    const std::vector<std::byte> whole = test::triangle_file().glb();
    for (std::size_t i = 0; i < whole.size(); ++i)
        for (const unsigned value : {0u, 0xffu, 0x80u, 0x39u, 0x2du}) {
            std::vector<std::byte> changed = whole;
            changed[i] = static_cast<std::byte>(value);
            try {
                const Scene scene = parse_gltf(changed, "", "changed");
                static_cast<void>(pose(scene));
            } catch (const Error& error) {
                EXPECT_EQ(error.exit_code(), 2);
            }
        }
}

TEST(BadInput, headers_and_text_that_are_not_glTF)
{
    EXPECT_THAT(refusal_of("BZh91AY&SY and so on"), HasSubstr("this is not glTF"));
    EXPECT_THAT(refusal_of(""), HasSubstr("this is not glTF"));
    EXPECT_THAT(refusal_of("[1,2,3]"), HasSubstr("no JSON object"));
    EXPECT_THAT(refusal_of("{\"asset\":"), HasSubstr("INVALID_JSON"));
    EXPECT_THAT(refusal_of("{\"asset\":{\"version\":\"2.0\"},\"nodes\":[{\"scale\":[1e400,1,1]}]}"),
                HasSubstr("INVALID_JSON"));
    EXPECT_THAT(refusal_of("{\"asset\":{\"version\":\"2.0\",\"x\":\"\xff\xfe\"}}"), HasSubstr("INVALID_JSON"));
    EXPECT_THAT(refusal_of(R"({"asset":{"version":"1.0"}})"), HasSubstr("/asset/version"));
    std::vector<std::byte> glb = test::triangle_file().glb();
    glb[4] = std::byte{9};
    EXPECT_THAT(refusal_of(glb), HasSubstr("GLB_INVALID_VERSION"));
    glb = test::triangle_file().glb();
    glb[15] = std::byte{0xff};  // the JSON chunk says 4 GiB
    EXPECT_THAT(refusal_of(glb), HasSubstr("GLB_CHUNK_TOO_BIG"));
}

struct Broken {
    const char* what;
    std::string json;  // behind the version, with three floats in a data URI as buffer 0
    const char* message;
};

TEST(BadInput, ranges_and_references_that_do_not_hold)
{
    const std::string accessor = R"("accessors":[{"componentType":5126,"type":"SCALAR","count":3,"bufferView":0)";
    const std::string view = R"("bufferViews":[{"buffer":0,"byteLength":12}],)";
    for (
        const Broken& row : {
            Broken{"bufferView past its buffer", R"("bufferViews":[{"buffer":0,"byteLength":13}])",
                   "BUFFER_VIEW_TOO_LONG"},
            Broken{"offset + length wraps",
                   R"("bufferViews":[{"buffer":0,"byteOffset":18446744073709551608,"byteLength":16}])",
                   "BUFFER_VIEW_TOO_LONG"},
            Broken{"negative offset", R"("bufferViews":[{"buffer":0,"byteOffset":-4,"byteLength":4}])",
                   "/bufferViews/0/byteOffset"},
            Broken{"stride of 3", R"("bufferViews":[{"buffer":0,"byteLength":12,"byteStride":3}])",
                   "/bufferViews/0/byteStride"},
            Broken{"buffer that is not there", R"("bufferViews":[{"buffer":7,"byteLength":12}])",
                   "UNRESOLVED_REFERENCE"},
            Broken{"accessor past its view", view + accessor + R"(,"byteOffset":4}])", "ACCESSOR_TOO_LONG"},
            Broken{
                "count · size wraps",
                view +
                    R"("accessors":[{"componentType":5126,"type":"MAT4","count":4611686018427387905,"bufferView":0}])",
                "ACCESSOR_TOO_LONG"},
            Broken{"count of none",
                   view + R"("accessors":[{"componentType":5126,"type":"SCALAR","count":0,"bufferView":0}])",
                   "/accessors/0/count"},
            Broken{"zero-filled 2^60 elements",
                   R"("accessors":[{"componentType":5126,"type":"VEC4","count":1152921504606846976}])", "without data"},
            Broken{"component type 5124",
                   view + R"("accessors":[{"componentType":5124,"type":"SCALAR","count":3,"bufferView":0}])",
                   "VALUE_NOT_IN_LIST"},
            Broken{
                "sparse count over count",
                view + accessor +
                    R"(,"sparse":{"count":4,"indices":{"bufferView":0,"componentType":5121},"values":{"bufferView":0}}}])",
                "ACCESSOR_SPARSE_COUNT_OUT_OF_RANGE"},
            Broken{
                "sparse values past the view",
                view + accessor +
                    R"(,"sparse":{"count":2,"indices":{"bufferView":0,"componentType":5121},"values":{"bufferView":0,"byteOffset":8}}}])",
                "/accessors/0/sparse/values"},
            Broken{"sparse without values",
                   view + accessor + R"(,"sparse":{"count":2,"indices":{"bufferView":0,"componentType":5121}}}])",
                   "values is missing"},
            Broken{"image past its buffer",
                   R"("bufferViews":[{"buffer":0,"byteOffset":4294967295,"byteLength":4}],"images":[{"bufferView":0}])",
                   "BUFFER_VIEW_TOO_LONG"},
            Broken{"texture without its image", R"("textures":[{"source":0}])", "/textures/0/source"},
            Broken{"mesh that is not there", R"("nodes":[{"mesh":0}])", "/nodes/0/mesh"},
            Broken{"an index that is text", R"("nodes":[{"mesh":"0"}])", "TYPE_MISMATCH"},
            Broken{"an index of 1e300", R"("nodes":[{"mesh":1e300}])", "TYPE_MISMATCH"},
            Broken{"nodes that are numbers", R"("nodes":[1,2])", "TYPE_MISMATCH"},
            Broken{"a node its own child", R"("nodes":[{"children":[0]}])", "NODE_LOOP"},
            Broken{"a cycle of three", R"("nodes":[{"children":[1]},{"children":[2]},{"children":[0]}])", "NODE_LOOP"},
            Broken{"two parents", R"("nodes":[{"children":[2]},{"children":[2]},{}])", "NODE_PARENT_OVERRIDE"},
            Broken{"a scene of a child", R"("nodes":[{"children":[1]},{}],"scenes":[{"nodes":[1]}])",
                   "SCENE_NON_ROOT_NODE"},
            Broken{"a scene that is not there", R"("scene":3)", "/scene"},
            Broken{"field of view of 0", R"("cameras":[{"type":"perspective","perspective":{"yfov":0,"znear":1}}])",
                   "/cameras/0/perspective/yfov"},
            Broken{"a projecting matrix", R"("nodes":[{"matrix":[1,0,0,1,0,1,0,0,0,0,1,0,0,0,0,1]}])",
                   "/nodes/0/matrix"},
            Broken{"a spot without a cone",
                   R"("extensions":{"KHR_lights_punctual":{"lights":[{"type":"spot","spot":{"innerConeAngle":2}}]}})",
                   "lights/0/spot"},
        }) {
        const std::string json =
            R"({"asset":{"version":"2.0"},"buffers":[{"byteLength":12,"uri":"data:application/octet-stream;base64,AAAAAAAAgD8AAABA"}],)" +
            row.json + "}";
        EXPECT_THAT(refusal_of(json), HasSubstr(row.message)) << row.what;
    }
}

TEST(BadInput, vertices_and_indices_that_do_not_hold)
{
    for (const float bad : {std::numeric_limits<float>::quiet_NaN(), std::numeric_limits<float>::infinity(),
                            -std::numeric_limits<float>::infinity()}) {
        GltfWriter file;
        file.add_floats({0, 0, 0, 1, bad, 0, 0, 1, 0}, 3);
        file.show(R"("attributes":{"POSITION":0})");
        const std::string message = refusal_of(file.glb());
        EXPECT_THAT(message, HasSubstr("/meshes/0/primitives/0/attributes/POSITION"));
        EXPECT_THAT(message, HasSubstr("element 1"));
    }
    const auto with_indices = [](std::vector<std::uint16_t> indices, const std::string& more = {}) {
        GltfWriter file;
        file.add_floats(test::kTriangle, 3);
        file.add_accessor(file.add_view(indices), test::kUnsignedShort, "SCALAR", indices.size());
        file.show(R"("attributes":{"POSITION":0},"indices":1)" + more);
        return refusal_of(file.glb());
    };
    EXPECT_THAT(with_indices({0, 1, 3}), HasSubstr("ACCESSOR_INDEX_OOB"));
    EXPECT_THAT(with_indices({0, 1, 65535}), HasSubstr("ACCESSOR_INDEX_PRIMITIVE_RESTART"));
    EXPECT_THAT(with_indices({0, 1, 2}, R"(,"mode":7)"), HasSubstr("/mode"));
    GltfWriter unequal;
    unequal.add_floats(test::kTriangle, 3);
    unequal.add_floats({0, 0, 1, 0, 0, 1}, 3);
    unequal.show(R"("attributes":{"POSITION":0,"NORMAL":1})");
    EXPECT_THAT(refusal_of(unequal.glb()), HasSubstr("MESH_PRIMITIVE_UNEQUAL_ACCESSOR_COUNT"));
    GltfWriter flat;
    flat.add_floats({0, 0, 1, 0, 0, 1}, 2);
    flat.show(R"("attributes":{"POSITION":0})");
    EXPECT_THAT(refusal_of(flat.glb()), HasSubstr("MESH_PRIMITIVE_ATTRIBUTES_ACCESSOR_INVALID_FORMAT"));
    GltfWriter sparse;
    sparse.add_floats(test::kTriangle, 3);
    sparse.add_view(std::vector<std::uint8_t>{2, 2});
    sparse.add_view(std::vector<float>{1, 1, 1, 2, 2, 2});
    sparse.add_accessor(
        0, test::kFloat, "VEC3", 3,
        R"(,"sparse":{"count":2,"indices":{"bufferView":1,"componentType":5121},"values":{"bufferView":2}})");
    sparse.show(R"("attributes":{"POSITION":1})");
    EXPECT_THAT(refusal_of(sparse.glb()), HasSubstr("ACCESSOR_SPARSE_INDICES_NON_INCREASING"));
}

TEST(BadInput, images_that_are_absent_or_broken)
{
    const test::TemporaryDirectory folder;
    replace_file(folder / "broken.png", std::string_view("\x89PNG\r\n\x1a\n and then nothing"));
    const auto with_image = [&](const std::string& uri) {
        return refusal_of(R"({"asset":{"version":"2.0"},"images":[{"uri":")" + uri + R"("}],"textures":[{"source":0}],
            "materials":[{"pbrMetallicRoughness":{"baseColorTexture":{"index":0}}}]})",
                          folder.path());
    };
    EXPECT_THAT(with_image("absent.png"), HasSubstr("absent.png"));
    EXPECT_THAT(with_image("absent.png"), HasSubstr("/images/0"));
    EXPECT_THAT(with_image("broken.png"), HasSubstr("broken.png"));
    EXPECT_THAT(with_image("data:image/png;base64,AAAA"), HasSubstr("/images/0"));
    EXPECT_THAT(with_image("data:image/png;base64,*&^%"), HasSubstr("base64"));
}

TEST(BadInput, uris_never_leave_the_folder)
{
    const test::TemporaryDirectory outer;
    std::filesystem::create_directory(outer / "scene");
    std::filesystem::create_directory(outer / "scene/below");
    replace_file(outer / "secret", std::string_view("1234"));
    replace_file(outer / "scene/own", std::string_view("1234"));
    replace_file(outer / "scene/below/own", std::string_view("1234"));
    std::filesystem::create_symlink(outer / "secret", outer / "scene/link");
    std::filesystem::create_symlink(outer.path(), outer / "scene/up");
    std::filesystem::create_symlink("own", outer / "scene/inner");
    const std::filesystem::path folder = outer / "scene";
    for (const char* good : {"own", "below/own", "below/../own", "./own", "inner", "%6fwn"})
        EXPECT_EQ(read_uri(good, folder, 100).size(), 4u) << good;
    for (const std::string& bad :
         {std::string("../secret"), std::string("below/../../secret"), std::string("%2e%2e/secret"),
          std::string("..%2fsecret"), std::string("link"), std::string("up/secret"), (outer / "secret").string(),
          "file://" + (outer / "secret").string(), std::string("http://127.0.0.1/x"), std::string("FILE:own"),
          std::string("own%00.png"), std::string("%zz"), std::string("%2"), std::string(""), std::string("below"),
          std::string("/dev/zero"), std::string("/proc/self/environ")})
        refusal([&] { read_uri(bad, folder, 100); });
    EXPECT_THAT(refusal([&] { read_uri("own", folder, 3); }), HasSubstr("limit"));
    EXPECT_THAT(refusal([&] { confined_path("../secret", folder); }), HasSubstr("../secret"));
}

TEST(BadInput, data_uris_decode_or_are_refused)
{
    EXPECT_EQ(base64_decoded("SGVsbG8="), bytes_of("Hello"));
    EXPECT_EQ(base64_decoded("SGVsbG8"), bytes_of("Hello"));
    EXPECT_EQ(base64_decoded(""), bytes_of(""));
    EXPECT_EQ(read_uri("data:text/plain,a%20b", "", 100), bytes_of("a b"));
    EXPECT_THAT(refusal([] { base64_decoded("SGV sbG8"); }), HasSubstr("byte 3"));
    EXPECT_THAT(refusal([] { read_uri("data:;base64", "", 100); }), HasSubstr("comma"));
    EXPECT_THAT(refusal([] { read_uri("data:;base64," + std::string(1000, 'A'), "", 100); }), HasSubstr("limit"));
}

TEST(BadInput, deep_nesting_is_refused_before_anything_recurses)
{
    for (const std::size_t depth : {std::size_t{257}, std::size_t{16'000}, std::size_t{1'000'000}}) {
        const std::string json =
            R"({"asset":{"version":"2.0"},"extras":)" + std::string(depth, '[') + std::string(depth, ']') + "}";
        EXPECT_THAT(refusal_of(json), HasSubstr("nested")) << depth;
    }
    const std::string fine =
        R"({"asset":{"version":"2.0"},"extras":)" + std::string(200, '[') + std::string(200, ']') + "}";
    EXPECT_NO_THROW(parse_gltf(bytes_of(fine), "", "fine"));
}

TEST(BadInput, a_chain_of_100000_nodes_is_no_problem)
{
    std::string json = R"({"asset":{"version":"2.0"},"nodes":[)";
    constexpr int kDepth = 100'000;
    for (int i = 0; i + 1 < kDepth; ++i) json += fmt::format(R"({{"children":[{}],"translation":[0,0,1]}},)", i + 1);
    json += R"({"camera":0}],"cameras":[{"type":"perspective","perspective":{"yfov":1,"znear":1}}]})";
    const Scene scene = parse_gltf(bytes_of(json), "", "chain");
    EXPECT_EQ(pose(scene).view.world_from_camera[3].z, kDepth - 1);
}

TEST(BadInput, an_accessor_shared_by_many_primitives_is_refused_where_all_of_it_is_copied_and_cheap_where_little_is)
{
    const auto shared = [](const std::string& more) {
        GltfWriter file;
        file.add("accessors", R"({"componentType":5126,"type":"VEC3","count":20000000})");  // 240 MB of zeros, once
        file.add_accessor(file.add_view(std::vector<std::uint32_t>{0}), test::kUnsignedInt, "SCALAR", 1);
        std::string primitives;
        for (int i = 0; i < 1000; ++i)
            primitives += std::string(i ? "," : "") +
                          R"({"attributes":{"POSITION":0,"NORMAL":0,"COLOR_0":0},"mode":0)" + more + "}";
        file.add("meshes", R"({"primitives":[)" + primitives + "]}");
        return file.glb();
    };
    EXPECT_THAT(refusal_of(shared("")), HasSubstr("GiB"));
    EXPECT_EQ(parse_gltf(shared(R"(,"indices":1)"), "", "test").meshes[0].primitives[999].positions.size(), 1u);
}

TEST(BadInput, sizes_of_pictures_have_limits)
{
    const Scene scene = make_builtin("triangle");
    for (const ivec2 size : {ivec2(0, 0), ivec2(0, 5), ivec2(-1, 5), ivec2(100000, 100000), ivec2(32769, 1)}) {
        PoseSettings settings;
        settings.size = size;
        EXPECT_THAT(refusal([&] { static_cast<void>(pose(scene, settings)); }),
                    HasSubstr(fmt::format("{}x{}", size.x, size.y)));
    }
    PoseSettings largest;
    largest.size = ivec2(32768, 32768);
    EXPECT_NO_THROW(static_cast<void>(pose(scene, largest)));
}

}  // namespace
}  // namespace etalon
