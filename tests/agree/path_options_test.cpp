// The options of the two path tracers, against each other: cameras, samplers, glass in shadows.
#include <gtest/gtest.h>

#include <cmath>

#include "engine/reference/reference.h"
#include "engine/render/render.h"
#include "engine/scene/builder.h"
#include "engine/scene/load.h"
#include "path_pair.h"

namespace etalon::agree {
namespace {

/// Both renderers' pictures agree, and where they have one, their depths.
void expect_agreement_of(const std::string& what, const Scene& scene, const PoseSettings& view, RenderSettings how,
                         double must_find)
{
    gpu::Device device({.validate = true});
    const PosedScene posed = pose(scene, view);
    how.renderer = Renderer::path;
    how.seed = 11;
    const Film vulkan = render_path(device, posed, require(posed, how), how, {});
    how.renderer = Renderer::reference;
    how.seed = 1011;
    const Film reference = reference::render_path(posed, require(posed, how), how, {});
    expect_agreement(what, vulkan, reference, must_find);
    for (std::size_t i = 0; i < reference.aovs.depth.size(); ++i) {
        if (!std::isfinite(reference.aovs.depth[i]) || !std::isfinite(vulkan.aovs.depth[i])) continue;
        EXPECT_NEAR(vulkan.aovs.depth[i] / reference.aovs.depth[i], 1, 1e-4) << what << ", pixel " << i;
    }
    EXPECT_TRUE(device.validation_messages().empty()) << device.validation_messages().front();
}

TEST(PathOptions, TF_8_a_polygonal_aperture_agrees)
{
    PoseSettings view{.size = ivec2(64, 48)};
    view.lens = LensSettings{.f_stop = 0.1, .focus = 3.0, .blades = 5};
    expect_agreement_of("lens of 5 blades", make_builtin("spheres"), view, {.spp = 64, .max_depth = 4}, 0.03);
}

TEST(PathOptions, TF_9_all_directions_agree)
{
    PoseSettings view{.size = ivec2(96, 48)};
    view.projection = Projection::equirectangular;
    RenderSettings how{.spp = 64, .max_depth = 4};
    how.aovs = true;
    expect_agreement_of("equirectangular", make_builtin("spheres"), view, how, 0.03);
}

TEST(PathOptions, an_orthographic_view_of_a_perspective_camera_agrees)
{
    PoseSettings view{.size = ivec2(64, 48)};
    view.projection = Projection::orthographic;
    expect_agreement_of("orthographic", make_builtin("spheres"), view, {.spp = 32, .max_depth = 4}, 0.03);
}

TEST(PathOptions, MC_8_sobol_points_agree)
{
    RenderSettings how{.spp = 64, .max_depth = 5};
    how.sampler = Sequence::sobol;
    expect_agreement_of("sobol", make_builtin("cornell"), {.size = ivec2(48)}, how, 0.08);
}

TEST(PathOptions, SH_70_light_through_glass_agrees)
{
    SceneBuilder b("pane");
    b.show("floor", make_rectangle(dvec3(0), dvec3(3, 0, 0), dvec3(0, 0, -3)), b.lambert("grey", dvec3(0.5)));
    Material lamp;
    lamp.model = BsdfModel::lambert;
    lamp.emission = dvec3(40, 30, 20);
    b.show("lamp", make_rectangle(dvec3(0, 2, 0), dvec3(0.3, 0, 0), dvec3(0, 0, 0.3)), b.material(lamp));
    Material glass;
    glass.base_color = dvec4(0.9, 0.5, 1, 1);
    glass.metallic = 0;
    glass.roughness = 0;
    glass.double_sided = true;
    glass.layers.emplace();
    glass.layers->transmission = 1;
    glass.layers->ior = 1.8;
    const Index pane = b.material(glass);
    b.show("pane", make_rectangle(dvec3(0, 1, 0), dvec3(0.8, 0.2, 0), dvec3(0, 0, -0.8)), pane);
    b.sphere("bubble", dvec3(-0.8, 0.5, 0.6), 0.4, pane);
    b.light({.type = LightType::point, .color = dvec3(1, 2, 3), .intensity = 1}, translation(dvec3(1.5, 2, 0.5)));
    b.camera("eye", 45, dvec3(0, 2.2, 4), dvec3(0, 0.6, 0));
    RenderSettings how{.spp = 128, .max_depth = 6};
    how.glass_shadows = true;
    expect_agreement_of("glass shadows", std::move(b).finish(), {.size = ivec2(64, 48)}, how, 0.03);
}

}  // namespace
}  // namespace etalon::agree
