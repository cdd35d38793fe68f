#include <cmath>

#include "engine/render/albedo.h"
#include "tests/gpu/raster_stage.h"

// Radiances of a layered wall that faces an orthographic viewer, by hand from docs/shading.md §2b: n = wo = +Z.
namespace etalon::test {
namespace {

class RasterLayers : public DeviceTest {
 protected:
    /// The wall alone, lit along its normal from the front (or, with a turn of π, from behind).
    vec3 lit(const Material& material, double turn = 0)
    {
        SceneBuilder scene("wall");
        scene.show("wall", wall(), scene.material(material));
        scene.light(directional(dvec3(1), kPi), rotation_y(turn));
        return center(draw(device(), std::move(scene)));
    }
    vec3 under(const Material& material, dvec3 radiance)
    {
        SceneBuilder scene("wall");
        scene.show("wall", wall(), scene.material(material));
        scene.environment(constant_environment(radiance));
        return center(draw(device(), std::move(scene)));
    }
    /// In front of an unlit wall a metre behind it.
    vec3 before(const Material& material, dvec3 radiance, const dmat4& place = dmat4(1))
    {
        SceneBuilder scene("wall");
        scene.show("behind", wall(-1), scene.material(unlit(dvec4(radiance, 1))));
        scene.show("wall", wall(), scene.material(material), place);
        return center(draw(device(), std::move(scene)));
    }
};

constexpr double kTable = 2e-3;  // E of (SH-53) comes from a table

Material layered(dvec3 color, double metallic, double roughness)
{
    Material material;
    material.base_color = dvec4(color, 1);
    material.metallic = metallic;
    material.roughness = roughness;
    material.layers.emplace();
    return material;
}

/// D V M at normal incidence.
dvec3 highlight(const dvec3& f0, double roughness)
{
    const double alpha = roughness * roughness, e = ggx_albedo(1, alpha);
    return 1 / (4 * kPi * alpha * alpha) * (1.0 + f0 * (1 - e) / e);
}

const dvec3 kColor(0.8, 0.5, 0.2);

TEST_F(RasterLayers, a_white_metal_of_any_roughness_gives_back_a_uniform_surrounding)
{
    for (const double roughness : {0.0, 0.4, 1.0})
        expect_radiance(under(layered(dvec3(1), 1, roughness), dvec3(2, 1, 0.5)), dvec3(2, 1, 0.5), 1e-5);
}

TEST_F(RasterLayers, index_of_refraction_and_specular_make_the_dielectric_reflectance)
{
    Material material = layered(kColor, 0, 0.6);
    material.layers->ior = 2;
    material.layers->specular = 0.7;
    material.layers->specular_color = dvec3(1, 0.5, 20);
    const dvec3 f0 = glm::min(dvec3(1, 0.5, 20) / 9.0, 1.0) * 0.7;
    const dvec3 expected = (1 - 0.7) * kColor + kPi * f0 * highlight(f0, 0.6);
    expect_radiance(lit(material), expected, kTable);
    material.layers->ior = 0;  // infinite: a mirror
    material.layers->specular = 1;
    material.layers->specular_color = dvec3(1);
    expect_radiance(under(material, dvec3(3)), dvec3(3), 1e-5);
}

TEST_F(RasterLayers, specular_glossiness_splits_what_is_not_reflected)
{
    Material material;
    material.model = BsdfModel::specular_glossiness;
    material.base_color = dvec4(kColor, 1);
    material.k = dvec3(0.5, 0.2, 0.1);
    material.roughness = 0.5;
    const dvec3 expected = (1 - 0.5) * (1 - 0.5) * kColor + kPi * material.k * highlight(material.k, 0.5);
    expect_radiance(lit(material), expected, kTable);
}

TEST_F(RasterLayers, a_coat_takes_from_what_lies_below_and_from_its_emission)
{
    Material material = layered(kColor, 0, 1);
    const dvec3 below(lit(material));
    material.layers->clearcoat = 0.5;
    material.layers->clearcoat_roughness = 0.5;
    material.emission = dvec3(3);
    const double k = 0.5 * 0.04, alpha = 0.25;
    expect_radiance(lit(material), (1 - k) * (below + 3.0) + k / (4 * alpha * alpha), 1e-5);
}

TEST_F(RasterLayers, sheen_takes_its_albedo_from_the_base)
{
    Material material = layered(kColor, 0, 1);
    const dvec3 below(lit(material));
    material.layers->sheen_color = dvec3(0.9, 0.6, 0.3);
    material.layers->sheen_roughness = 0.5;
    // D of h = n is 0: only the loss is seen.
    expect_radiance(lit(material), (1 - 0.9 * sheen_albedo(1, 0.5)) * below, kTable);
}

TEST_F(RasterLayers, diffuse_transmission_shows_light_from_behind)
{
    Material material = layered(kColor, 0, 1);
    material.layers->diffuse_transmission = 0.75;
    material.layers->diffuse_transmission_color = dvec3(0.2, 0.4, 0.6);
    expect_radiance(lit(material, kPi), 0.96 * 0.75 * dvec3(0.2, 0.4, 0.6), 1e-5);
    const dvec3 front = 0.96 * 0.25 * kColor + kPi * 0.04 * highlight(dvec3(0.04), 1);
    expect_radiance(lit(material), front, kTable);
}

TEST_F(RasterLayers, a_thin_wall_shows_lights_and_things_behind_it_tinted)
{
    Material material = layered(kColor, 0, 0.5);
    material.layers->transmission = 0.8;
    expect_radiance(lit(material, kPi), 0.96 * 0.8 * kColor / (4 * 0.0625), 1e-5);
    for (const double roughness : {0.0, 0.5, 1.0}) {
        material.roughness = roughness;
        expect_radiance(before(material, {4, 2, 1}), 0.96 * 0.8 * kColor * dvec3(4, 2, 1), 1e-5);
    }
}

TEST_F(RasterLayers, a_body_absorbs_over_its_thickness_in_the_world)
{
    Material material = layered(dvec3(1), 0, 0);
    material.layers->transmission = 1;
    material.layers->thickness = 0.3;
    material.layers->attenuation_distance = 0.5;
    material.layers->attenuation_color = dvec3(0.9, 0.5, 0.1);
    dmat4 twice(2.0);
    twice[3][3] = 1;
    const dvec3 left = glm::pow(dvec3(0.9, 0.5, 0.1), dvec3(0.6 / 0.5));
    expect_radiance(before(material, dvec3(5), twice), 0.96 * 5.0 * left, 2e-5);
}

TEST_F(RasterLayers, what_is_behind_glass_is_the_environment_where_nothing_else_is)
{
    Material material = layered(dvec3(1), 0, 0.2);
    material.layers->transmission = 1;
    // Whatever the picture's own background: reflected and transmitted light alike (SH-65).
    const double e = ggx_albedo(1, 0.04), w = schlick_share(1, 0.04);
    const double reflected = e * (0.04 + 0.96 * w) * (1 + 0.04 * (1 - e) / e);
    for (const Background background : {Background::environment, Background::transparent, Background::colour}) {
        SceneBuilder scene("wall");
        scene.show("wall", wall(), scene.material(material));
        scene.environment(constant_environment(dvec3(2, 1, 0.5)));
        RenderSettings settings;
        settings.background = background;
        settings.background_color = dvec3(7);
        expect_radiance(center(draw(device(), std::move(scene), settings)), (0.96 + reflected) * dvec3(2, 1, 0.5),
                        1e-4);
    }
}

}  // namespace
}  // namespace etalon::test
