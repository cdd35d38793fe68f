// The built-in scenes are well-formed, lit, seen, and small.
#include <gtest/gtest.h>

#include "engine/scene/inventory.h"
#include "engine/scene/load.h"
#include "engine/scene/pose.h"

namespace etalon {
namespace {

// Every promise of engine/scene/scene.h that can be checked.
void expect_valid(const Scene& scene)
{
    for (const Mesh& mesh : scene.meshes)
        for (const Primitive& p : mesh.primitives) {
            const std::size_t n = p.positions.size();
            for (const std::size_t size :
                 {p.normals.size(), p.tangents.size(), p.uv[0].size(), p.uv[1].size(), p.colors.size()})
                EXPECT_TRUE(size == 0 || size == n) << scene.name << ' ' << mesh.name;
            for (const std::uint32_t i : p.indices) ASSERT_LT(i, n);
            for (const vec3& v : p.normals) EXPECT_NEAR(length(v), 1, 1e-5) << scene.name << ' ' << mesh.name;
            for (const vec4& t : p.tangents) {
                EXPECT_NEAR(length(vec3(t)), 1, 1e-5);
                EXPECT_EQ(std::abs(t.w), 1);
            }
            ASSERT_LT(p.material, scene.materials.size());
            if (p.topology != Topology::triangles) continue;
            ASSERT_EQ(p.normals.size(), n) << scene.name;
            for (std::size_t t = 0; t < p.indices.size() / 3; ++t) {
                const auto corner = [&](std::size_t i) { return p.indices[3 * t + i]; };
                const dvec3 a(p.positions[corner(0)]), b(p.positions[corner(1)]), c(p.positions[corner(2)]);
                const dvec3 face = normalize(cross(b - a, c - a));
                for (std::size_t i = 0; i < 3; ++i)
                    EXPECT_GT(dot(face, dvec3(p.normals[corner(i)])), 0)
                        << scene.name << ' ' << mesh.name << ": the winding agrees with the normals";
            }
        }
    for (const Material& m : scene.materials)
        for (const TextureUse& use : {m.base_color_texture, m.metallic_roughness_texture, m.normal_texture,
                                      m.occlusion_texture, m.emissive_texture})
            if (use.present()) {
                ASSERT_LT(use.texture, scene.textures.size());
                ASSERT_LT(scene.textures[use.texture].image, scene.images.size());
            }
    for (const Texels& image : scene.images)
        EXPECT_EQ(image.bytes.size(), std::size_t(image.width) * std::size_t(image.height) * 4);
}

TEST(Builtin, scenes_are_valid_small_seen_and_lit)
{
    EXPECT_GE(builtin_scenes().size(), 10u);
    for (const BuiltinScene& row : builtin_scenes()) {
        const Scene scene = make_builtin(row.name);
        EXPECT_EQ(scene.name, "builtin:" + std::string(row.name));
        EXPECT_FALSE(row.summary.empty());
        expect_valid(scene);
        const PosedScene posed = pose(scene);
        EXPECT_TRUE(posed.notes.empty()) << row.name << " has its own camera and light";
        EXPECT_FALSE(posed.draws.empty() && posed.spheres.empty()) << row.name;
        EXPECT_LE(posed.view.width * posed.view.height, 512 * 512) << row.name;
        const Inventory holds = describe(scene);
        EXPECT_LT(holds.geometry_bytes + holds.texture_bytes, 8u << 20) << row.name;
    }
}

TEST(Builtin, load_scene_takes_them_by_name)
{
    EXPECT_EQ(load_scene("builtin:cornell").materials.size(), 4u);
}

TEST(Inventory, counts_what_is_there)
{
    const Inventory cornell = describe(make_builtin("cornell"));
    EXPECT_EQ(cornell.triangles, 2u * (3 + 1 + 1 + 5 + 5 + 1));
    EXPECT_EQ(cornell.vertices, 4u * (3 + 1 + 1 + 6 + 6 + 1));
    EXPECT_EQ(cornell.geometry_bytes, cornell.vertices * (12 + 12 + 8) + cornell.triangles * 12);
    EXPECT_EQ(cornell.cameras.at(0).name, "front");
    EXPECT_EQ(cornell.materials.size(), 4u);
    EXPECT_TRUE(cornell.materials.at(3).emits);
    EXPECT_EQ(cornell.roots.at(0).nodes, cornell.nodes);
    const Inventory maps = describe(make_builtin("maps"));
    EXPECT_EQ(maps.images.size(), 4u);
    EXPECT_EQ(maps.materials.at(0).textures, 4);
    EXPECT_EQ(maps.texture_bytes, 16u * 16 * 16 / 3 + 3 * (64 * 64 * 16 / 3));
    EXPECT_EQ(describe(make_builtin("instances")).instances, 1000u);
    EXPECT_EQ(describe(make_builtin("furnace")).spheres, 6u);
    EXPECT_EQ(describe(make_builtin("wires")).points, 400u);
    EXPECT_EQ(describe(make_builtin("lights")).lights.at(1).type, "spot");
}

}  // namespace
}  // namespace etalon
