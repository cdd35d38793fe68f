#include "engine/scene/builder.h"
#include "engine/scene/builtin_scenes.h"
#include "engine/scene/pose.h"
#include "engine/scene/topology.h"

// One layer of docs/shading.md §2b each: small things before a checkered wall.
namespace etalon::builtin {

namespace {

using Rgba8 = std::array<std::uint8_t, 4>;

constexpr int kTexels = 32;

std::uint8_t byte(double value)
{
    return static_cast<std::uint8_t>(std::lround(255 * std::min(std::max(value, 0.0), 1.0)));
}

void add_wall(SceneBuilder& build)
{
    Material wall;
    wall.name = "wall";
    wall.model = BsdfModel::lambert;
    wall.base_color_texture = build.texture("checker", kTexels, kTexels, Sampler{}, [](int x, int y) {
        return (x / 4 + y / 4) % 2 == 0 ? Rgba8{225, 220, 205, 255} : Rgba8{70, 80, 110, 255};
    });
    build.show("wall", make_rectangle(dvec3(0, 0, -1.5), dvec3(4, 0, 0), dvec3(0, 2, 0)),
               build.material(std::move(wall)));
}

void add_sun(SceneBuilder& build, dvec3 from = dvec3(2, 3, 4))
{
    Light sun;
    sun.name = "sun";
    sun.type = LightType::directional;
    sun.intensity = 2;
    build.light(sun, look_from(from, dvec3(0)));
}

// For smooth glass: a light with an area, since no path tracer meets a point behind it.
void add_lamp(SceneBuilder& build)
{
    Material lamp;
    lamp.name = "lamp";
    lamp.model = BsdfModel::lambert;
    lamp.base_color = dvec4(0, 0, 0, 1);
    lamp.emission = dvec3(5);
    lamp.emits_front_only = true;
    build.show("lamp", make_rectangle(dvec3(0, 3, 1), dvec3(2, 0, 0), dvec3(0, 0, 1.5)),
               build.material(std::move(lamp)));
}

void add_sky(SceneBuilder& build, double radiance)
{
    Environment sky;
    sky.radiance = dvec3(0.8, 0.9, 1) * radiance;
    build.environment(std::move(sky));
}

void add_camera(SceneBuilder& build)
{
    build.camera("front", 28, dvec3(0, 0.2, 6), dvec3(0));
    build.size(320, 160);
}

Scene finished(SceneBuilder build)
{
    add_camera(build);
    return std::move(build).finish();
}

Material surface(std::string name, dvec3 color, double metallic, double roughness)
{
    Material out;
    out.name = std::move(name);
    out.base_color = dvec4(color, 1);
    out.metallic = metallic;
    out.roughness = roughness;
    out.layers.emplace();
    return out;
}

// Number `place` of `count` balls in a row.
void show_ball(SceneBuilder& build, int place, int count, Material material)
{
    const double radius = count > 3 ? 0.62 : 0.8;
    Primitive ball = make_sphere(dvec3((2 * radius + 0.1) * (place - 0.5 * (count - 1)), 0, 0), radius, 48, 24);
    const std::optional<MaterialLayers>& layers = material.layers;
    if (layers && (layers->anisotropy > 0 || layers->clearcoat_normal_texture.present())) add_tangents(ball, 0);
    std::string name = material.name;
    build.show(std::move(name), std::move(ball), build.material(std::move(material)));
}

void show_pane(SceneBuilder& build, int place, int count, Material material)
{
    const double x = 1.6 * (place - 0.5 * (count - 1));
    std::string name = material.name;
    material.double_sided = true;
    build.show(std::move(name), make_rectangle(dvec3(x, 0, 0), dvec3(0.7, 0, -0.2), dvec3(0, 0.9, 0)),
               build.material(std::move(material)));
}

// All four channels from 0 to 1 in `steps` across the texture.
TextureUse ramp(SceneBuilder& build, int steps)
{
    return build.texture("ramp", kTexels, kTexels, Sampler{.wrap_u = Wrap::mirrored_repeat}, [=](int x, int) {
        const std::uint8_t value = byte(double(x * steps / kTexels) / (steps - 1));
        return Rgba8{value, value, value, value};
    });
}

TextureUse stripes(SceneBuilder& build, Rgba8 even, Rgba8 odd)
{
    return build.texture("stripes", kTexels, kTexels, Sampler{},
                         [=](int x, int) { return x / 4 % 2 == 0 ? even : odd; });
}

}  // namespace

Scene specular()
{
    SceneBuilder build("builtin:specular");
    add_wall(build);
    Material dense = surface("ior 2.4", dvec3(0.1, 0.02, 0.02), 0, 0.3);
    dense.layers->ior = 2.4;
    Material matt = surface("specular 0.2", dvec3(0.1, 0.02, 0.02), 0, 0.3);
    matt.layers->specular = 0.2;
    Material tinted = surface("specular colour", dvec3(0.02, 0.02, 0.1), 0, 0.3);
    tinted.layers->ior = 1.8;
    tinted.layers->specular_color = dvec3(1, 0.5, 0.1);
    Material mapped = surface("specular maps", dvec3(0.1), 0, 0.3);
    mapped.layers->specular_color = dvec3(4);
    mapped.layers->specular_texture = stripes(build, Rgba8{0, 0, 0, 255}, Rgba8{0, 0, 0, 60});
    mapped.layers->specular_color_texture = build.texture("hues", kTexels, kTexels, Sampler{}, [](int, int y) {
        return y < kTexels / 2 ? Rgba8{255, 80, 40, 255} : Rgba8{60, 120, 255, 255};
    });
    show_ball(build, 0, 4, std::move(dense));
    show_ball(build, 1, 4, std::move(matt));
    show_ball(build, 2, 4, std::move(tinted));
    show_ball(build, 3, 4, std::move(mapped));
    add_sun(build);
    add_sky(build, 0.5);
    return finished(std::move(build));
}

Scene clearcoat()
{
    SceneBuilder build("builtin:clearcoat");
    add_wall(build);
    Material paint = surface("coated", dvec3(0.6, 0.05, 0.05), 0, 0.8);
    paint.layers->clearcoat = 1;
    paint.layers->clearcoat_roughness = 0.2;
    Material partly = surface("coat maps", dvec3(0.05, 0.3, 0.1), 0.5, 0.7);
    partly.layers->clearcoat = 1;
    partly.layers->clearcoat_roughness = 0.6;
    partly.layers->clearcoat_texture = stripes(build, Rgba8{255, 0, 0, 255}, Rgba8{0, 0, 0, 255});
    partly.layers->clearcoat_roughness_texture =
        build.texture("coat roughness", kTexels, kTexels, Sampler{}, [](int, int y) {
            return Rgba8{0, byte(0.4 + 0.02 * y), 0, 255};
        });
    Material rippled = surface("rippled coat", dvec3(0.05, 0.1, 0.5), 0, 0.9);
    rippled.layers->clearcoat = 1;
    rippled.layers->clearcoat_roughness = 0.25;
    rippled.layers->clearcoat_normal_scale = 0.8;
    rippled.layers->clearcoat_normal_texture = build.texture("ripples", kTexels, kTexels, Sampler{}, [](int x, int) {
        const dvec3 n = normalize(dvec3(0.4 * std::sin(2 * kPi * 4 * (x + 0.5) / kTexels), 0, 1));
        return Rgba8{byte(0.5 + 0.5 * n.x), byte(0.5 + 0.5 * n.y), byte(0.5 + 0.5 * n.z), 255};
    });
    show_ball(build, 0, 3, std::move(paint));
    show_ball(build, 1, 3, std::move(partly));
    show_ball(build, 2, 3, std::move(rippled));
    add_sun(build);
    add_sky(build, 0.5);
    return finished(std::move(build));
}

Scene sheen()
{
    SceneBuilder build("builtin:sheen");
    add_wall(build);
    Material satin = surface("sheen 0.3", dvec3(0.08, 0.02, 0.1), 0, 0.9);
    satin.layers->sheen_color = dvec3(1, 0.8, 0.9);
    satin.layers->sheen_roughness = 0.3;
    Material velvet = surface("sheen 0.8", dvec3(0.02, 0.05, 0.12), 0, 0.9);
    velvet.layers->sheen_color = dvec3(0.6, 0.8, 1);
    velvet.layers->sheen_roughness = 0.8;
    Material mapped = surface("sheen maps", dvec3(0.1, 0.06, 0.02), 0, 0.9);
    mapped.layers->sheen_color = dvec3(1);
    mapped.layers->sheen_roughness = 1;
    mapped.layers->sheen_color_texture = stripes(build, Rgba8{255, 200, 120, 255}, Rgba8{40, 30, 20, 255});
    mapped.layers->sheen_roughness_texture = ramp(build, 4);
    show_ball(build, 0, 3, std::move(satin));
    show_ball(build, 1, 3, std::move(velvet));
    show_ball(build, 2, 3, std::move(mapped));
    add_sun(build, dvec3(3, 4, -1));
    add_sky(build, 0.5);
    return finished(std::move(build));
}

Scene transmission()
{
    SceneBuilder build("builtin:transmission");
    add_wall(build);
    Material tinted = surface("tinted", dvec3(0.4, 0.7, 0.95), 0, 0.35);
    tinted.layers->transmission = 1;
    Material frosted = surface("frosted", dvec3(0.95), 0, 0.5);
    frosted.layers->transmission = 0.9;
    Material mapped = surface("transmission map", dvec3(0.9, 0.6, 0.3), 0, 0.4);
    mapped.layers->transmission = 1;
    mapped.layers->transmission_texture = stripes(build, Rgba8{255, 0, 0, 255}, Rgba8{30, 0, 0, 255});
    show_pane(build, 0, 3, std::move(tinted));
    show_pane(build, 1, 3, std::move(frosted));
    show_pane(build, 2, 3, std::move(mapped));
    add_sun(build);
    add_sky(build, 0.5);
    return finished(std::move(build));
}

Scene volume()
{
    SceneBuilder build("builtin:volume");
    add_wall(build);
    const auto body = [](std::string name, double ior, double roughness) {
        Material out = surface(std::move(name), dvec3(1), 0, roughness);
        out.layers->transmission = 1;
        out.layers->thickness = 1;
        out.layers->ior = ior;
        return out;
    };
    Material amber = body("amber", 1.55, 0.1);
    amber.layers->attenuation_color = dvec3(0.9, 0.5, 0.1);
    amber.layers->attenuation_distance = 0.8;
    Material water = body("water", 1.33, 0);
    water.layers->attenuation_color = dvec3(0.5, 0.85, 0.9);
    water.layers->attenuation_distance = 1.5;
    water.layers->thickness_texture = ramp(build, 8);
    Material straight = body("ior 1", 1, 0.3);
    straight.layers->attenuation_color = dvec3(0.3, 0.8, 0.3);
    straight.layers->attenuation_distance = 0.7;
    show_ball(build, 0, 3, std::move(amber));
    build.show("water", make_box(dvec3(0), dvec3(0.6), 0.5), build.material(std::move(water)));
    build.sphere("ior 1", dvec3(1.7, 0, 0), 0.8, build.material(std::move(straight)));
    add_lamp(build);
    add_sky(build, 0.5);
    build.max_depth(8);
    return finished(std::move(build));
}

Scene iridescence()
{
    SceneBuilder build("builtin:iridescence");
    add_wall(build);
    Material bubble = surface("film on plastic", dvec3(0.02), 0, 0.35);
    bubble.layers->iridescence = 1;
    bubble.layers->iridescence_ior = 1.8;
    bubble.layers->iridescence_thickness_max = 450;
    Material temper = surface("film on metal", dvec3(0.5, 0.45, 0.4), 1, 0.35);
    temper.layers->iridescence = 0.8;
    temper.layers->iridescence_ior = 1.4;
    temper.layers->iridescence_thickness_max = 300;
    Material mapped = surface("film maps", dvec3(0.4), 1, 0.35);
    mapped.layers->iridescence = 1;
    mapped.layers->iridescence_thickness_min = 200;
    mapped.layers->iridescence_thickness_max = 700;
    mapped.layers->iridescence_texture = build.texture("film", kTexels, kTexels, Sampler{}, [](int, int y) {
        return Rgba8{std::uint8_t(y / 8 % 2 == 0 ? 255 : 80), 0, 0, 255};
    });
    mapped.layers->iridescence_thickness_texture = ramp(build, 8);
    show_ball(build, 0, 3, std::move(bubble));
    show_ball(build, 1, 3, std::move(temper));
    show_ball(build, 2, 3, std::move(mapped));
    add_sun(build);
    add_sky(build, 0.8);
    return finished(std::move(build));
}

Scene anisotropy()
{
    SceneBuilder build("builtin:anisotropy");
    add_wall(build);
    Material along = surface("brushed along u", dvec3(0.9, 0.7, 0.4), 1, 0.3);
    along.layers->anisotropy = 0.8;
    Material turned = surface("brushed at 60 degrees", dvec3(0.6, 0.7, 0.9), 1, 0.3);
    turned.layers->anisotropy = 0.8;
    turned.layers->anisotropy_rotation = kPi / 3;
    Material mapped = surface("brushed in circles", dvec3(0.8), 1, 0.3);
    mapped.layers->anisotropy = 0.9;
    mapped.layers->anisotropy_texture = build.texture(
        "circles", kTexels, kTexels, Sampler{.wrap_u = Wrap::clamp_to_edge, .wrap_v = Wrap::clamp_to_edge},
        [](int x, int y) {
            const dvec2 r(x + 0.5 - 0.5 * kTexels, y + 0.5 - 0.5 * kTexels);  // v falls along the bitangent
            const dvec2 d = normalize(dvec2(r.y, r.x));
            return Rgba8{byte(0.5 + 0.5 * d.x), byte(0.5 + 0.5 * d.y), byte(length(r) / 16), 255};
        });
    show_ball(build, 0, 3, std::move(along));
    show_ball(build, 1, 3, std::move(turned));
    Primitive disc = make_rectangle(dvec3(1.7, 0, 0), dvec3(0.75, 0, -0.2), dvec3(0, 0.75, 0));
    add_tangents(disc, 0);
    build.show("disc", std::move(disc), build.material(std::move(mapped)));
    add_sun(build, dvec3(0.5, 1, 3));
    Environment studio = studio_environment();
    studio.scale = 0.5;
    build.environment(std::move(studio));
    return finished(std::move(build));
}

Scene dispersion()
{
    SceneBuilder build("builtin:dispersion");
    add_wall(build);
    Material flint = surface("flint", dvec3(1), 0, 0);
    flint.layers->transmission = 1;
    flint.layers->thickness = 1;
    flint.layers->ior = 1.7;
    flint.layers->dispersion = 8;
    Material rough = flint;
    rough.name = "rough flint";
    rough.roughness = 0.15;
    show_ball(build, 0, 3, std::move(flint));
    build.show("prism", make_box(dvec3(0.1, 0, 0), dvec3(0.5, 0.7, 0.5), 0.6), build.material(rough));
    build.sphere("rough ball", dvec3(1.7, 0, 0), 0.75, build.material(std::move(rough)));
    add_sky(build, 0.8);
    build.max_depth(8);
    return finished(std::move(build));
}

Scene diffuse_transmission()
{
    SceneBuilder build("builtin:diffuse-transmission");
    add_wall(build);
    Material leaf = surface("leaf", dvec3(0.1, 0.4, 0.05), 0, 0.6);
    leaf.layers->diffuse_transmission = 0.7;
    leaf.layers->diffuse_transmission_color = dvec3(0.5, 0.8, 0.1);
    Material paper = surface("paper", dvec3(0.8), 0, 0.8);
    paper.layers->diffuse_transmission = 1;
    Material mapped = surface("diffuse transmission maps", dvec3(0.5), 0, 0.7);
    mapped.layers->diffuse_transmission = 1;
    mapped.layers->diffuse_transmission_texture = stripes(build, Rgba8{0, 0, 0, 255}, Rgba8{0, 0, 0, 40});
    mapped.layers->diffuse_transmission_color_texture =
        build.texture("tints", kTexels, kTexels, Sampler{}, [](int, int y) {
            return y < kTexels / 2 ? Rgba8{255, 120, 60, 255} : Rgba8{90, 140, 255, 255};
        });
    show_pane(build, 0, 3, std::move(leaf));
    show_pane(build, 1, 3, std::move(paper));
    show_pane(build, 2, 3, std::move(mapped));
    add_sun(build, dvec3(1, 3, -1));  // behind the panes, over the wall
    add_sky(build, 0.4);
    return finished(std::move(build));
}

Scene specular_glossiness()
{
    SceneBuilder build("builtin:specular-glossiness");
    add_wall(build);
    const auto glossy = [](std::string name, dvec3 diffuse, dvec3 specular, double glossiness) {
        Material out;
        out.name = std::move(name);
        out.model = BsdfModel::specular_glossiness;
        out.base_color = dvec4(diffuse, 1);
        out.metallic = 0;
        out.k = specular;
        out.roughness = 1 - glossiness;
        return out;
    };
    Material mapped = glossy("maps", dvec3(0.8), dvec3(1), 0.9);
    mapped.base_color_texture = stripes(build, Rgba8{200, 60, 40, 255}, Rgba8{60, 60, 60, 255});
    mapped.metallic_roughness_texture =
        build.texture("specular and glossiness", kTexels, kTexels, Sampler{}, [](int x, int y) {
            const std::uint8_t s = x < kTexels / 2 ? 200 : 60;
            return Rgba8{s, s, std::uint8_t(s / 2), byte(0.4 + 0.018 * y)};
        });
    show_ball(build, 0, 3, glossy("plastic", dvec3(0.1, 0.3, 0.5), dvec3(0.04), 0.7));
    show_ball(build, 1, 3, glossy("gold", dvec3(0), dvec3(1, 0.766, 0.336), 0.65));
    show_ball(build, 2, 3, std::move(mapped));
    add_sun(build);
    add_sky(build, 0.6);
    return finished(std::move(build));
}

}  // namespace etalon::builtin
