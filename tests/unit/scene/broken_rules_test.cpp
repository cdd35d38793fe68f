// Rules of glTF that a file may break without harm to the picture: named at their pointers, with the validator's codes.
// docs/verdicts.md compares many real files with the validator itself.
#include <gmock/gmock.h>

#include "engine/scene/preflight.h"
#include "tests/support/errors.h"
#include "tests/unit/scene/gltf_writer.h"

namespace etalon {
namespace {

using test::bytes_of;
using test::GltfWriter;
using test::message_of;
using testing::Contains;
using testing::HasSubstr;
using testing::IsEmpty;

std::vector<std::string> broken_rules(const std::vector<std::byte>& bytes)
{
    return preflight(bytes, "").broken_rules;
}

std::vector<std::string> broken_rules(const std::string& members)
{
    return broken_rules(bytes_of(R"({"asset":{"version":"2.0"},)" + members + "}"));
}

struct Rule {
    std::string members;
    std::string pointer;
    std::string code;
};

void expect_all(std::initializer_list<Rule> rules)
{
    for (const auto& [members, pointer, code] : rules)
        EXPECT_THAT(broken_rules(members),
                    Contains(testing::AllOf(testing::StartsWith(pointer + ": "), testing::EndsWith("[" + code + "]"))))
            << members;
}

const std::string kAccessor = R"("accessors":[{"componentType":5126,"type":"VEC3","count":3}])";

TEST(BrokenRules, of_properties_are_named)
{
    expect_all({
        {R"("nodes":[])", "/nodes", "EMPTY_ENTITY"},
        {R"("nodes":[{"children":[]}])", "/nodes/0/children", "EMPTY_ENTITY"},
        {R"("accessors":[{"componentType":5126,"type":"VEC3","count":3,"byteOffset":4}])", "/accessors/0/byteOffset",
         "UNSATISFIED_DEPENDENCY"},
        {R"("buffers":[{"byteLength":1,"uri":"data:application/octet-stream;;base64,AA=="}])", "/buffers/0/uri",
         "INVALID_URI"},
        {R"("images":[{"uri":":"}])", "/images/0/uri", "INVALID_URI"},
        {R"("textures":[{"extensions":{"EXT_texture_webp":{}}}])", "/textures/0/extensions/EXT_texture_webp",
         "UNDECLARED_EXTENSION"},
        {R"("extensionsUsed":["KHR_materials_ior"],"samplers":[{"extensions":{"KHR_materials_ior":{}}}])",
         "/samplers/0/extensions/KHR_materials_ior", "UNEXPECTED_EXTENSION_OBJECT"},
        {R"("extensionsUsed":["A"],"extensions":{"A":3})", "/extensions/A", "TYPE_MISMATCH"},
    });
}

TEST(BrokenRules, of_views_cameras_nodes_and_skins_are_named)
{
    const std::string joints = R"("meshes":[{"primitives":[{"attributes":{"JOINTS_0":0}}]}],)" + kAccessor;
    expect_all({
        {R"("buffers":[{"byteLength":9}],"bufferViews":[{"buffer":0,"byteLength":0}])", "/bufferViews/0/byteLength",
         "VALUE_NOT_IN_RANGE"},
        {R"("buffers":[{"byteLength":9}],"bufferViews":[{"buffer":0,"byteLength":8,"byteStride":4,"target":34963}])",
         "/bufferViews/0/byteStride", "BUFFER_VIEW_INVALID_BYTE_STRIDE"},
        {R"("cameras":[{"type":"perspective","perspective":{"yfov":1,"znear":2,"zfar":1}}])", "/cameras/0/perspective",
         "CAMERA_ZFAR_LEQUAL_ZNEAR"},
        {R"("nodes":[{"scale":[1,1,1],"matrix":[1,0,0,0,0,1,0,0,0,0,1,0,0,0,0,1]}])", "/nodes/0/matrix",
         "NODE_MATRIX_TRS"},
        {R"("nodes":[{"rotation":[0,0,0,2]}])", "/nodes/0/rotation", "ROTATION_NON_UNIT"},
        {R"("nodes":[{"mesh":0,"skin":0},{}],"skins":[{"joints":[1]}],"meshes":[{"primitives":[{"attributes":{"POSITION":0}}]}],)" +
             kAccessor,
         "/nodes/0", "NODE_SKIN_WITH_NON_SKINNED_MESH"},
        {R"("nodes":[{},{}],"skins":[{"joints":[0,1]}])", "/skins/0/joints", "SKIN_NO_COMMON_ROOT"},
        {R"("nodes":[{"mesh":0,"skin":0},{}],"skins":[{"joints":[1]}],"scenes":[{"nodes":[0]}],)" + joints, "/nodes/0",
         "NODE_SKIN_NO_SCENE"},
    });
}

TEST(BrokenRules, of_primitives_and_animations_are_named)
{
    const auto mesh = [](const std::string& primitives) {
        return R"("meshes":[{"primitives":[)" + primitives + "]}]," + kAccessor;
    };
    const std::string at = "/meshes/0/primitives/0";
    const std::string sampler = R"("animations":[{"samplers":[{"input":0,"output":0,"interpolation":"CUBICSPLINE"}],)";
    expect_all({
        {mesh(R"({"attributes":{"POSITION":0}})"), at + "/attributes/POSITION",
         "MESH_PRIMITIVE_POSITION_ACCESSOR_WITHOUT_BOUNDS"},
        {mesh(R"({"attributes":{"TEXCOORD_01":0}})"), at + "/attributes/TEXCOORD_01",
         "MESH_PRIMITIVE_INVALID_ATTRIBUTE"},
        {mesh(R"({"attributes":{"POSITION":0},"targets":[{"NORMAL":0}]})"), at + "/targets/0/NORMAL",
         "MESH_PRIMITIVE_MORPH_TARGET_NO_BASE_ACCESSOR"},
        {mesh(R"({"attributes":{"POSITION":0},"targets":[{"POSITION":0}]},{"attributes":{"POSITION":0}})"),
         "/meshes/0/primitives/1", "MESH_PRIMITIVES_UNEQUAL_TARGETS_COUNT"},
        {R"("materials":[{"emissiveTexture":{"index":0,"texCoord":1}}],"textures":[{}],)" +
             mesh(R"({"attributes":{"TEXCOORD_0":0},"material":0})"),
         at + "/material", "MESH_PRIMITIVE_TOO_FEW_TEXCOORDS"},
        {sampler + R"("channels":[]}],)" + kAccessor, "/animations/0/samplers/0/input",
         "ANIMATION_SAMPLER_INPUT_ACCESSOR_WITHOUT_BOUNDS"},
        {R"("nodes":[{}],)" + sampler +
             R"("channels":[{"sampler":0,"target":{"node":0,"path":"scale"}},{"sampler":0,"target":{"node":0,"path":"scale"}}]}],)" +
             kAccessor,
         "/animations/0/channels/0/target", "ANIMATION_DUPLICATE_TARGETS"},
    });
}

TEST(BrokenRules, of_values_are_named_and_true_bounds_are_not)
{
    const auto rules_of = [](const std::vector<float>& values, const std::string& attribute, const std::string& more) {
        GltfWriter file;
        file.add_accessor(file.add_view(values), test::kFloat, "VEC3", values.size() / 3, more);
        file.show(R"("attributes":{")" + attribute + R"(":0})");
        return broken_rules(file.glb());
    };
    EXPECT_THAT(rules_of(test::kTriangle, "POSITION", R"(,"min":[0,0,0],"max":[1,1,0])"), IsEmpty());
    EXPECT_THAT(rules_of({0.1f, 0, 0}, "POSITION", R"(,"min":[0.1,0,0],"max":[0.1,0,0])"), IsEmpty()) << "in float";
    EXPECT_THAT(rules_of(test::kTriangle, "POSITION", R"(,"min":[0,0.5,0],"max":[1,1,0])"),
                Contains("/accessors/0/min/1: says 0.5, but it is 0 [ACCESSOR_MIN_MISMATCH]"));
    EXPECT_THAT(rules_of(test::kTriangle, "POSITION", R"(,"min":[0,0,0],"max":[1,2,0])"),
                Contains("/accessors/0/max/1: says 2, but it is 1 [ACCESSOR_MAX_MISMATCH]"));
    EXPECT_THAT(rules_of({NAN, 0, 0}, "_A", ""), Contains(HasSubstr("/accessors/0: a value is not finite")));
    EXPECT_THAT(rules_of({2, 0, 0, 0, 1, 0}, "NORMAL", ""),
                Contains("/meshes/0/primitives/0/attributes/NORMAL: 1 vectors are not of unit length "
                         "[ACCESSOR_VECTOR3_NON_UNIT]"));
    EXPECT_THAT(rules_of({2, 0, 0}, "COLOR_0", ""), Contains(HasSubstr("ACCESSOR_NON_CLAMPED")));
}

TEST(BrokenRules, are_no_more_than_a_hundred_lines)
{
    std::string nodes = R"("nodes":[)";
    for (int i = 0; i < 500; ++i) nodes += std::string(i > 0 ? "," : "") + R"({"rotation":[0,0,0,2]})";
    const std::vector<std::string> rules = broken_rules(nodes + "]");
    ASSERT_EQ(rules.size(), 101u);
    EXPECT_EQ(rules.back(), "400 more rules of glTF are broken");
}

TEST(BrokenRules, cost_no_more_time_than_the_file_has_bytes)
{
    // 20,000 accessors of the same 1.2 MB: looked at all, they would be 24 GB.
    GltfWriter file;
    const int view = file.add_view(std::vector<float>(300'000));
    for (int i = 0; i < 20'000; ++i) file.add_accessor(view, test::kFloat, "SCALAR", 300'000);
    EXPECT_THAT(broken_rules(file.glb()), IsEmpty());
}

TEST(BrokenRules, that_leave_nothing_to_read_are_refusals_at_their_pointer)
{
    const auto refusal = [](const std::string& members) { return message_of([&] { broken_rules(members); }); };
    EXPECT_THAT(refusal(R"("cameras":[{}])"), HasSubstr("at /cameras/0"));
    EXPECT_THAT(refusal(R"("cameras":[{"type":"perspective"}])"), HasSubstr("perspective is missing"));
    EXPECT_THAT(refusal(R"("skins":[{}])"), HasSubstr("at /skins/0"));
    EXPECT_THAT(refusal(R"("animations":[{"channels":[{}],"samplers":[{"input":0,"output":0}]}],)" + kAccessor),
                HasSubstr("at /animations/0/channels/0"));
    EXPECT_THAT(refusal(R"("nodes":[{"extensions":{"KHR_lights_punctual":{"light":0}}}])"),
                HasSubstr("UNSATISFIED_DEPENDENCY"));
    EXPECT_THAT(refusal(R"("meshes":[{"primitives":[{"attributes":{},"indices":0}]}],)" + kAccessor),
                HasSubstr("MESH_PRIMITIVE_INDICES_ACCESSOR_INVALID_FORMAT"));
}

TEST(BrokenRules, a_light_of_unknown_type_is_ignored_with_a_warning)
{
    GltfWriter file = test::triangle_file();
    file.member(R"("extensionsUsed":["KHR_lights_punctual"],
        "extensions":{"KHR_lights_punctual":{"lights":[{"type":"spherical","intensity":7}]}})");
    const Scene scene = file.load();
    EXPECT_EQ(scene.lights.at(0).intensity, 0);
    EXPECT_THAT(scene.warnings, testing::ElementsAre(HasSubstr("/extensions/KHR_lights_punctual/lights/0/type")));
}

TEST(BrokenRules, an_accessor_of_unknown_type_is_ignored_where_nothing_uses_it)
{
    GltfWriter file = test::triangle_file();
    file.add_accessor(0, test::kFloat, "VEC5", 3);
    const Scene scene = file.load();
    EXPECT_THAT(scene.warnings, testing::ElementsAre(testing::AllOf(HasSubstr("/type: \"VEC5\" is not known"),
                                                                    HasSubstr("[VALUE_NOT_IN_LIST]"))));
    EXPECT_EQ(scene.meshes.at(0).primitives.at(0).positions.size(), 3u);
    EXPECT_THAT(message_of([] {
                    broken_rules(R"("skins":[{"joints":[0],"inverseBindMatrices":0}],"nodes":[{}],"accessors":[
                        {"componentType":5126,"type":"VEC5","count":3}])");
                }),
                HasSubstr("type \"VEC5\" of component type 5126 does not exist"));
}

TEST(BrokenRules, what_is_read_of_a_buffer_without_data_is_zero_with_a_warning)
{
    const Scene scene = parse_gltf(bytes_of(R"({"asset":{"version":"2.0"},"scenes":[{"nodes":[0]}],"scene":0,
        "nodes":[{"mesh":0}],"meshes":[{"primitives":[{"attributes":{"POSITION":0},"indices":1}]}],
        "buffers":[{"byteLength":48}],"bufferViews":[{"buffer":0,"byteLength":36},
        {"buffer":0,"byteOffset":36,"byteLength":12}],"accessors":[
        {"bufferView":0,"componentType":5126,"type":"VEC3","count":3,"min":[0,0,0],"max":[0,0,0]},
        {"bufferView":1,"componentType":5125,"type":"SCALAR","count":3}]})"),
                                   "", "test");
    EXPECT_THAT(scene.warnings,
                testing::ElementsAre(testing::AllOf(testing::StartsWith("/buffers/0: has no data in this file"),
                                                    HasSubstr("[BUFFER_MISSING_GLB_DATA]"))));
    EXPECT_THAT(scene.meshes.at(0).primitives.at(0).positions, testing::Each(vec3(0)));
    EXPECT_THAT(broken_rules(R"("buffers":[{"byteLength":48}])"), IsEmpty());
}

TEST(BrokenRules, are_errors_when_strict)
{
    GltfWriter file = test::triangle_file();
    EXPECT_EQ(file.load().broken_rules.size(), 1u);
    EXPECT_THAT(message_of([&] { file.load({.strict = true}); }),
                HasSubstr("MESH_PRIMITIVE_POSITION_ACCESSOR_WITHOUT_BOUNDS"));
}

}  // namespace
}  // namespace etalon
