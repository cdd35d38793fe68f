#include "engine/scene/builder.h"

#include "engine/base/error.h"

namespace etalon {

Primitive make_rectangle(dvec3 center, dvec3 half_u, dvec3 half_v)
{
    Primitive out;
    const vec3 normal(normalize(cross(half_u, half_v)));
    for (const auto& [s, t] : {std::pair(0.0, 0.0), std::pair(0.0, 1.0), std::pair(1.0, 1.0), std::pair(1.0, 0.0)}) {
        out.positions.emplace_back(center + (2 * s - 1) * half_u + (1 - 2 * t) * half_v);
        out.normals.push_back(normal);
        out.uv[0].emplace_back(s, t);
    }
    out.indices = {0, 1, 2, 0, 2, 3};
    return out;
}

Primitive joined(Primitive a, const Primitive& b)
{
    const auto base = static_cast<std::uint32_t>(a.positions.size());
    a.positions.insert(a.positions.end(), b.positions.begin(), b.positions.end());
    a.normals.insert(a.normals.end(), b.normals.begin(), b.normals.end());
    a.tangents.insert(a.tangents.end(), b.tangents.begin(), b.tangents.end());
    a.colors.insert(a.colors.end(), b.colors.begin(), b.colors.end());
    for (std::size_t set = 0; set < a.uv.size(); ++set)
        a.uv[set].insert(a.uv[set].end(), b.uv[set].begin(), b.uv[set].end());
    for (const std::uint32_t index : b.indices) a.indices.push_back(base + index);
    return a;
}

Primitive make_box(dvec3 center, dvec3 half, double yaw)
{
    const dmat3 turn(rotation_y(yaw));
    const auto face = [&](dvec3 n, dvec3 u, dvec3 v) {
        return make_rectangle(center + turn * (n * half), turn * (u * half), turn * (v * half));
    };
    const dvec3 x(1, 0, 0), y(0, 1, 0), z(0, 0, 1);
    Primitive out = face(z, x, y);
    out = joined(std::move(out), face(-z, -x, y));
    out = joined(std::move(out), face(x, -z, y));
    out = joined(std::move(out), face(-x, z, y));
    out = joined(std::move(out), face(y, x, -z));
    return joined(std::move(out), face(-y, x, z));
}

Primitive make_sphere(dvec3 center, double radius, int segments, int rings)
{
    assume(segments >= 3 && rings >= 2);
    Primitive out;
    out.has_normals = true;
    for (int j = 0; j <= rings; ++j)
        for (int i = 0; i <= segments; ++i) {
            const double v = double(j) / rings;
            const double u = double(i) / segments;
            // The poles and the seam are exact, so that the surface is closed.
            const double ring = j == 0 || j == rings ? 0 : std::sin(kPi * v);
            const double turn = i == segments ? 0 : 2 * kPi * u;
            const dvec3 n(ring * std::sin(turn), std::cos(kPi * v), ring * std::cos(turn));
            out.positions.emplace_back(center + radius * n);
            out.normals.emplace_back(n);
            out.uv[0].emplace_back(u, v);
        }
    const auto at = [&](int i, int j) { return static_cast<std::uint32_t>(j * (segments + 1) + i); };
    for (int j = 0; j < rings; ++j)
        for (int i = 0; i < segments; ++i) {
            if (j > 0) out.indices.insert(out.indices.end(), {at(i, j), at(i, j + 1), at(i + 1, j)});
            if (j < rings - 1) out.indices.insert(out.indices.end(), {at(i + 1, j), at(i, j + 1), at(i + 1, j + 1)});
        }
    return out;
}

std::pair<vec3, vec3> bounds(const Primitive& primitive)
{
    if (primitive.positions.empty()) return {vec3(0), vec3(0)};
    vec3 low = primitive.positions.front();
    vec3 high = low;
    for (const vec3& p : primitive.positions) {
        low = glm::min(low, p);
        high = glm::max(high, p);
    }
    return {low, high};
}

dmat4 look_from(dvec3 eye, dvec3 target)
{
    const dvec3 z = normalize(eye - target);
    const dvec3 x = normalize(cross(dvec3(0, 1, 0), z));
    return dmat4(dvec4(x, 0), dvec4(cross(z, x), 0), dvec4(z, 0), dvec4(eye, 1));
}

dmat4 translation(dvec3 offset)
{
    dmat4 out(1);
    out[3] = dvec4(offset, 1);
    return out;
}

dmat4 rotation_y(double radians)
{
    const double c = std::cos(radians);
    const double s = std::sin(radians);
    return dmat4(dvec4(c, 0, -s, 0), dvec4(0, 1, 0, 0), dvec4(s, 0, c, 0), dvec4(0, 0, 0, 1));
}

dmat4 rotation_x(double radians)
{
    const double c = std::cos(radians);
    const double s = std::sin(radians);
    return dmat4(dvec4(1, 0, 0, 0), dvec4(0, c, s, 0), dvec4(0, -s, c, 0), dvec4(0, 0, 0, 1));
}

namespace {

template <typename T>
Index append(std::vector<T>& to, T value)
{
    to.push_back(std::move(value));
    return static_cast<Index>(to.size() - 1);
}

}  // namespace

SceneBuilder::SceneBuilder(std::string name)
{
    scene_.name = std::move(name);
    scene_.roots.emplace_back();
}

Index SceneBuilder::material(Material material)
{
    return append(scene_.materials, std::move(material));
}

Index SceneBuilder::lambert(std::string name, dvec3 reflectance)
{
    Material out;
    out.name = std::move(name);
    out.model = BsdfModel::lambert;
    out.base_color = dvec4(reflectance, 1);
    return material(std::move(out));
}

Index SceneBuilder::metallic_roughness(std::string name, dvec3 color, double metallic, double roughness)
{
    Material out;
    out.name = std::move(name);
    out.base_color = dvec4(color, 1);
    out.metallic = metallic;
    out.roughness = roughness;
    return material(std::move(out));
}

TextureUse SceneBuilder::texture(std::string name, Texels texels, Sampler sampler)
{
    const Index image = append(scene_.images, std::move(texels));
    TextureUse use;
    use.texture = append(scene_.textures, Texture{.name = std::move(name), .image = image, .sampler = sampler});
    return use;
}

Index SceneBuilder::mesh(std::string name, std::vector<Primitive> primitives)
{
    return append(scene_.meshes, Mesh{std::move(name), std::move(primitives)});
}

Index SceneBuilder::node(Node node)
{
    const Index index = append(scene_.nodes, std::move(node));
    scene_.roots[0].nodes.push_back(index);
    return index;
}

Index SceneBuilder::show(std::string name, Primitive primitive, Index material, dmat4 parent_from_node)
{
    primitive.material = material;
    Node out;
    out.name = name;
    out.parent_from_node = parent_from_node;
    std::vector<Primitive> primitives;
    primitives.push_back(std::move(primitive));
    out.mesh = mesh(std::move(name), std::move(primitives));
    return node(std::move(out));
}

Index SceneBuilder::sphere(std::string name, dvec3 center, double radius, Index material)
{
    Node out;
    out.name = std::move(name);
    out.parent_from_node = translation(center);
    out.sphere = SphereShape{radius, material};
    return node(std::move(out));
}

Index SceneBuilder::light(Light light, dmat4 parent_from_node)
{
    Node out;
    out.name = light.name;
    out.parent_from_node = parent_from_node;
    out.light = append(scene_.lights, std::move(light));
    return node(std::move(out));
}

Index SceneBuilder::camera(Camera camera, dmat4 parent_from_node)
{
    Node out;
    out.name = camera.name;
    out.parent_from_node = parent_from_node;
    out.camera = append(scene_.cameras, std::move(camera));
    return node(std::move(out));
}

Index SceneBuilder::camera(std::string name, double yfov, dvec3 eye, dvec3 target)
{
    Camera out;
    out.name = std::move(name);
    out.yfov = yfov * kPi / 180;
    return camera(std::move(out), look_from(eye, target));
}

Scene SceneBuilder::finish() &&
{
    return std::move(scene_);
}

}  // namespace etalon
