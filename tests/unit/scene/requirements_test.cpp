// What a scene asks of a renderer: each bit is set by what needs it, with its cause, and by nothing else.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <functional>

#include "engine/base/error.h"
#include "engine/scene/builder.h"
#include "engine/scene/load.h"
#include "engine/scene/requirements.h"

namespace etalon {
namespace {

using testing::HasSubstr;

// A floor that is drawn flat, in one colour, unlit by anything: the least that a scene asks for.
struct Bench {
    Scene scene;
    PoseSettings pose_settings;
    RenderSettings settings;

    Bench()
    {
        SceneBuilder build("bench");
        Material plain;
        plain.name = "plain";
        build.texture("t", 1, 1, Sampler{}, [](int, int) { return std::array<std::uint8_t, 4>{1, 2, 3, 4}; });
        build.show("floor", make_rectangle(dvec3(0), dvec3(1, 0, 0), dvec3(0, 0, -1)), build.material(plain));
        build.environment(Environment{});
        build.camera("eye", 45, dvec3(0, 1, 3), dvec3(0));
        scene = std::move(build).finish();
        settings.msaa = 1;
    }
    Material& material() { return scene.materials[0]; }
    Primitive& primitive() { return scene.meshes[0].primitives[0]; }
    Camera& camera() { return scene.cameras[0]; }
    SceneRoot& root() { return scene.roots[0]; }
};

std::string bits(const Requirements& required)
{
    std::string out;
    for (std::size_t i = 0; i < kFeatureCount; ++i)
        if (required.bits[i]) out += std::string(out.empty() ? "" : " ") + std::string(name(static_cast<Feature>(i)));
    return out;
}

Requirements require(const Bench& bench)
{
    return require(pose(bench.scene, bench.pose_settings), bench.settings);
}

TEST(Requirements, of_a_plain_scene_are_few)
{
    const Requirements required = require(Bench());
    EXPECT_EQ(bits(required), "triangles metallic_roughness");
    EXPECT_EQ(required.cause[std::size_t(Feature::triangles)], "mesh 0 (floor) primitive 0");
    EXPECT_EQ(required.cause[std::size_t(Feature::metallic_roughness)], "material 0 (plain)");
    EXPECT_FALSE(required.texture_used[0]);
    EXPECT_TRUE(required.material_used[0]);
}

struct Case {
    const char* what;
    std::function<void(Bench&)> change;
    const char* added;  // bits beside those of the plain scene
};

TEST(Requirements, set_a_bit_for_each_thing_that_needs_it)
{
    const auto texture = [](TextureUse& use, int set = 0) {
        use.texture = 0;
        use.uv_set = set;
    };
    for (const Case& c : {
             Case{"vertex normals", [](Bench& b) { b.primitive().has_normals = true; }, "normals"},
             Case{"vertex colours", [](Bench& b) { b.primitive().colors.assign(4, vec4(0.5f)); }, "vertex_colors"},
             Case{"base colour texture", [&](Bench& b) { texture(b.material().base_color_texture); },
                  "uv0 base_color_texture mipmaps"},
             Case{"of the second uv set", [&](Bench& b) { texture(b.material().base_color_texture, 1); },
                  "uv1 base_color_texture mipmaps"},
             Case{"without mipmaps by the settings",
                  [&](Bench& b) {
                      texture(b.material().base_color_texture);
                      b.settings.mipmaps = false;
                  },
                  "uv0 base_color_texture"},
             Case{"without mipmaps by the sampler",
                  [&](Bench& b) {
                      texture(b.material().base_color_texture);
                      b.scene.textures[0].sampler.mipmapped = false;
                  },
                  "uv0 base_color_texture"},
             Case{"metallic-roughness texture", [&](Bench& b) { texture(b.material().metallic_roughness_texture); },
                  "uv0 metallic_roughness_texture mipmaps"},
             Case{"normal map with tangents",
                  [&](Bench& b) {
                      texture(b.material().normal_texture);
                      b.primitive().tangents.assign(4, vec4(1));
                  },
                  "tangents uv0 normal_texture mipmaps"},
             Case{"occlusion without an environment", [&](Bench& b) { texture(b.material().occlusion_texture); }, ""},
             Case{"emissive texture of no emission", [&](Bench& b) { texture(b.material().emissive_texture); }, ""},
             Case{"emissive texture",
                  [&](Bench& b) {
                      texture(b.material().emissive_texture);
                      b.material().emission = dvec3(1);
                  },
                  "uv0 emissive_texture mipmaps emission"},
             Case{"emission", [](Bench& b) { b.material().emission = dvec3(1); }, "emission"},
             Case{"texture transform",
                  [&](Bench& b) {
                      texture(b.material().base_color_texture);
                      b.material().base_color_texture.transform[0][0] = 2;
                  },
                  "uv0 base_color_texture texture_transform mipmaps"},
             Case{"mask", [](Bench& b) { b.material().alpha_mode = AlphaMode::mask; }, "alpha_mask"},
             Case{"blend", [](Bench& b) { b.material().alpha_mode = AlphaMode::blend; }, "alpha_blend"},
             Case{"double sided", [](Bench& b) { b.material().double_sided = true; }, "double_sided"},
             Case{"msaa", [](Bench& b) { b.settings.msaa = 4; }, "msaa"},
             Case{"aovs", [](Bench& b) { b.settings.aovs = true; }, "uv0 aovs"},
             Case{"orthographic", [](Bench& b) { b.camera().orthographic = true; }, "orthographic"},
             Case{"Blinn-Phong", [](Bench& b) { b.settings.shading = Shading::blinn_phong; }, "blinn_phong"},
             Case{"constant environment", [](Bench& b) { b.root().environment->radiance = dvec3(1); },
                  "environment_constant visible_background"},
             Case{"not seen behind the scene",
                  [](Bench& b) {
                      b.root().environment->radiance = dvec3(1);
                      b.settings.background = Background::transparent;
                  },
                  "environment_constant"},
             Case{"environment map", [](Bench& b) { b.root().environment = studio_environment(); },
                  "environment_map visible_background"},
             Case{"a light",
                  [](Bench& b) {
                      b.scene.lights.emplace_back();
                      b.scene.nodes[0].light = 0;
                  },
                  "punctual_lights"},
             Case{"a light of intensity 0",
                  [](Bench& b) {
                      b.scene.lights.emplace_back().intensity = 0;
                      b.scene.nodes[0].light = 0;
                  },
                  ""},
             Case{"a sphere", [](Bench& b) { b.scene.nodes[0].sphere = SphereShape{}; }, "spheres"},
             Case{"lens of a rasterizer",
                  [](Bench& b) {
                      b.camera().lens = ThinLens{0.1, 1};
                  },
                  ""},
         }) {
        Bench bench;
        c.change(bench);
        const Requirements required = require(bench);
        std::string expected = c.added;
        std::string got = bits(required);
        for (const std::string common : {"triangles", "metallic_roughness"}) {
            const std::size_t at = (" " + got + " ").find(" " + common + " ");
            ASSERT_NE(at, std::string::npos) << c.what;
            got.erase(at, common.size() + (at + common.size() < got.size() ? 1 : 0));
        }
        while (got.ends_with(' ')) got.pop_back();
        EXPECT_EQ(got, expected) << c.what;
        for (std::size_t i = 0; i < kFeatureCount; ++i)
            EXPECT_EQ(required.bits[i], !required.cause[i].empty()) << name(static_cast<Feature>(i));
    }
}

TEST(Requirements, of_an_unlit_scene_need_no_light_and_no_normals)
{
    Bench bench;
    bench.material().model = BsdfModel::unlit;
    bench.primitive().has_normals = true;
    bench.scene.lights.emplace_back();
    bench.scene.nodes[0].light = 0;
    bench.root().environment->radiance = dvec3(1);
    bench.settings.background = Background::transparent;
    EXPECT_EQ(bits(require(bench)), "triangles unlit");
}

TEST(Requirements, of_a_path_tracer_leave_out_what_it_does_not_do)
{
    Bench bench;
    bench.settings.renderer = Renderer::path;
    bench.settings.msaa = 4;
    bench.settings.shading = Shading::blinn_phong;
    bench.material().base_color_texture.texture = 0;
    bench.material().occlusion_texture.texture = 0;
    bench.root().environment->radiance = dvec3(1);
    bench.camera().lens = ThinLens{0.1, 1};
    Primitive lines = bench.primitive();
    lines.topology = Topology::lines;
    bench.scene.meshes[0].primitives.push_back(lines);
    EXPECT_EQ(bits(require(bench)),
              "triangles uv0 base_color_texture metallic_roughness environment_constant visible_background thin_lens");
}

TEST(Requirements, forget_what_is_not_drawn)
{
    Bench bench;
    bench.material().double_sided = true;
    bench.material().emission = dvec3(1);
    bench.scene.nodes[0].visible = false;
    EXPECT_EQ(bits(require(bench)), "");
    EXPECT_FALSE(require(bench).material_used[0]);
}

TEST(Requirements, of_each_built_in_scene_have_names_and_causes)
{
    for (const BuiltinScene& row : builtin_scenes()) {
        const Scene scene = make_builtin(row.name);
        for (const Renderer renderer : {Renderer::raster, Renderer::path}) {
            RenderSettings settings;
            settings.renderer = renderer;
            const Requirements required = require(pose(scene), settings);
            EXPECT_TRUE(required.bits.any()) << row.name;
            for (std::size_t i = 0; i < kFeatureCount; ++i)
                EXPECT_EQ(required.bits[i], !required.cause[i].empty())
                    << row.name << ' ' << name(static_cast<Feature>(i));
        }
    }
}

TEST(Requirements, TF_9_rasterizers_refuse_to_see_all_around)
{
    const Scene scene = make_builtin("triangle");
    PoseSettings view;
    view.projection = Projection::equirectangular;
    const PosedScene posed = pose(scene, view);
    for (const Renderer renderer : {Renderer::raster, Renderer::reference_raster})
        EXPECT_THROW(require(posed, {.renderer = renderer}), Error);
    EXPECT_TRUE(require(posed, {.renderer = Renderer::path}).has(Feature::equirectangular));
}

TEST(Requirements, every_feature_is_exercised_by_some_built_in_scene)
{
    std::bitset<kFeatureCount> seen;
    for (const BuiltinScene& row : builtin_scenes())
        for (const Renderer renderer : {Renderer::raster, Renderer::path}) {
            RenderSettings settings;
            settings.renderer = renderer;
            settings.shading = row.name == "blinn-phong" ? Shading::blinn_phong : Shading::pbr;
            settings.aovs = row.name == "triangle";
            const Scene scene = make_builtin(row.name);
            PoseSettings view;
            if (renderer == Renderer::path && row.name == "furnace") view.projection = Projection::equirectangular;
            seen |= require(pose(scene, view), settings).bits;
        }
    for (std::size_t i = 0; i < kFeatureCount; ++i) EXPECT_TRUE(seen[i]) << name(static_cast<Feature>(i));
}

}  // namespace
}  // namespace etalon
