#include "engine/scene/builder.h"
#include "engine/scene/builtin_scenes.h"
#include "engine/scene/pose.h"

namespace etalon::builtin {

namespace {

using Rgba8 = std::array<std::uint8_t, 4>;

std::uint8_t byte(double value)
{
    return static_cast<std::uint8_t>(std::lround(255 * std::min(std::max(value, 0.0), 1.0)));
}

Rgba8 checker(int x, int y, int cell, Rgba8 even, Rgba8 odd)
{
    return ((x / cell) + (y / cell)) % 2 == 0 ? even : odd;
}

Light directional(std::string name, double intensity)
{
    Light out;
    out.name = std::move(name);
    out.type = LightType::directional;
    out.intensity = intensity;
    return out;
}

Environment sky(double radiance)
{
    Environment out;
    out.radiance = dvec3(0.8, 0.9, 1) * radiance;
    return out;
}

// The blocks that `orthographic` and `thin_lens` look at.
void add_row_of_boxes(SceneBuilder& build)
{
    build.show("floor", make_rectangle(dvec3(0), dvec3(5, 0, 0), dvec3(0, 0, -5)), build.lambert("floor", dvec3(0.5)));
    const std::array<dvec3, 4> colors = {dvec3(0.7, 0.2, 0.15), dvec3(0.2, 0.6, 0.25), dvec3(0.2, 0.3, 0.7),
                                         dvec3(0.7, 0.6, 0.2)};
    for (int i = 0; i < 4; ++i)
        build.show("box", make_box(dvec3(-1.8 + 1.2 * i, 0.4, 1.5 - 1.2 * i), dvec3(0.4), 0.3 * i),
                   build.lambert("box", colors[std::size_t(i)]));
    build.light(directional("sun", 2), look_from(dvec3(2, 4, 3), dvec3(0)));
    build.environment(sky(0.3));
    build.size(320, 240);
}

}  // namespace

Scene spheres()
{
    SceneBuilder build("builtin:spheres");
    for (int metal = 0; metal < 2; ++metal)
        for (int i = 0; i < 5; ++i) {
            const double roughness = 0.1 + 0.225 * i;
            const dvec3 color = metal ? dvec3(0.95, 0.75, 0.45) : dvec3(0.6, 0.08, 0.08);
            build.show(metal ? "metal" : "plastic", make_sphere(dvec3(2.2 * (i - 2), metal ? 1.1 : -1.1, 0), 1, 64, 32),
                       build.metallic_roughness(metal ? "metal" : "plastic", color, metal, roughness));
        }
    build.environment(studio_environment());
    build.camera("front", 26, dvec3(0, 0, 15), dvec3(0));
    build.size(640, 300);
    return std::move(build).finish();
}

Scene texture_plane()
{
    SceneBuilder build("builtin:texture-plane");
    Material plane;
    plane.name = "checker";
    plane.model = BsdfModel::unlit;
    plane.base_color_texture = build.texture("checker", 64, 64, Sampler{}, [](int x, int y) {
        return checker(x, y, 8, Rgba8{230, 225, 215, 255}, Rgba8{40, 60, 120, 255});
    });
    Primitive p = make_rectangle(dvec3(0, 0, -95), dvec3(100, 0, 0), dvec3(0, 0, -100));
    for (vec2& uv : p.uv[0]) uv = uv * 100.0f;
    build.show("plane", std::move(p), build.material(std::move(plane)));
    build.environment(sky(0.8));
    build.camera("standing", 50, dvec3(0, 1.6, 4), dvec3(0, 0.9, 0));
    build.size(480, 320);
    return std::move(build).finish();
}

Scene normals()
{
    SceneBuilder build("builtin:normals");
    constexpr int kSize = 128;
    Material bumpy;
    bumpy.name = "bumps";
    bumpy.base_color = dvec4(0.6, 0.55, 0.5, 1);
    bumpy.metallic = 0;
    bumpy.roughness = 0.5;
    // Round bumps on a hexagonal-looking lattice: slopes of h = 0.5 sin(4 turn x) sin(4 turn y).
    bumpy.normal_texture = build.texture("bumps", kSize, kSize, Sampler{}, [](int x, int y) {
        const double a = 2 * kPi * 4 * (x + 0.5) / kSize;
        const double b = 2 * kPi * 4 * (y + 0.5) / kSize;
        // +Y of tangent space points up the picture, against y.
        const dvec3 n = normalize(dvec3(-0.5 * std::cos(a) * std::sin(b), 0.5 * std::sin(a) * std::cos(b), 1));
        return Rgba8{byte(0.5 + 0.5 * n.x), byte(0.5 + 0.5 * n.y), byte(0.5 + 0.5 * n.z), 255};
    });
    Primitive floor = make_rectangle(dvec3(0), dvec3(3, 0, 0), dvec3(0, 0, -3));
    for (vec2& uv : floor.uv[0]) uv = uv * 2.0f;
    floor.tangents.assign(4, vec4(1, 0, 0, 1));
    Primitive ball = make_sphere(dvec3(0, 1, 0), 1, 64, 32);
    for (vec2& uv : ball.uv[0]) {
        const double turn = 2 * kPi * double(uv.x);
        uv = uv * vec2(4, 2);
        ball.tangents.emplace_back(vec3(dvec3(std::cos(turn), 0, -std::sin(turn))), 1.0f);
    }
    const Index material = build.material(std::move(bumpy));
    build.show("floor", std::move(floor), material);
    build.show("ball", std::move(ball), material);
    build.light(directional("sun", 3), look_from(dvec3(3, 3, 2), dvec3(0)));
    build.environment(sky(0.2));
    build.camera("front", 38, dvec3(0, 2.2, 5.5), dvec3(0, 0.7, 0));
    build.size(400, 300);
    return std::move(build).finish();
}

Scene maps()
{
    SceneBuilder build("builtin:maps");
    Material all;
    all.name = "maps";
    all.emission = dvec3(0.9, 0.6, 0.2);
    const Sampler nearest{.wrap_u = Wrap::mirrored_repeat,
                          .wrap_v = Wrap::clamp_to_edge,
                          .mag = Filter::nearest,
                          .min = Filter::nearest,
                          .mip = Filter::nearest,
                          .mipmapped = false};
    all.base_color_texture = build.texture("colours", 16, 16, nearest, [](int x, int y) {
        return Rgba8{std::uint8_t(90 + 10 * x), std::uint8_t(80 + 10 * y), 120, 255};
    });
    // Turned by 30 degrees and repeated 1.5 times, as KHR_texture_transform would say.
    const double c = 1.5 * std::cos(kPi / 6);
    const double s = 1.5 * std::sin(kPi / 6);
    all.base_color_texture.transform = dmat3(dvec3(c, -s, 0), dvec3(s, c, 0), dvec3(-0.2, 0.1, 1));
    all.metallic_roughness_texture = build.texture("metal and roughness", 64, 64, Sampler{}, [](int x, int y) {
        return Rgba8{0, std::uint8_t(40 + 3 * y), std::uint8_t(x < 32 ? 0 : 255), 255};
    });
    all.occlusion_texture = build.texture("occlusion", 64, 64, Sampler{}, [](int x, int y) {
        const double r = std::hypot(x - 31.5, y - 31.5) / 45;
        return Rgba8{byte(1 - 0.7 * r), 0, 0, 255};
    });
    all.occlusion_texture.uv_set = 1;
    all.emissive_texture = build.texture("glow", 64, 64, Sampler{}, [](int x, int y) {
        return checker(x, y, 16, Rgba8{0, 0, 0, 255},
                       Rgba8{std::uint8_t(x > 40 ? 200 : 0), std::uint8_t(x > 40 ? 200 : 0), 0, 255});
    });
    Primitive wall = make_rectangle(dvec3(0), dvec3(1.5, 0, 0), dvec3(0, 1.5, 0));
    wall.uv[1] = wall.uv[0];
    for (vec2& uv : wall.uv[1]) uv = uv * 2.0f;
    build.show("wall", std::move(wall), build.material(std::move(all)));
    build.light(directional("sun", 2), look_from(dvec3(1, 2, 3), dvec3(0)));
    build.environment(studio_environment());
    build.camera("front", 40, dvec3(0.6, 0.3, 4.5), dvec3(0));
    build.size(360, 360);
    return std::move(build).finish();
}

Scene alpha()
{
    SceneBuilder build("builtin:alpha");
    build.show("wall", make_rectangle(dvec3(0, 1, -1), dvec3(3, 0, 0), dvec3(0, 1.5, 0)),
               build.lambert("wall", dvec3(0.7, 0.7, 0.65)));
    Material mask;
    mask.name = "mask";
    mask.metallic = 0;
    mask.roughness = 0.8;
    mask.alpha_mode = AlphaMode::mask;
    mask.double_sided = true;
    mask.base_color_texture = build.texture("disks", 64, 64, Sampler{}, [](int x, int y) {
        const bool inside = std::hypot(x % 32 - 15.5, y % 32 - 15.5) < 12;
        return Rgba8{60, 130, 50, std::uint8_t(inside ? 255 : 0)};
    });
    Material red;
    red.name = "red glass";
    red.base_color = dvec4(0.8, 0.1, 0.1, 0.5);
    red.metallic = 0;
    red.roughness = 0.9;
    red.alpha_mode = AlphaMode::blend;
    red.double_sided = true;
    Material blue = red;
    blue.name = "blue glass";
    blue.base_color = dvec4(0.1, 0.2, 0.8, 0.35);
    build.show("leaf", make_rectangle(dvec3(-1.2, 1, 0), dvec3(0.7, 0, 0.2), dvec3(0, 0.8, 0)),
               build.material(std::move(mask)));
    build.show("red", make_rectangle(dvec3(0.4, 1, 0.2), dvec3(0.6, 0, 0), dvec3(0, 0.7, 0)),
               build.material(std::move(red)));
    build.show("blue", make_rectangle(dvec3(1, 0.8, 0.6), dvec3(-0.6, 0, 0), dvec3(0, 0.6, 0)),
               build.material(std::move(blue)));
    build.light(directional("sun", 2), look_from(dvec3(-2, 3, 4), dvec3(0, 1, 0)));
    build.environment(sky(0.4));
    build.camera("front", 36, dvec3(0, 1.2, 5), dvec3(0, 1, 0));
    build.size(400, 300);
    return std::move(build).finish();
}

Scene instances()
{
    SceneBuilder build("builtin:instances");
    build.show("floor", make_rectangle(dvec3(0), dvec3(12, 0, 0), dvec3(0, 0, -12)),
               build.lambert("floor", dvec3(0.4)));
    Primitive box = make_box(dvec3(0, 0.3, 0), dvec3(0.2, 0.3, 0.2));
    box.material = build.lambert("box", dvec3(0.7, 0.5, 0.3));
    std::vector<Primitive> primitives;
    primitives.push_back(std::move(box));
    Node field;
    field.name = "field";
    field.mesh = build.mesh("box", std::move(primitives));
    for (int i = 0; i < 1000; ++i) {
        const int row = i / 40;
        const double x = i % 40 - 19.5;
        const double z = row - 12.0;
        const double height = 0.4 + 0.6 * std::abs(std::sin(0.37 * x) * std::cos(0.53 * z));
        dmat4 stretched(1);
        stretched[1][1] = height;
        field.instances.push_back(translation(dvec3(0.5 * x, 0, 0.7 * z)) * rotation_y(0.31 * i) * stretched);
    }
    build.node(std::move(field));
    build.light(directional("sun", 2.5), look_from(dvec3(4, 5, 2), dvec3(0)));
    build.environment(sky(0.5));
    build.camera("above", 40, dvec3(0, 6, 13), dvec3(0, 0, -1));
    build.size(480, 320);
    return std::move(build).finish();
}

Scene blinn_phong()
{
    SceneBuilder build("builtin:blinn-phong");
    for (int i = 0; i < 4; ++i) {
        const double roughness = 0.25 + 0.2 * i;
        const dvec3 color(0.25 + 0.15 * i, 0.35, 0.6 - 0.12 * i);
        build.show("ball", make_sphere(dvec3(1.7 * (i - 1.5), 0.75, 0), 0.75, 64, 32),
                   build.metallic_roughness("ball", color, i % 2 ? 1 : 0, roughness));
    }
    build.show("floor", make_rectangle(dvec3(0), dvec3(4, 0, 0), dvec3(0, 0, -2)),
               build.metallic_roughness("floor", dvec3(0.5), 0, 0.6));
    build.light(directional("sun", 2), look_from(dvec3(-3, 4, 3), dvec3(0)));
    Light lamp;
    lamp.name = "lamp";
    lamp.intensity = 8;
    lamp.color = dvec3(1, 0.9, 0.7);
    build.light(lamp, translation(dvec3(2, 2.5, 2.5)));
    build.environment(sky(0.1));
    build.camera("front", 30, dvec3(0, 2, 9), dvec3(0, 0.6, 0));
    build.size(480, 240);
    return std::move(build).finish();
}

Scene wires()
{
    SceneBuilder build("builtin:wires");
    Material ink;
    ink.name = "ink";
    ink.model = BsdfModel::unlit;
    ink.base_color = dvec4(0.9, 0.6, 0.1, 1);
    const Index material = build.material(std::move(ink));
    const Primitive box = make_box(dvec3(0), dvec3(1));
    Primitive lines;
    lines.topology = Topology::lines;
    lines.positions = box.positions;
    for (std::uint32_t face = 0; face < 6; ++face)
        for (std::uint32_t i = 0; i < 4; ++i)
            lines.indices.insert(lines.indices.end(), {4 * face + i, 4 * face + (i + 1) % 4});
    Primitive points;
    points.topology = Topology::points;
    for (int i = 0; i < 400; ++i) {
        const double height = 1 - 2 * (i + 0.5) / 400;  // a Fibonacci spiral on a sphere
        const double turn = 2.399963229728653 * i;
        const double ring = std::sqrt(1 - height * height);
        points.positions.emplace_back(dvec3(ring * std::cos(turn), height, ring * std::sin(turn)) * 1.3);
        points.indices.push_back(static_cast<std::uint32_t>(i));
    }
    build.show("edges", std::move(lines), material);
    build.show("spiral", std::move(points), material);
    build.show("core", make_box(dvec3(0), dvec3(0.5), 0.5), build.lambert("core", dvec3(0.6, 0.6, 0.7)));
    build.environment(sky(0.6));
    build.camera("corner", 42, dvec3(2.6, 1.9, 3.9), dvec3(0));
    build.size(360, 360);
    return std::move(build).finish();
}

Scene orthographic()
{
    SceneBuilder build("builtin:orthographic");
    add_row_of_boxes(build);
    Camera camera;
    camera.name = "plan";
    camera.orthographic = true;
    camera.ymag = 2.4;
    camera.xmag = 2.4 * 4.0 / 3;
    build.camera(std::move(camera), look_from(dvec3(4, 4, 6), dvec3(0, 0.3, 0)));
    return std::move(build).finish();
}

Scene thin_lens()
{
    SceneBuilder build("builtin:thin-lens");
    add_row_of_boxes(build);
    Camera camera;
    camera.name = "lens";
    camera.yfov = 36 * kPi / 180;
    const dvec3 eye(0, 1.6, 6);
    const dvec3 target(-0.6, 0.4, 0.3);
    camera.lens = ThinLens{.aperture_radius = 0.12, .focus_distance = length(target - eye)};
    build.camera(std::move(camera), look_from(eye, target));
    return std::move(build).finish();
}

Scene siemens_star()
{
    SceneBuilder build("builtin:siemens-star");
    constexpr int kSpokes = 72;
    const auto flat = [&](const char* name, double value) {
        Material material;
        material.name = name;
        material.model = BsdfModel::unlit;
        material.base_color = dvec4(dvec3(value), 1);
        return build.material(std::move(material));
    };
    // At r metres it has 72/(2 pi r) spokes a metre.
    Primitive star;
    star.positions.emplace_back(0.f);
    for (int i = 0; i < 2 * kSpokes; ++i) {
        const double turn = 2 * kPi * (i + 0.25) / (2 * kSpokes);  // no edge along rows or columns
        star.positions.emplace_back(dvec3(std::cos(turn), std::sin(turn), 0) * 0.95);
        if (i % 2 == 0) star.indices.insert(star.indices.end(), {0u, std::uint32_t(i + 1), std::uint32_t(i + 2)});
    }
    star.normals.assign(star.positions.size(), vec3(0, 0, 1));
    build.show("black", make_rectangle(dvec3(0, 0, -0.1), dvec3(1, 0, 0), dvec3(0, 1, 0)), flat("black", 0));
    build.show("spokes", std::move(star), flat("white", 1));
    build.environment(sky(0));  // dark: nothing here is lit
    Camera camera;
    camera.name = "front";
    camera.orthographic = true;
    build.camera(camera, translation(dvec3(0, 0, 1)));
    build.size(256, 256);
    return std::move(build).finish();
}

}  // namespace etalon::builtin
