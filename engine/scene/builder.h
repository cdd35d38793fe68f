#pragma once
#include <string>
#include <vector>

#include "engine/scene/scene.h"

namespace etalon {

// Geometry of the built-in scenes and of tests. All triangles are counter-clockwise seen from outside; metres.

/// A rectangle centre ± half_u ± half_v whose normal is half_u × half_v; uv (0, 0) at -half_u +half_v (the top left
/// corner).
Primitive make_rectangle(dvec3 center, dvec3 half_u, dvec3 half_v);
/// A box of half extents `half`, turned by `yaw` radians about +Y; each face has uv 0 … 1.
Primitive make_box(dvec3 center, dvec3 half, double yaw = 0);
/// A latitude-longitude sphere with smooth normals: 2 · segments · (rings - 1) triangles, segments ≥ 3, rings ≥ 2.
Primitive make_sphere(dvec3 center, double radius, int segments, int rings);
/// `b` appended to `a`; both have the same attributes.
Primitive joined(Primitive a, const Primitive& b);
/// Smallest and largest position; {0, 0} without positions.
std::pair<vec3, vec3> bounds(const Primitive& primitive);

/// World from camera of an eye that looks at a target with +Y up; the view must not be vertical.
dmat4 look_from(dvec3 eye, dvec3 target);
dmat4 translation(dvec3 offset);
dmat4 rotation_y(double radians);
dmat4 rotation_x(double radians);

/// A scene put together in code. Every function returns the index of what it added. One root, filled in order.
class SceneBuilder {
 public:
    explicit SceneBuilder(std::string name);

    Index material(Material material);
    Index lambert(std::string name, dvec3 reflectance);
    Index metallic_roughness(std::string name, dvec3 color, double metallic, double roughness);
    /// 8-bit RGBA texels from `texel(x, y)`.
    template <typename Function>
    TextureUse texture(std::string name, int width, int height, Sampler sampler, Function texel)
    {
        Texels texels{.width = width, .height = height, .is_8_bit = true, .bytes = {}, .wide = {}};
        texels.bytes.reserve(std::size_t(width) * std::size_t(height) * 4);
        for (int y = 0; y < height; ++y)
            for (int x = 0; x < width; ++x)
                for (const std::uint8_t value : std::array<std::uint8_t, 4>(texel(x, y))) texels.bytes.push_back(value);
        return texture(std::move(name), std::move(texels), sampler);
    }
    TextureUse texture(std::string name, Texels texels, Sampler sampler);
    Index mesh(std::string name, std::vector<Primitive> primitives);
    Index node(Node node);
    /// A node at the root that shows `primitive` with `material`.
    Index show(std::string name, Primitive primitive, Index material, dmat4 parent_from_node = dmat4(1));
    Index sphere(std::string name, dvec3 center, double radius, Index material);
    Index light(Light light, dmat4 parent_from_node);
    Index camera(Camera camera, dmat4 parent_from_node);
    /// Vertical field of view in degrees.
    Index camera(std::string name, double yfov, dvec3 eye, dvec3 target);
    void environment(Environment environment) { scene_.roots[0].environment = std::move(environment); }
    void size(int width, int height) { scene_.roots[0].hints.size = ivec2(width, height); }
    void max_depth(int depth) { scene_.roots[0].hints.max_depth = depth; }

    Scene finish() &&;

 private:
    Scene scene_;
};

}  // namespace etalon
