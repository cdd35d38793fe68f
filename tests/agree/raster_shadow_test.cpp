#include <fmt/format.h>
#include <gtest/gtest.h>

#include <iostream>

#include "engine/scene/builder.h"
#include "engine/scene/load.h"
#include "tests/agree/raster_pair.h"

// Shadow maps against shadow rays of the reference rasterizer: they may differ only about the edges of shadows.
namespace etalon::agree {
namespace {

struct Shadowed {
    double off = 0;   // share of pixels that differ by more than 2% of the brightest
    double mean = 0;  // relative error of the picture's mean
    double dark = 0;  // share of pixels that shadows change in the reference by so much
};

Shadowed shadowed(gpu::Device& device, const PosedScene& posed, RenderSettings settings, Shadows shadows)
{
    settings.shadows = Shadows::none;
    const Film plain = by_reference_raster(posed, settings);
    settings.shadows = shadows;
    const Film a = by_device(device, posed, settings);
    const Film b = by_reference_raster(posed, settings);
    double brightest = 0;
    for (const vec3& v : b.mean) brightest = std::max({brightest, double(v.x), double(v.y), double(v.z)});
    const auto differs = [&](const vec3& x, const vec3& y) {
        const vec3 d = glm::abs(x - y);
        return double(std::max({d.x, d.y, d.z})) > 0.02 * brightest;
    };
    Shadowed out;
    dvec3 of_a(0), of_b(0);
    for (std::size_t i = 0; i < a.pixel_count(); ++i) {
        out.off += differs(a.mean[i], b.mean[i]);
        out.dark += differs(plain.mean[i], b.mean[i]);
        of_a += dvec3(a.mean[i]);
        of_b += dvec3(b.mean[i]);
    }
    out.off /= double(a.pixel_count());
    out.dark /= double(a.pixel_count());
    out.mean = glm::length(of_a - of_b) / glm::length(of_b);
    return out;
}

TEST(RasterShadows, differ_from_shadow_rays_about_the_edges_alone)
{
    gpu::Device device;
    for (const char* name : {"lights", "normals", "blinn-phong"}) {
        const Scene scene = make_builtin(name);
        const Shadowed found = shadowed(device, pose(scene, {.size = ivec2(128, 96)}), {}, Shadows::map);
        std::cout << fmt::format("{:12} shadows on {:.1f}% of the pixels; off in {:.2f}%, mean by {:.3f}%\n", name,
                                 100 * found.dark, 100 * found.off, 100 * found.mean);
        EXPECT_GT(found.dark, 0.005) << name;
        EXPECT_LT(found.off, 0.03) << name;
        EXPECT_LT(found.mean, 0.004) << name;
    }
}

/// The same rays, but for what one of several samples of a pixel shows: the device has the shadow at the pixel's
/// centre.
TEST(RasterShadows, SH_45_by_rays_are_those_of_the_reference)
{
    gpu::Device device;
    RenderSettings settings;
    settings.msaa = 1;
    for (const char* name : {"lights", "normals", "blinn-phong"}) {
        const Scene scene = make_builtin(name);
        const Shadowed found = shadowed(device, pose(scene, {.size = ivec2(96, 72)}), settings, Shadows::ray);
        std::cout << fmt::format("{:12} shadows on {:.1f}% of the pixels; rays off in {:.2f}%, mean by {:.3f}%\n", name,
                                 100 * found.dark, 100 * found.off, 100 * found.mean);
        EXPECT_GT(found.dark, 0.005) << name;
        EXPECT_LT(found.off, 0.002) << name;
        EXPECT_LT(found.mean, 0.001) << name;
    }
}

/// A plane, tilted against the light, and nothing else: any shadow on it is its own.
TEST(RasterShadows, SH_43_SH_45_no_surface_shadows_itself_at_any_slope_or_distance)
{
    gpu::Device device;
    for (const double scale : {1e-3, 1e4})
        for (const double tilt : {0.0, 1.0, 1.55})
            for (const LightType type : {LightType::directional, LightType::point, LightType::spot}) {
                SceneBuilder scene("tilted");
                Material matt;
                matt.double_sided = true;
                matt.roughness = 1;
                matt.metallic = 0;
                scene.show("plane", make_rectangle(dvec3(0), dvec3(scale, 0, 0), dvec3(0, 0, -scale)),
                           scene.material(matt));
                Light light;
                light.type = type;
                light.outer_cone = 1;
                light.intensity = type == LightType::directional ? 1 : scale * scale;
                const dvec3 towards(std::sin(tilt), std::cos(tilt), 0);
                scene.light(light, look_from(2 * scale * towards + dvec3(0, 0, 1e-3 * scale), dvec3(0)));
                Camera camera;
                camera.orthographic = true;
                camera.xmag = camera.ymag = scale;
                camera.znear = 0.01 * scale;
                scene.camera(camera, look_from(dvec3(0, 3 * scale, 1e-3 * scale), dvec3(0)));
                const Scene whole = std::move(scene).finish();
                PoseSettings view{.size = ivec2(40)};
                view.no_environment = true;
                const PosedScene posed = pose(whole, view);
                RenderSettings settings;
                settings.msaa = 1;
                const Film bare = by_device(device, posed, settings);
                for (const Shadows shadows : {Shadows::map, Shadows::ray}) {
                    if (shadows == Shadows::ray && tilt != 1.55) continue;  // where it is hardest
                    settings.shadows = shadows;
                    const Film film = by_device(device, posed, settings);
                    int darker = 0;
                    for (std::size_t i = 0; i < film.pixel_count(); ++i)
                        darker += film.mean[i].x < 0.999f * bare.mean[i].x;
                    EXPECT_EQ(darker, 0) << "scale " << scale << " tilt " << tilt << " light " << int(type) << " by "
                                         << int(shadows);
                }
            }
}

}  // namespace
}  // namespace etalon::agree
