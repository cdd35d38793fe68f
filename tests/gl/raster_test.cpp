// The rasterizer by Vulkan and by OpenGL, scene by scene: docs/raster_budget.md, "OpenGL and Vulkan".
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <iostream>

#include "engine/render/post.h"
#include "engine/render/render.h"
#include "engine/scene/load.h"

namespace etalon::test {
namespace {

using testing::HasSubstr;
using testing::IsEmpty;

constexpr double kOperations =
    100 * 0x1p-24;              // about a hundred operations, each rounded otherwise by half a step twice
constexpr double kTurn = 4e-7;  // of a direction, radians

struct Budget {
    double relative = kOperations;  ///< of the pixel's value
    double absolute = kOperations;  ///< of the brightest value
};

double sharpest_alpha(const Material& material)
{
    double alpha = material.roughness * material.roughness;
    if (material.model == BsdfModel::lambert || material.model == BsdfModel::unlit) return 1;
    if (material.model != BsdfModel::metallic_roughness && material.model != BsdfModel::specular_glossiness)
        alpha = material.ggx_alpha;
    if (material.metallic_roughness_texture.present()) alpha = 0;
    if (material.layers && material.layers->clearcoat > 0)
        alpha = std::min(alpha, material.layers->clearcoat_roughness * material.layers->clearcoat_roughness);
    return std::max(alpha, 1e-3);
}

Budget budget_of(const PosedScene& posed)
{
    double alpha = 1;
    for (const Material& material : posed.materials()) alpha = std::min(alpha, sharpest_alpha(material));
    Budget budget;
    budget.relative += 2 * 2 * kTurn / alpha;
    if (!posed.scene->textures.empty()) budget.absolute += 0x1p-10;
    if (posed.environment.map) budget.absolute += 2 * kTurn * 512 / (2 * kPi);
    return budget;
}

struct Difference {
    std::size_t pixels = 0;   ///< that are not the same bits
    std::size_t covered = 0;  ///< whose alpha or object differs
    double worst = 0;         ///< of the budget
    double largest = 0;       ///< |a - b| of the brightest value
};

Difference difference(const Film& a, const Film& b, const Budget& budget)
{
    double brightest = 1e-30;
    for (const vec3& value : a.mean)
        for (int c = 0; c < 3; ++c) brightest = std::max(brightest, std::abs(double{value[c]}));
    Difference found;
    for (std::size_t i = 0; i < a.mean.size(); ++i) {
        found.pixels += a.mean[i] != b.mean[i] ? 1 : 0;
        bool covered = std::abs(a.alpha[i] - b.alpha[i]) > 1e-6f;
        if (!a.aovs.object_id.empty())
            covered |= a.aovs.object_id[i] != b.aovs.object_id[i] || a.aovs.material_id[i] != b.aovs.material_id[i];
        found.covered += covered ? 1 : 0;
        for (int c = 0; c < 3; ++c) {
            const double off = std::abs(double{a.mean[i][c]} - double{b.mean[i][c]});
            const double allowed = budget.relative * std::abs(double{a.mean[i][c]}) + budget.absolute * brightest;
            found.worst = std::max(found.worst, off / allowed);
            found.largest = std::max(found.largest, off / brightest);
        }
    }
    return found;
}

class GlRaster : public testing::Test {
 protected:
    Film draw(gpu::Device& device, const PosedScene& posed, const RenderSettings& settings)
    {
        return render_raster(device, posed, require(posed, settings), settings, {});
    }
    void expect_same(const std::string& what, const PosedScene& posed, const RenderSettings& settings)
    {
        const Film a = draw(vulkan_, posed, settings);
        const Film b = draw(opengl_, posed, settings);
        const Budget budget = budget_of(posed);
        const Difference found = difference(a, b, budget);
        std::cout << fmt::format(
            "{:28} budget {:.1e} + {:.1e}; {:4} of {} pixels differ, worst {:.3f} of the budget, {:.1e} of the "
            "brightest\n",
            what, budget.relative, budget.absolute, found.pixels, a.mean.size(), found.worst, found.largest);
        EXPECT_LE(found.worst, 1) << what;
        EXPECT_EQ(found.covered, 0u) << what;
        EXPECT_EQ(a.nonfinite, b.nonfinite) << what;
        EXPECT_EQ(a.samples, b.samples) << what;
    }
    void TearDown() override { EXPECT_THAT(opengl_.validation_messages(), IsEmpty()); }

    gpu::Device vulkan_;  // validated by tests of its own
    gpu::Device opengl_{gpu::DeviceOptions{.backend = gpu::Backend::opengl, .device = "EGL", .validate = true}};
};

TEST_F(GlRaster, every_built_in_scene_is_what_vulkan_draws)
{
    for (const BuiltinScene& row : builtin_scenes()) {
        const Scene scene = make_builtin(row.name);
        expect_same(std::string(row.name), pose(scene, {.size = ivec2(48, 36)}), {});
    }
}

TEST_F(GlRaster, one_sample_a_pixel_and_every_background_are_what_vulkan_draws)
{
    const Scene scene = make_builtin("spheres");
    const PosedScene posed = pose(scene, {.size = ivec2(48, 36)});
    RenderSettings one{.aovs = true};
    one.msaa = 1;
    expect_same("one sample", posed, one);
    expect_same("transparent", posed, {.background = Background::transparent, .aovs = true});
    expect_same("colour", posed,
                {.background = Background::colour, .background_color = dvec3(0.2, 0.4, 0.1), .aovs = true});
}

TEST_F(GlRaster, every_setting_is_what_vulkan_draws)
{
    const auto scene_of = [](const char* name) { return make_builtin(name); };
    const Scene lights = scene_of("lights"), plane = scene_of("texture-plane"), wires = scene_of("wires");
    const PoseSettings small{.size = ivec2(48, 36)};
    RenderSettings supersampled;
    supersampled.ssaa = 2;
    supersampled.pixel_filter = PixelFilter::gaussian;
    expect_same("supersampling", pose(plane, small), supersampled);
    RenderSettings anisotropic;
    anisotropic.anisotropy = 8;
    expect_same("anisotropy", pose(plane, small), anisotropic);
    RenderSettings shadowed;
    shadowed.shadows = Shadows::map;
    expect_same("shadow maps", pose(lights, small), shadowed);
    RenderSettings forward;
    forward.depth = DepthKind::forward_24;
    expect_same("24-bit depth", pose(lights, small), forward);
    RenderSettings wide;
    wide.point_size = 3;
    wide.line_width = 2;
    expect_same("wide points and lines", pose(wires, small), wide);
}

TEST_F(GlRaster, rays_are_refused_by_name)
{
    const Scene scene = make_builtin("lights");
    const PosedScene posed = pose(scene, {.size = ivec2(8)});
    RenderSettings shadows, ambient;
    shadows.shadows = Shadows::ray;
    ambient.ambient_rays = 1;
    for (const RenderSettings& settings : {shadows, ambient}) {
        try {
            draw(opengl_, posed, settings);
            ADD_FAILURE() << "drawn";
        } catch (const Error& error) {
            EXPECT_EQ(error.blame(), Blame::machine);
            EXPECT_THAT(error.what(), HasSubstr("Vulkan"));
        }
    }
}

TEST_F(GlRaster, post_passes_make_of_a_film_what_they_make_by_vulkan)
{
    const Scene scene = make_builtin("spheres");
    const PosedScene posed = pose(scene, {.size = ivec2(48, 36)});
    const Film film = draw(vulkan_, posed, {.aovs = true});
    for (const char* passes : {"gaussian", "median", "bilateral:sigma_s=2", "atrous", "bloom", "sobel", "fxaa",
                               "exposure,tone", "bilateral:method=grid"}) {
        const PostChain chain = parse_post(passes);
        const Film a = apply_post(vulkan_, film, chain);
        const Film b = apply_post(opengl_, film, chain);
        const Difference found = difference(a, b, {});
        EXPECT_LE(found.worst, 1) << passes << ": " << found.largest << " of the brightest";
    }
}

TEST_F(GlRaster, osmesa_draws_the_bits_of_egl)
{
    const Scene scene = make_builtin("maps");
    const PosedScene posed = pose(scene, {.size = ivec2(48, 36)});
    const Film a = draw(opengl_, posed, {});
    opengl_ = gpu::Device({.backend = gpu::Backend::opengl, .device = "OSMesa", .validate = true});
    const Film b = draw(opengl_, posed, {});
    EXPECT_EQ(a.mean, b.mean);
    EXPECT_EQ(a.alpha, b.alpha);
    EXPECT_THAT(b.metadata.at("device"), HasSubstr("OSMesa"));
}

/// The budget must find what is wrong by a thousandth.
TEST_F(GlRaster, a_thousandth_of_a_light_or_a_colour_is_found)
{
    const Scene scene = make_builtin("blinn-phong");
    const PosedScene posed = pose(scene, {.size = ivec2(48, 36)});
    const Film a = draw(vulkan_, posed, {.aovs = true});
    PosedScene brighter = posed;
    for (PosedLight& light : brighter.lights) light.light.intensity *= 1.001;
    EXPECT_GT(difference(a, draw(opengl_, brighter, {.aovs = true}), budget_of(posed)).worst, 1);
    Scene other = scene;
    for (Material& material : other.materials) material.base_color *= dvec4(1.001, 1.001, 1.001, 1);
    const PosedScene recoloured = pose(other, {.size = ivec2(48, 36)});
    EXPECT_GT(difference(a, draw(opengl_, recoloured, {.aovs = true}), budget_of(posed)).worst, 1);
}

}  // namespace
}  // namespace etalon::test
