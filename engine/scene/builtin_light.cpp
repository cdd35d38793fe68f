#include "engine/scene/builder.h"
#include "engine/scene/builtin_scenes.h"

namespace etalon::builtin {

namespace {

// GGX that reflects everything a single bounce can: eta 0, k 1 makes the Fresnel term 1.
Material perfect_conductor(std::string name, double ggx_alpha)
{
    Material out;
    out.name = std::move(name);
    out.model = BsdfModel::rough_conductor;
    out.eta = dvec3(0);
    out.k = dvec3(1);
    out.ggx_alpha = ggx_alpha;
    return out;
}

Environment constant(double radiance)
{
    Environment out;
    out.radiance = dvec3(radiance);
    return out;
}

dmat4 aimed(dvec3 from, dvec3 at)
{
    return look_from(from, at);
}

}  // namespace

Scene triangle()
{
    SceneBuilder build("builtin:triangle");
    Primitive p;
    p.positions = {vec3(-0.866f, -0.5f, 0), vec3(0.866f, -0.5f, 0), vec3(0, 1, 0)};
    p.normals.assign(3, vec3(0, 0, 1));
    p.colors = {vec4(1, 0, 0, 1), vec4(0, 1, 0, 1), vec4(0, 0, 1, 1)};
    p.indices = {0, 1, 2};
    Material unlit;
    unlit.name = "colours";
    unlit.model = BsdfModel::unlit;
    build.show("triangle", std::move(p), build.material(std::move(unlit)));
    build.environment(Environment{});
    build.camera("front", 40, dvec3(0, 0.25, 3), dvec3(0, 0.25, 0));
    build.size(512, 512);
    return std::move(build).finish();
}

// A room 2 m a side whose front is open; the two blocks have no bottom face to fight with the floor.
Scene cornell()
{
    SceneBuilder build("builtin:cornell");
    const Index white = build.lambert("white", dvec3(0.73, 0.73, 0.73));
    const Index red = build.lambert("red", dvec3(0.63, 0.065, 0.05));
    const Index green = build.lambert("green", dvec3(0.14, 0.45, 0.091));
    Material lamp;
    lamp.name = "lamp";
    lamp.model = BsdfModel::lambert;
    lamp.base_color = dvec4(0, 0, 0, 1);
    lamp.emission = dvec3(17, 12, 4);
    lamp.emits_front_only = true;

    Primitive shell = make_rectangle(dvec3(0, 0, 0), dvec3(1, 0, 0), dvec3(0, 0, -1));
    shell = joined(std::move(shell), make_rectangle(dvec3(0, 2, 0), dvec3(1, 0, 0), dvec3(0, 0, 1)));
    shell = joined(std::move(shell), make_rectangle(dvec3(0, 1, -1), dvec3(1, 0, 0), dvec3(0, 1, 0)));
    build.show("floor, ceiling and back", std::move(shell), white);
    build.show("left wall", make_rectangle(dvec3(-1, 1, 0), dvec3(0, 0, -1), dvec3(0, 1, 0)), red);
    build.show("right wall", make_rectangle(dvec3(1, 1, 0), dvec3(0, 0, 1), dvec3(0, 1, 0)), green);
    Primitive tall = make_box(dvec3(-0.33, 0.6, -0.29), dvec3(0.3, 0.6, 0.3), 0.29);
    Primitive low = make_box(dvec3(0.35, 0.3, 0.35), dvec3(0.3, 0.3, 0.3), -0.31);
    tall.indices.resize(tall.indices.size() - 6);
    low.indices.resize(low.indices.size() - 6);
    build.show("tall block", std::move(tall), white);
    build.show("low block", std::move(low), white);
    build.show("lamp", make_rectangle(dvec3(0, 1.99, 0), dvec3(0.25, 0, 0), dvec3(0, 0, 0.2)),
               build.material(std::move(lamp)));
    build.environment(Environment{});
    build.camera("front", 39.3, dvec3(0, 1, 3.8), dvec3(0, 1, 0));
    build.size(512, 512);
    return std::move(build).finish();
}

Scene furnace()
{
    SceneBuilder build("builtin:furnace");
    build.sphere("albedo 1", dvec3(-2.2, 1.1, 0), 1, build.lambert("albedo 1", dvec3(1)));
    build.sphere("albedo 0.5", dvec3(0, 1.1, 0), 1, build.lambert("albedo 0.5", dvec3(0.5)));
    build.sphere("mirror-like", dvec3(2.2, 1.1, 0), 1, build.material(perfect_conductor("GGX 0.1", 0.1)));
    build.sphere("satin", dvec3(-2.2, -1.1, 0), 1, build.material(perfect_conductor("GGX 0.5", 0.5)));
    build.sphere("dull", dvec3(0, -1.1, 0), 1, build.material(perfect_conductor("GGX 1", 1)));
    build.sphere("glTF white", dvec3(2.2, -1.1, 0), 1, build.metallic_roughness("glTF white", dvec3(1), 0, 0.5));
    build.environment(constant(1));
    build.camera("front", 30, dvec3(0, 0, 12), dvec3(0));
    build.size(480, 360);
    build.max_depth(16);
    return std::move(build).finish();
}

Scene furnace_lambert()
{
    SceneBuilder build("builtin:furnace-lambert");
    build.sphere("sphere", dvec3(0), 1, build.lambert("albedo 0.5", dvec3(0.5)));
    build.environment(constant(1));
    build.camera("front", 40, dvec3(0, 0, 4), dvec3(0));
    build.size(256, 256);
    build.max_depth(4);
    return std::move(build).finish();
}

Scene lights()
{
    SceneBuilder build("builtin:lights");
    const Index floor = build.lambert("floor", dvec3(0.8, 0.8, 0.8));
    const Index clay = build.lambert("clay", dvec3(0.6, 0.35, 0.25));
    build.show("floor", make_rectangle(dvec3(0), dvec3(4, 0, 0), dvec3(0, 0, -4)), floor);
    build.show("box", make_box(dvec3(-0.8, 0.5, 0), dvec3(0.5), 0.4), clay);
    build.show("sphere", make_sphere(dvec3(1, 0.6, 0), 0.6, 48, 24), clay);
    Light point;
    point.name = "point";
    point.color = dvec3(1, 0.8, 0.6);
    point.intensity = 6;
    point.range = 12;
    build.light(point, translation(dvec3(-2, 2.2, 1.5)));
    Light spot;
    spot.name = "spot";
    spot.type = LightType::spot;
    spot.color = dvec3(0.5, 0.8, 1);
    spot.intensity = 20;
    spot.inner_cone = 0.2;
    spot.outer_cone = 0.45;
    build.light(spot, aimed(dvec3(2.5, 3, 2), dvec3(0.8, 0, 0.2)));
    Light sun;
    sun.name = "sun";
    sun.type = LightType::directional;
    sun.color = dvec3(1, 1, 0.9);
    sun.intensity = 0.7;
    build.light(sun, aimed(dvec3(1, 3, 4), dvec3(0)));
    build.environment(Environment{});
    build.camera("front", 38, dvec3(0, 2.4, 6), dvec3(0, 0.5, 0));
    build.size(480, 360);
    return std::move(build).finish();
}

Scene glass()
{
    SceneBuilder build("builtin:glass");
    Material mirror;
    mirror.name = "mirror";
    mirror.model = BsdfModel::mirror;
    mirror.base_color = dvec4(0.9, 0.9, 0.9, 1);
    Material clear;
    clear.name = "glass";
    clear.model = BsdfModel::dielectric;
    clear.eta = dvec3(1.5);
    Material frosted = clear;
    frosted.name = "frosted glass";
    frosted.model = BsdfModel::rough_dielectric;
    frosted.ggx_alpha = 0.2;
    Material gold;
    gold.name = "gold";
    gold.model = BsdfModel::rough_conductor;
    gold.eta = dvec3(0.18, 0.42, 1.37);  // gold near 630, 532 and 467 nm, rounded from Johnson & Christy 1972
    gold.k = dvec3(3.42, 2.35, 1.77);
    gold.ggx_alpha = 0.15;
    build.show("floor", make_rectangle(dvec3(0), dvec3(5, 0, 0), dvec3(0, 0, -3)),
               build.lambert("floor", dvec3(0.4, 0.45, 0.5)));
    build.sphere("mirror", dvec3(-2.4, 0.7, 0), 0.7, build.material(mirror));
    build.sphere("glass", dvec3(-0.8, 0.7, 0), 0.7, build.material(clear));
    build.sphere("frosted glass", dvec3(0.8, 0.7, 0), 0.7, build.material(frosted));
    build.sphere("gold", dvec3(2.4, 0.7, 0), 0.7, build.material(gold));
    Material lamp;
    lamp.name = "lamp";
    lamp.model = BsdfModel::lambert;
    lamp.base_color = dvec4(0, 0, 0, 1);
    lamp.emission = dvec3(8);
    lamp.emits_front_only = true;
    build.show("lamp", make_rectangle(dvec3(0, 4, 0), dvec3(1.5, 0, 0), dvec3(0, 0, 1)), build.material(lamp));
    build.environment(constant(0.3));
    build.camera("front", 28, dvec3(0, 2, 9), dvec3(0, 0.6, 0));
    build.size(480, 270);
    build.max_depth(10);
    return std::move(build).finish();
}

}  // namespace etalon::builtin
