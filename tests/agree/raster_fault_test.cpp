#include <gtest/gtest.h>

#include <functional>

#include "engine/scene/builder.h"
#include "engine/scene/load.h"
#include "tests/agree/raster_pair.h"

// Faults of 1% planted in what the device draws: the comparison that passes without them must find each.
namespace etalon::agree {
namespace {

struct Fault {
    const char* why;
    const char* scene;
    std::function<void(Scene&)> plant;
    bool plain = false;  ///< without the scene's textures, whose weights a device rounds
};

void strip_textures(Scene& scene)
{
    for (Material& m : scene.materials) {
        m.base_color_texture = m.metallic_roughness_texture = m.normal_texture = {};
        if (!m.layers) continue;
        m.layers->transmission_texture = m.layers->iridescence_texture = {};
        m.layers->iridescence_thickness_texture = {};
    }
}

bool finds(gpu::Device& device, const PosedScene& honest, const PosedScene& faulty)
{
    // Without mipmaps the budget of a textured scene is that of 8-bit texel weights alone.
    RenderSettings settings;
    settings.mipmaps = false;
    const RasterBudget budget = budget_of(honest, settings, device.limits());
    const Film drawn = by_device(device, faulty, settings);
    return !compare_rasters(honest, settings, drawn, by_reference_raster(honest, settings), budget).holds();
}

TEST(RasterFaults, a_planted_error_of_one_per_cent_is_found)
{
    gpu::Device device;
    const std::vector<Fault> faults{
        {"a light 1% too bright", "lights", [](Scene& s) { s.lights[0].intensity *= 1.01; }},
        {"a reflectance 1% too high", "cornell",
         [](Scene& s) { s.materials[0].base_color *= dvec4(1.01, 1.01, 1.01, 1); }},
        {"a roughness 2% too high", "spheres",
         [](Scene& s) {
             for (Material& m : s.materials) m.roughness *= 1.02;
         }},
        {"normals turned by 0.01 rad", "normals",
         [](Scene& s) {
             for (Mesh& mesh : s.meshes)
                 for (Primitive& p : mesh.primitives)
                     for (vec3& n : p.normals) n = vec3(dmat3(rotation_y(0.01)) * dvec3(n));
         }},
        {"an environment 1% too bright", "furnace-lambert", [](Scene& s) { s.roots[0].environment->scale *= 1.01; }},
        {"a film 1% too thick", "iridescence",
         [](Scene& s) {
             for (Material& m : s.materials)
                 if (m.layers) m.layers->iridescence_thickness_max *= 1.01;
         },
         true},
        {"a transmission 20% too low", "transmission",
         [](Scene& s) {
             for (Material& m : s.materials)
                 if (m.layers) m.layers->transmission *= 0.8;
         },
         true},
        {"a vertex moved by a fifth of a pixel", "triangle",
         [](Scene& s) { s.meshes[0].primitives[0].positions[0].x += 0.004f; }},
    };
    for (const Fault& fault : faults) {
        Scene honest = make_builtin(fault.scene);
        if (fault.plain) strip_textures(honest);
        Scene faulty = honest;
        fault.plant(faulty);
        const PoseSettings settings{.size = ivec2(96, 72)};
        EXPECT_FALSE(finds(device, pose(honest, settings), pose(honest, settings))) << fault.why;
        EXPECT_TRUE(finds(device, pose(honest, settings), pose(faulty, settings))) << fault.why;
    }
}

}  // namespace
}  // namespace etalon::agree
