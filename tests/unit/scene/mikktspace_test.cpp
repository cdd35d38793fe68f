// Tangents against an outside truth: the npm package mikktspace. ETALON_MIKKTSPACE names a folder in which
// `npm install mikktspace` was run; without it or without the assets the tests here say that they are skipped.
#include <gtest/gtest.h>

#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <fstream>

#include "engine/base/files.h"
#include "engine/geometry/tangents.h"
#include "engine/math/robust.h"
#include "engine/scene/builder.h"
#include "engine/scene/load.h"
#include "tests/support/files.h"

namespace etalon {
namespace {

constexpr double kLargestAngle = 1e-3;  // radians: what the project promises

struct Soup {
    std::vector<vec3> positions;
    std::vector<vec3> normals;
    std::vector<vec2> uv;
    std::vector<std::uint32_t> indices;
};

void add(Soup& soup, const Primitive& primitive, std::size_t uv_set)
{
    for (const std::uint32_t i : primitive.indices) {
        soup.indices.push_back(static_cast<std::uint32_t>(soup.indices.size()));
        soup.positions.push_back(primitive.positions[i]);
        soup.normals.push_back(primitive.normals[i]);
        soup.uv.push_back(primitive.uv[uv_set][i]);
    }
}

// The oracle's tangents, or nothing where node or the package is missing.
std::vector<vec4> oracle(const Soup& soup)
{
    const char* folder = std::getenv("ETALON_MIKKTSPACE");
    if (folder == nullptr) return {};
    const test::TemporaryDirectory work;
    std::ofstream in(work / "in", std::ios::binary);
    const auto write = [&](const auto& values) {
        in.write(reinterpret_cast<const char*>(values.data()),
                 static_cast<std::streamsize>(values.size() * sizeof values[0]));
    };
    write(soup.positions);
    write(soup.normals);
    write(soup.uv);
    in.close();
    const std::string script = std::filesystem::path(__FILE__).replace_filename("mikktspace.cjs").string();
    const std::string command = "NODE_PATH='" + std::string(folder) + "/node_modules' node '" + script + "' '" +
                                (work / "in").string() + "' '" + (work / "out").string() + "'";
    if (std::system(command.c_str()) != 0) return {};
    const std::vector<std::byte> bytes = read_file(work / "out");
    std::vector<vec4> out(bytes.size() / sizeof(vec4));
    std::memcpy(out.data(), bytes.data(), out.size() * sizeof(vec4));
    for (vec4& t : out) t.w = -t.w;  // the package leaves the turn to glTF's downward v to its caller
    return out;
}

// Without area in space or in uv a triangle has no tangent of its own: the package and we may choose differently.
bool is_degenerate(const Soup& soup, std::size_t triangle)
{
    const std::size_t i = 3 * triangle;
    const vec2 a = soup.uv[i + 1] - soup.uv[i];
    const vec2 b = soup.uv[i + 2] - soup.uv[i];
    const dvec3 area =
        cross(dvec3(soup.positions[i + 1] - soup.positions[i]), dvec3(soup.positions[i + 2] - soup.positions[i]));
    return a.x * b.y - a.y * b.x == 0 || length(area) == 0;
}

void expect_agreement(const Soup& soup, const std::string& what)
{
    const std::vector<vec4> truth = oracle(soup);
    ASSERT_EQ(truth.size(), soup.indices.size()) << what;
    const std::vector<vec4> ours = compute_tangents(soup.positions, soup.normals, soup.uv, soup.indices);
    std::size_t compared = 0;
    std::size_t identical = 0;
    double largest = 0;
    for (std::size_t i = 0; i < ours.size(); ++i) {
        // A zero tangent is the package's way to say that the corner's faces have no angle there.
        if (is_degenerate(soup, i / 3) || vec3(truth[i]) == vec3(0)) continue;
        const double angle = angle_between(normalize(dvec3(vec3(ours[i]))), normalize(dvec3(vec3(truth[i]))));
        ASSERT_EQ(ours[i].w, truth[i].w) << what << ": sign of corner " << i;
        ASSERT_LE(angle, kLargestAngle) << what << ": corner " << i;
        largest = std::max(largest, angle);
        identical += ours[i] == truth[i];
        ++compared;
    }
    EXPECT_GT(compared, ours.size() / 2) << what;
    std::printf("%s: %zu corners, %zu bit-equal, largest angle %.2g rad\n", what.c_str(), compared, identical, largest);
}

bool has_oracle()
{
    const Soup soup{{vec3(0), vec3(1, 0, 0), vec3(0, 1, 0)},
                    std::vector(3, vec3(0, 0, 1)),
                    {vec2(0), vec2(1, 0), vec2(0, 1)},
                    {0, 1, 2}};
    return oracle(soup).size() == 3;
}

TEST(Tangents, follow_u_and_have_the_sign_that_glTF_wants)
{
    const Primitive quad = make_rectangle(dvec3(0), dvec3(1, 0, 0), dvec3(0, 1, 0));
    for (const vec4& t : compute_tangents(quad.positions, quad.normals, quad.uv[0], quad.indices))
        EXPECT_EQ(t, vec4(1, 0, 0, 1));  // bitangent cross(z, x) = y: up the picture, where v falls
    std::vector<vec2> mirrored = quad.uv[0];
    for (vec2& uv : mirrored) uv.x = 1 - uv.x;
    for (const vec4& t : compute_tangents(quad.positions, quad.normals, mirrored, quad.indices))
        EXPECT_EQ(t, vec4(-1, 0, 0, -1));
}

TEST(Tangents, differ_across_the_seam_of_a_mirrored_mapping)
{
    // Two quads that share the edge x = 0, where both have u = 0; u grows away from it on either side.
    Soup strip;
    strip.positions = {vec3(-1, 0, 0), vec3(0, 0, 0), vec3(1, 0, 0), vec3(-1, 1, 0), vec3(0, 1, 0), vec3(1, 1, 0)};
    strip.normals.assign(6, vec3(0, 0, 1));
    strip.uv = {vec2(1, 1), vec2(0, 1), vec2(1, 1), vec2(1, 0), vec2(0, 0), vec2(1, 0)};
    strip.indices = {0, 1, 4, 0, 4, 3, 1, 2, 5, 1, 5, 4};
    const std::vector<vec4> tangents = compute_tangents(strip.positions, strip.normals, strip.uv, strip.indices);
    for (std::size_t i = 0; i < 6; ++i) EXPECT_EQ(tangents[i], vec4(-1, 0, 0, -1));
    for (std::size_t i = 6; i < 12; ++i) EXPECT_EQ(tangents[i], vec4(1, 0, 0, 1));
}

TEST(Tangents, are_unit_and_perpendicular_where_there_is_nothing_to_go_by)
{
    Soup soup;
    soup.positions = {vec3(0), vec3(1, 0, 0), vec3(0, 1, 0), vec3(2, 2, 2), vec3(2, 2, 2), vec3(3, 2, 2)};
    soup.normals.assign(6, vec3(0, 0, 1));
    soup.uv.assign(6, vec2(0.5f));  // no uv area; the second triangle has no area either
    soup.indices = {0, 1, 2, 3, 4, 5};
    for (const vec4& t : compute_tangents(soup.positions, soup.normals, soup.uv, soup.indices)) {
        EXPECT_FLOAT_EQ(length(vec3(t)), 1);
        EXPECT_EQ(t.z, 0);
    }
}

TEST(Tangents, of_an_empty_mesh_are_none)
{
    EXPECT_TRUE(compute_tangents({}, {}, {}, {}).empty());
}

TEST(Tangents, of_a_fan_of_100000_triangles_about_one_vertex_take_no_quadratic_time)
{
    Soup fan;
    fan.positions = {vec3(0)};
    fan.normals = {vec3(0, 0, 1)};
    fan.uv = {vec2(0)};
    for (std::uint32_t i = 0; i < 100'000; ++i) {
        const double turn = 6.28 * i / 100'000;
        fan.positions.emplace_back(dvec3(std::cos(turn), std::sin(turn), 0));
        fan.normals.emplace_back(0, 0, 1);
        fan.uv.emplace_back(std::cos(turn), std::sin(turn));
        if (i > 0) fan.indices.insert(fan.indices.end(), {0, i, i + 1});
    }
    // The mapping is the plane itself: u is x everywhere. v is y, so the bitangent -v asks for the negative sign.
    for (const vec4& t : compute_tangents(fan.positions, fan.normals, fan.uv, fan.indices)) {
        EXPECT_NEAR(t.x, 1, 1e-3);
        EXPECT_EQ(t.w, -1);
    }
}

TEST(Tangents, agree_with_the_published_code_on_real_assets)
{
    if (!has_oracle()) GTEST_SKIP() << "no mikktspace package: set ETALON_MIKKTSPACE";
    std::size_t assets = 0;
    for (const char* name :
         {"khronos/DamagedHelmet/DamagedHelmet.glb", "khronos/NormalTangentTest/NormalTangentTest.glb",
          "khronos/Avocado/Avocado.gltf", "khronos/Duck/Duck.glb",
          "khronos/MetalRoughSpheresNoTextures/MetalRoughSpheresNoTextures.glb", "khronos/BoxTextured/BoxTextured.gltf",
          "khronos/MaterialsVariantsShoe/MaterialsVariantsShoe.gltf", "khronos/SheenCloth/SheenCloth.gltf",
          "khronos/ClearCoatTest/ClearCoatTest.glb", "3dc/WickerChair/WickerChair.glb"}) {
        const auto path = test::find_shared(std::string("assets/") + name);
        if (!path) continue;
        const Scene scene = load_scene(path->string());
        Soup soup;
        for (const Mesh& mesh : scene.meshes)
            for (const Primitive& p : mesh.primitives)
                if (p.topology == Topology::triangles && !p.uv[0].empty()) add(soup, p, 0);
        if (soup.indices.empty()) continue;
        expect_agreement(soup, name);
        ++assets;
    }
    if (assets == 0) GTEST_SKIP() << "no shared inputs";
    EXPECT_GE(assets, 5u);
}

TEST(Tangents, agree_with_the_published_code_on_mirrored_torn_and_degenerate_meshes)
{
    if (!has_oracle()) GTEST_SKIP() << "no mikktspace package: set ETALON_MIKKTSPACE";
    Soup soup;
    add(soup, make_sphere(dvec3(0), 1, 32, 16), 0);
    Primitive mirrored = make_sphere(dvec3(3, 0, 0), 1, 24, 12);
    for (vec2& uv : mirrored.uv[0]) uv.x = std::abs(uv.x - 0.5f);
    add(soup, mirrored, 0);
    Primitive torn = make_sphere(dvec3(6, 0, 0), 1, 16, 8);
    for (std::size_t i = 0; i < torn.uv[0].size(); i += 3) torn.uv[0][i] = vec2(0.25f, 0.75f);
    add(soup, torn, 0);
    add(soup, make_box(dvec3(9, 0, 0), dvec3(1), 0.3), 0);
    expect_agreement(soup, "synthetic");
}

}  // namespace
}  // namespace etalon
