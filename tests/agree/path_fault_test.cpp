// An error of one percent on one side alone must be found, or agreement means nothing.
#include <gtest/gtest.h>

#include <functional>

#include "engine/scene/builder.h"
#include "path_pair.h"

namespace etalon::agree {
namespace {

constexpr Shot kShot{.size = {64, 64}, .spp = 256, .max_depth = 3};

/// A matt floor and a rough metal sphere, both with vertex normals, under a sun at 45° and a faint sky, and a lamp in
/// view.
Scene subject()
{
    SceneBuilder build("fault");
    build.show("floor", make_rectangle(dvec3(0), dvec3(3, 0, 0), dvec3(0, 0, -3)),
               build.metallic_roughness("floor", dvec3(0.5, 0.4, 0.3), 0, 0.9));
    build.show("ball", make_sphere(dvec3(0.6, 0.8, 0), 0.8, 48, 24),
               build.metallic_roughness("ball", dvec3(0.8, 0.7, 0.5), 1, 0.5));
    Material lamp;
    lamp.name = "lamp";
    lamp.base_color = dvec4(0, 0, 0, 1);
    lamp.emission = dvec3(1);
    build.show("lamp", make_rectangle(dvec3(-1.2, 0.9, 0), dvec3(0.5, 0, 0), dvec3(0, 0.5, 0)), build.material(lamp));
    Light sun;
    sun.name = "sun";
    sun.type = LightType::directional;
    sun.intensity = 2;
    build.light(sun, look_from(dvec3(2, 2, 0), dvec3(0)));
    Environment sky;
    sky.radiance = dvec3(0.3);
    build.environment(sky);
    build.camera("camera", 40, dvec3(0, 2, 5), dvec3(0, 0.6, 0));
    return std::move(build).finish();
}

Index material_named(const Scene& scene, const std::string& name)
{
    for (Index i = 0; i < scene.materials.size(); ++i)
        if (scene.materials[i].name == name) return i;
    ADD_FAILURE() << "no material " << name;
    return 0;
}

/// Turns the vertex normals of the primitives of `material` by `angle` about -Z, towards the sun (+X).
void tilt_normals(Scene& scene, Index material, double angle)
{
    for (Mesh& mesh : scene.meshes) {
        for (Primitive& primitive : mesh.primitives) {
            if (primitive.material != material) continue;
            ASSERT_FALSE(primitive.normals.empty());
            for (vec3& n : primitive.normals)
                n = vec3(dvec3(std::cos(angle) * n.x + std::sin(angle) * n.y,
                               std::cos(angle) * n.y - std::sin(angle) * n.x, n.z));
            primitive.has_normals = true;
        }
    }
}

struct Fault {
    const char* what;
    std::function<void(Scene&)> plant;
};

const std::vector<Fault>& faults()
{
    static const std::vector<Fault> kFaults{
        {"albedo of the floor 1% up",
         [](Scene& s) { s.materials[material_named(s, "floor")].base_color *= dvec4(1.01, 1.01, 1.01, 1); }},
        {"reflectance of the metal 1% up",
         [](Scene& s) { s.materials[material_named(s, "ball")].base_color *= dvec4(1.01, 1.01, 1.01, 1); }},
        {"roughness of the metal 2% up (alpha 4%)",
         [](Scene& s) { s.materials[material_named(s, "ball")].roughness *= 1.02; }},
        {"sun 1% up", [](Scene& s) { s.lights[0].intensity *= 1.01; }},
        {"lamp 1% up", [](Scene& s) { s.materials[material_named(s, "lamp")].emission *= 1.01; }},
        {"sky 1% up", [](Scene& s) { s.roots[0].environment->radiance *= 1.01; }},
        {"normals of the floor 0.01 rad towards the sun",
         [](Scene& s) { tilt_normals(s, material_named(s, "floor"), 0.01); }},
    };
    return kFaults;
}

TEST(PathAgreement, ST4_finds_every_planted_error_of_one_percent)
{
    gpu::Device device;
    const Scene scene = subject();
    const Film reference = by_reference(scene, kShot);
    expect_agreement("without a fault", by_vulkan(device, scene, kShot), reference, 0.002);
    for (const auto& [what, plant] : faults()) {
        Scene faulty = scene;
        plant(faulty);
        const Comparison found = compare(by_vulkan(device, faulty, kShot), reference, settings());
        EXPECT_EQ(found.verdict, Verdict::different) << what;
        std::printf("%s: %s\n", what, found.reasons.empty() ? "not found" : found.reasons.front().c_str());
    }
}

/// The same faults in the reference alone: what is found does not depend on which side is wrong, nor on a device.
TEST(PathAgreement, ST4_finds_the_same_errors_between_two_runs_of_the_reference)
{
    const Scene scene = subject();
    Shot other = kShot;
    other.seed = kShot.seed + 1;
    const Film reference = by_reference(scene, kShot);
    for (const auto& [what, plant] : faults()) {
        Scene faulty = scene;
        plant(faulty);
        EXPECT_EQ(compare(by_reference(faulty, other), reference, settings()).verdict, Verdict::different) << what;
    }
}

}  // namespace
}  // namespace etalon::agree
