#pragma once
#include <utility>

#include "engine/render/render.h"
#include "engine/scene/builder.h"
#include "tests/gpu/device_test.h"

namespace etalon::test {

/// Draws a scene from (0, 0, 5) along -Z, orthographic: x and y of the world from -1 to 1 fill a square picture.
/// Black environment unless the scene has one.
inline Film draw(gpu::Device& device, SceneBuilder builder, const RenderSettings& settings = {}, ivec2 size = {9, 9})
{
    Camera camera;
    camera.orthographic = true;
    builder.camera(camera, translation({0, 0, 5}));
    const Scene scene = std::move(builder).finish();
    PoseSettings pose_settings{.size = size};
    pose_settings.no_environment = !scene.roots[0].environment.has_value();
    const PosedScene posed = pose(scene, pose_settings);
    return render_raster(device, posed, require(posed, settings), settings, {});
}

/// Of the pixel in the middle, at the world's origin in `draw` with its odd default size.
inline vec3 center(const Film& film)
{
    return film.mean[film.pixel_count() / 2];
}

/// A rectangle at height `z` that fills the picture, seen from its front.
inline Primitive wall(double z = 0)
{
    return make_rectangle({0, 0, z}, {2, 0, 0}, {0, 2, 0});
}

inline Light directional(dvec3 color, double lux)
{
    Light light;
    light.type = LightType::directional;
    light.color = color;
    light.intensity = lux;
    return light;
}

inline Environment constant_environment(dvec3 radiance)
{
    Environment environment;
    environment.radiance = radiance;
    return environment;
}

inline Material unlit(dvec4 color)
{
    Material material;
    material.model = BsdfModel::unlit;
    material.base_color = color;
    return material;
}

inline constexpr RenderSettings transparent(int msaa)
{
    RenderSettings settings;
    settings.background = Background::transparent;
    settings.msaa = msaa;
    return settings;
}

/// Each channel within `relative` of the expected one, and 1e-7.
inline void expect_radiance(const vec3& found, const dvec3& expected, double relative = 1e-5)
{
    for (int c = 0; c < 3; ++c)
        EXPECT_NEAR(found[c], expected[c], relative * std::abs(expected[c]) + 1e-7) << "channel " << c;
}

}  // namespace etalon::test
