#include <cmath>

#include "engine/render/albedo.h"
#include "tests/gpu/raster_stage.h"

// Radiances of a wall that faces an orthographic viewer, by hand from docs/shading.md: n = wo = +Z.
namespace etalon::test {
namespace {

class RasterShading : public DeviceTest {
 protected:
    vec3 lit_wall(const Material& material, const Light& light, const dmat4& place, const RenderSettings& settings = {})
    {
        SceneBuilder scene("wall");
        scene.show("wall", wall(), scene.material(material));
        scene.light(light, place);
        return center(draw(device(), std::move(scene), settings));
    }
    vec3 wall_under(const Material& material, const Environment& environment, const RenderSettings& settings = {})
    {
        SceneBuilder scene("wall");
        scene.show("wall", wall(), scene.material(material));
        scene.environment(environment);
        return center(draw(device(), std::move(scene), settings));
    }
};

Material lambert(dvec3 reflectance)
{
    Material material;
    material.model = BsdfModel::lambert;
    material.base_color = dvec4(reflectance, 1);
    return material;
}

Material metallic_roughness(dvec3 color, double metallic, double roughness)
{
    Material material;
    material.base_color = dvec4(color, 1);
    material.metallic = metallic;
    material.roughness = roughness;
    return material;
}

/// The device reads E from a table that is exact to 1e-3 (SH-53).
constexpr double kTable = 2e-3;

/// M of (SH-53) for a viewer along the normal.
dvec3 energy(const dvec3& f0, double alpha)
{
    const double e = ggx_albedo(1, alpha);
    return 1.0 + f0 * (1 - e) / e;
}

/// (SH-11) … (SH-14) as printed there, for a light θ from the normal and the viewer along it.
dvec3 metallic_roughness_brdf(dvec3 color, double metallic, double roughness, double theta)
{
    const double alpha = std::max(roughness * roughness, 1e-3), a2 = alpha * alpha;
    const double n_h = std::cos(theta / 2), o_h = n_h, n_l = std::cos(theta), n_v = 1;
    const double d = a2 / (kPi * std::pow(n_h * n_h * (a2 - 1) + 1, 2));
    const double v = 0.5 / (n_l * std::sqrt(n_v * n_v * (1 - a2) + a2) + n_v * std::sqrt(n_l * n_l * (1 - a2) + a2));
    const dvec3 f0 = glm::mix(dvec3(0.04), color, metallic);
    const dvec3 f = f0 + (1.0 - f0) * std::pow(1 - o_h, 5);
    return (1.0 - f) * color * (1 - metallic) / kPi + f * d * v * energy(f0, alpha);
}

TEST_F(RasterShading, lambert_under_a_directional_light_is_E_over_pi_rho_cos)
{
    const dvec3 rho(0.5, 0.25, 0.75);
    for (const double theta : {0.0, 0.5, 1.0, 1.5}) {
        const vec3 found = lit_wall(lambert(rho), directional({1, 0.5, 2}, 3), rotation_x(-theta));
        expect_radiance(found, 3.0 * dvec3(1, 0.5, 2) * rho / kPi * std::cos(theta));
    }
}

TEST_F(RasterShading, a_light_from_behind_gives_nothing)
{
    EXPECT_EQ(lit_wall(lambert(dvec3(1)), directional(dvec3(1), 3), rotation_x(-1.6)), vec3(0));
}

TEST_F(RasterShading, ggx_at_normal_incidence)
{
    const dvec3 color(0.9, 0.6, 0.3);
    for (const double roughness : {0.0, 0.1, 0.3, 1.0}) {
        const double alpha = std::max(roughness * roughness, 1e-3);
        const dvec3 f0 = glm::mix(dvec3(0.04), color, 0.25);
        const dvec3 expected = (1.0 - f0) * color * 0.75 / kPi + f0 / (4 * kPi * alpha * alpha) * energy(f0, alpha);
        expect_radiance(lit_wall(metallic_roughness(color, 0.25, roughness), directional(dvec3(1), 1), dmat4(1)),
                        expected, kTable);
    }
}

TEST_F(RasterShading, ggx_off_the_mirror_direction)
{
    const dvec3 color(0.9, 0.6, 0.3);
    for (const double theta : {0.2, 0.8, 1.4})
        for (const double roughness : {0.3, 0.7, 1.0}) {
            const vec3 found =
                lit_wall(metallic_roughness(color, 0.5, roughness), directional(dvec3(1), 2), rotation_x(-theta));
            expect_radiance(found, metallic_roughness_brdf(color, 0.5, roughness, theta) * 2.0 * std::cos(theta),
                            kTable);
        }
}

TEST_F(RasterShading, a_point_light_falls_off_by_the_square_and_ends_at_its_range)
{
    Light light;
    light.intensity = 8;
    expect_radiance(lit_wall(lambert(dvec3(1)), light, translation({0, 0, 2})), dvec3(8 / kPi / 4));
    light.range = 4;
    expect_radiance(lit_wall(lambert(dvec3(1)), light, translation({0, 0, 2})), dvec3(8 / kPi / 4 * (1 - 1.0 / 16)));
    light.range = 1.9;
    EXPECT_EQ(lit_wall(lambert(dvec3(1)), light, translation({0, 0, 2})), vec3(0));
}

TEST_F(RasterShading, a_spot_light_dims_between_its_cones)
{
    Light light;
    light.type = LightType::spot;
    light.intensity = 4;
    light.inner_cone = 0.2;
    light.outer_cone = 0.6;
    for (const double turn : {0.0, 0.1, 0.3, 0.5, 0.7}) {
        // The light stays above the origin and turns away from it.
        const vec3 found = lit_wall(lambert(dvec3(1)), light, translation({0, 0, 2}) * rotation_x(turn));
        const double cone = std::clamp((std::cos(turn) - std::cos(0.6)) / (std::cos(0.2) - std::cos(0.6)), 0.0, 1.0);
        expect_radiance(found, dvec3(4 / kPi / 4 * cone * cone));
    }
}

TEST_F(RasterShading, unlit_shows_its_base_colour_and_emission_is_added_to_the_others)
{
    EXPECT_EQ(lit_wall(unlit({0.5, 0.25, 4, 1}), directional(dvec3(1), 9), dmat4(1)), vec3(0.5f, 0.25f, 4.f));
    Material lamp = lambert(dvec3(0.5));
    lamp.emission = dvec3(3, 2, 1);
    expect_radiance(lit_wall(lamp, directional(dvec3(1), 2), dmat4(1)), dvec3(3, 2, 1) + 1 / kPi);
}

TEST_F(RasterShading, a_constant_environment_lights_each_model_as_stated)
{
    const dvec3 radiance(2, 1, 0.5);
    const Environment environment = constant_environment(radiance);
    expect_radiance(wall_under(lambert(dvec3(0.3)), environment), 0.3 * radiance);
    for (const double roughness : {0.0, 0.37, 1.0}) {
        const dvec3 color(0.9, 0.6, 0.3), f0 = glm::mix(dvec3(0.04), color, 0.5);
        // (SH-34) at n·v = 1.
        const double alpha = std::max(roughness * roughness, 1e-3);
        const double e = ggx_albedo(1, alpha), w = schlick_share(1, alpha);
        const dvec3 specular = e * (f0 + (1.0 - f0) * w) * (1.0 + f0 * (1 - e) / e);
        const dvec3 expected = ((1.0 - f0) * 0.5 * color + specular) * radiance;
        // Both tables are exact to 10⁻³ between their nodes.
        expect_radiance(wall_under(metallic_roughness(color, 0.5, roughness), environment), expected, 5e-4);
    }
    Material mirror;
    mirror.model = BsdfModel::mirror;
    mirror.base_color = dvec4(0.8, 0.6, 0.4, 1);
    expect_radiance(wall_under(mirror, environment), dvec3(0.8, 0.6, 0.4) * radiance);
}

TEST_F(RasterShading, exact_conductors_and_dielectrics_become_their_reflectance_at_normal_incidence)
{
    Material gold;
    gold.model = BsdfModel::rough_conductor;
    gold.eta = dvec3(0.143, 0.375, 1.442);
    gold.k = dvec3(3.983, 2.386, 1.603);
    gold.ggx_alpha = 0.25;
    const dvec3 f0 = ((gold.eta - 1.0) * (gold.eta - 1.0) + gold.k * gold.k) /
                     ((gold.eta + 1.0) * (gold.eta + 1.0) + gold.k * gold.k);
    expect_radiance(lit_wall(gold, directional(dvec3(1), 1), dmat4(1)), f0 / (4 * kPi * 0.0625));
    Material glass;
    glass.model = BsdfModel::rough_dielectric;
    glass.eta = dvec3(1.5);
    glass.ggx_alpha = 0.25;
    expect_radiance(lit_wall(glass, directional(dvec3(1), 1), dmat4(1)), dvec3(0.04 / (4 * kPi * 0.0625)));
}

TEST_F(RasterShading, occlusion_dims_the_environment_alone)
{
    Material material = lambert(dvec3(0.5));
    SceneBuilder scene("wall");
    material.occlusion_texture = scene.texture("half", 1, 1, {}, [](int, int) {
        return std::array<std::uint8_t, 4>{51, 0, 0, 255};
    });
    material.occlusion_strength = 0.5;
    scene.show("wall", wall(), scene.material(material));
    scene.environment(constant_environment(dvec3(1)));
    scene.light(directional(dvec3(1), 1), dmat4(1));
    expect_radiance(center(draw(device(), std::move(scene))), dvec3(0.5 * (1 + 0.5 * (0.2 - 1)) + 0.5 / kPi));
}

TEST_F(RasterShading, blinn_phong_is_its_normalized_lobe_and_ambient_light)
{
    RenderSettings settings;
    settings.shading = Shading::blinn_phong;
    const dvec3 color(0.9, 0.6, 0.3);
    const dvec3 f0 = glm::mix(dvec3(0.04), color, 0.5);
    // 0.2 gives p = 1248, 1 gives p = 0.
    for (const double roughness : {0.2, 0.5, 1.0})
        for (const double theta : {0.0, 0.1, 0.7}) {
            const double alpha = roughness * roughness, p = 2 / (alpha * alpha) - 2;
            const double lobe =
                (p + 2) * (p + 4) / (8 * kPi * (std::exp2(-p / 2) + p)) * std::pow(std::cos(theta / 2), p);
            const vec3 found = lit_wall(metallic_roughness(color, 0.5, roughness), directional(dvec3(1), 2),
                                        rotation_x(-theta), settings);
            expect_radiance(found, (0.5 * color / kPi + f0 * lobe) * 2.0 * std::cos(theta), 1e-4);
        }
    const vec3 ambient = wall_under(metallic_roughness(color, 0.5, 0.5), constant_environment(dvec3(2)), settings);
    expect_radiance(ambient, (0.5 * color + f0) * 2.0);
}

TEST_F(RasterShading, a_normal_map_turns_the_normal)
{
    Primitive primitive = wall();
    primitive.tangents.assign(4, vec4(1, 0, 0, 1));
    const dvec3 codes(191, 64, 230);
    const dvec3 texel = 2.0 * codes / 255.0 - 1.0;
    for (const double scale : {1.0, 0.5, 0.0}) {
        SceneBuilder scene("wall");
        Material material = lambert(dvec3(1));
        material.normal_texture = scene.texture("tilt", 1, 1, {}, [](int, int) {
            return std::array<std::uint8_t, 4>{191, 64, 230, 255};
        });
        material.normal_scale = scale;
        scene.show("wall", primitive, scene.material(material));
        scene.light(directional(dvec3(1), kPi), rotation_x(-0.3));
        const dvec3 n = normalize(texel * dvec3(scale, scale, 1));
        expect_radiance(center(draw(device(), std::move(scene))), dvec3(dot(n, dvec3(0, std::sin(0.3), std::cos(0.3)))),
                        3e-5);
    }
}

TEST_F(RasterShading, TX_7_normals_finer_than_a_pixel_make_a_surface_rougher)
{
    // Two normals tilted to either side: their mean is the surface's own, cos(tilt) long.
    Primitive primitive = wall();
    primitive.tangents.assign(4, vec4(1, 0, 0, 1));
    for (vec2& uv : primitive.uv[0]) uv *= 64.f;
    const double roughness = 0.3;
    for (const double tilt : {0.0, 0.25, 0.5}) {
        SceneBuilder scene("wall");
        Material material = metallic_roughness(dvec3(1), 1, roughness);
        const auto code = [](double x) { return std::uint8_t(std::lround(255 * (0.5 + 0.5 * x))); };
        material.normal_texture = scene.texture("ridges", 2, 2, {}, [&](int x, int) {
            return std::array<std::uint8_t, 4>{code((x == 0 ? 1 : -1) * std::sin(tilt)), 128, code(std::cos(tilt)),
                                               255};
        });
        scene.show("wall", primitive, scene.material(material));
        scene.light(directional(dvec3(1), 1), dmat4(1));
        const double spread = 2 * std::max(0.0, 1 / std::cos(tilt) - 1.0001);
        const double alpha = std::sqrt(std::pow(roughness, 4) + spread);
        // D V at normal incidence is 1/(4 pi alpha^2), and F = 1 leaves M = 1/E.
        const double expected = 1 / (4 * kPi * alpha * alpha * ggx_albedo(1, alpha));
        EXPECT_NEAR(center(draw(device(), std::move(scene))).x, expected, 0.04 * expected) << tilt;
    }
}

TEST_F(RasterShading, a_mirrored_node_shows_the_mirrored_normal_map)
{
    // R4: seen from +Z with x mirrored, a light mirrored likewise gives the same.
    const auto picture = [&](double mirror) {
        Primitive primitive = wall();
        primitive.tangents.assign(4, vec4(0.6f, 0.8f, 0, 1));
        SceneBuilder scene("wall");
        Material material = lambert(dvec3(1));
        material.normal_texture = scene.texture("tilt", 1, 1, {}, [](int, int) {
            return std::array<std::uint8_t, 4>{191, 64, 230, 255};
        });
        dmat4 flip(1);
        flip[0][0] = mirror;
        scene.show("wall", primitive, scene.material(material), flip);
        scene.light(directional(dvec3(1), kPi), flip * rotation_y(0.4) * rotation_x(-0.3));
        return center(draw(device(), std::move(scene)));
    };
    expect_radiance(picture(-1), dvec3(picture(1)));
}

TEST_F(RasterShading, vertex_colours_multiply_the_base_colour)
{
    Primitive primitive = wall();
    primitive.colors.assign(4, vec4(0.5f, 0.25f, 1, 1));
    SceneBuilder scene("wall");
    scene.show("wall", primitive, scene.material(unlit({0.5, 1, 2, 1})));
    EXPECT_EQ(center(draw(device(), std::move(scene))), vec3(0.25f, 0.25f, 2.f));
}

TEST_F(RasterShading, an_emissive_wall_lights_others_by_its_projected_area)
{
    SceneBuilder scene("lamp");
    Material lamp = lambert(dvec3(0));
    lamp.emission = dvec3(10, 20, 30);
    scene.show("wall", wall(), scene.material(lambert(dvec3(0.5))));
    // 0.2 m² at a height of 2 m, above the origin but beyond the picture's edge as seen from the viewer's side.
    scene.show("lamp", make_rectangle({0, 3, 2}, {0.5, 0, 0}, {0, 0, -0.1}), scene.material(lamp));
    const dvec3 to_lamp(0, 3, 2);
    const double d2 = dot(to_lamp, to_lamp), d = std::sqrt(d2);
    // The lamp looks down -Y or +Y: only a lamp that faces the wall gives light.
    const double facing = 0.2 * 3 / d;
    const dvec3 expected = 0.5 / kPi * (2 / d) * dvec3(10, 20, 30) * facing / d2;
    const dvec3 normal = cross(dvec3(0.5, 0, 0), dvec3(0, 0, -0.1));
    expect_radiance(center(draw(device(), std::move(scene))), normal.y < 0 ? expected : dvec3(0));
}

TEST_F(RasterShading, an_emissive_sphere_lights_others_by_a_quarter_of_its_area)
{
    SceneBuilder scene("lamp");
    Material lamp = lambert(dvec3(0));
    lamp.emission = dvec3(10, 20, 30);
    scene.show("wall", wall(), scene.material(lambert(dvec3(0.5))));
    scene.sphere("lamp", {0, 3, 2}, 0.25, scene.material(lamp));
    const double d2 = 13;
    const dvec3 expected = 0.5 / kPi * (2 / std::sqrt(d2)) * dvec3(10, 20, 30) * (kPi * 0.0625) / d2;
    expect_radiance(center(draw(device(), std::move(scene))), expected);
}

TEST_F(RasterShading, backs_of_double_sided_materials_are_lit_from_their_own_side)
{
    Material material = lambert(dvec3(0.5));
    material.double_sided = true;
    SceneBuilder scene("wall");
    scene.show("wall", wall(), scene.material(material), rotation_y(kPi));
    scene.light(directional(dvec3(1), 2), dmat4(1));
    expect_radiance(center(draw(device(), std::move(scene))), dvec3(1 / kPi));
}

TEST_F(RasterShading, a_sphere_is_shaded_by_its_exact_normal)
{
    SceneBuilder scene("sphere");
    scene.sphere("ball", {0.3, 0.2, -1}, 0.8, scene.material(lambert(dvec3(0.5))));
    scene.light(directional(dvec3(1), 2), rotation_x(-0.7));
    const dvec3 n = dvec3(-0.3, -0.2, std::sqrt(0.64 - 0.13)) / 0.8;
    const double cosine = dot(n, dvec3(0, std::sin(0.7), std::cos(0.7)));
    expect_radiance(center(draw(device(), std::move(scene))), dvec3(1 / kPi * cosine));
}

}  // namespace
}  // namespace etalon::test
