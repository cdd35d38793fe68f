#include "engine/render/path_geometry.h"

#include <fmt/format.h>

#include <bit>
#include <utility>

#include "engine/base/error.h"
#include "engine/base/parallel.h"
#include "engine/math/transform.h"
#include "engine/render/path_emission.h"
#include "engine/render/path_layers.h"
#include "engine/scene/glass.h"
#include "shaders/shared/path.h"

namespace etalon {
namespace {

/// A primitive before the BVH orders it: a triangle of a draw, or a sphere (draw is kNone).
struct Source {
    Index draw = kNone;
    Index element = 0;
};

struct Corners {
    std::array<std::uint32_t, 3> vertex{};  ///< counter-clockwise seen from the front, also where the draw is mirrored
    std::array<vec3, 3> p{};                ///< relative to the origin
};

/// What a draw does to its vertices.
struct DrawFrame {
    dmat4 origin_from_object{1};
    dmat3 vector_from_object{1};
    dmat3 normal_from_object{1};  ///< cofactors over their largest entry (G28)
    bool mirrored = false;
};

DrawFrame frame_of(const Draw& draw, const dvec3& origin)
{
    DrawFrame frame;
    frame.origin_from_object = draw.world_from_object;
    frame.origin_from_object[3] -= dvec4(origin, 0);
    const dmat3 m(draw.world_from_object);
    frame.vector_from_object = m;
    frame.mirrored = glm::determinant(m) < 0;
    const dmat3 turned = cofactor(m);
    double largest = 0;
    for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 3; ++j) largest = std::max(largest, std::abs(turned[i][j]));
    if (largest > 0) frame.normal_from_object = turned / (frame.mirrored ? -largest : largest);
    return frame;
}

Corners corners_of(const Primitive& primitive, const DrawFrame& frame, Index triangle)
{
    Corners out;
    for (std::size_t i = 0; i < 3; ++i) out.vertex[i] = primitive.indices[3 * std::size_t(triangle) + i];
    if (frame.mirrored) std::swap(out.vertex[1], out.vertex[2]);
    for (std::size_t i = 0; i < 3; ++i)
        out.p[i] = vec3(dvec3(frame.origin_from_object * dvec4(dvec3(primitive.positions[out.vertex[i]]), 1)));
    return out;
}

double area_of(const Corners& c)
{
    const dvec3 a(c.p[0]);
    return length(cross(dvec3(c.p[1]) - a, dvec3(c.p[2]) - a)) / 2;
}

std::uint32_t bits(float value)
{
    return std::bit_cast<std::uint32_t>(value);
}
uvec4 texel(const vec3& v, std::uint32_t w)
{
    return {bits(v.x), bits(v.y), bits(v.z), w};
}
uvec4 texel(const vec4& v)
{
    return {bits(v.x), bits(v.y), bits(v.z), bits(v.w)};
}

class Flattening {
 public:
    Flattening(const PosedScene& posed, const PathFeatures& features, const dvec3& origin, unsigned threads)
        : posed_(posed), features_(features), threads_(threads)
    {
        out_.origin = origin;
        for (const Draw& draw : posed.draws) frames_.push_back(frame_of(draw, origin));
    }

    PathGeometry run() &&
    {
        list();
        BvhOptions options;
        options.threads = threads_;
        out_.bvh = build_bvh(boxes_, options);
        out_.degenerate += out_.bvh.dropped;
        out_.count = out_.bvh.order.size();
        out_.primitives.resize(3 * out_.count);
        out_.attributes.resize(features_.attribute_stride() * out_.count);
        constexpr std::size_t kChunk = 1u << 14;
        parallel_for((out_.count + kChunk - 1) / kChunk,
                     [&](std::size_t chunk) {
                         for (std::size_t i = chunk * kChunk; i < std::min(out_.count, (chunk + 1) * kChunk); ++i)
                             write(i);
                     },
                     threads_);
        if (features_.emission)
            for (std::size_t i = 0; i < out_.count; ++i) add_emitter(i);
        return std::move(out_);
    }

 private:
    const Material& material(Index index) const { return posed_.materials()[index]; }

    void list()
    {
        for (Index d = 0; d < posed_.draws.size(); ++d) {
            const Primitive& primitive = posed_.primitive(posed_.draws[d]);
            if (!features_.triangles || primitive.topology != Topology::triangles) continue;
            const auto triangles = static_cast<Index>(primitive.indices.size() / 3);
            if (boxes_.size() + triangles > (std::size_t{1} << 27))
                throw Error(Blame::machine, "the scene has more than 134217728 triangles",
                            "simplify or split the scene");
            for (Index t = 0; t < triangles; ++t) {
                const Corners corners = corners_of(primitive, frames_[d], t);
                if (!(area_of(corners) > 0)) {
                    ++out_.degenerate;
                    continue;
                }
                Box box;
                for (const vec3& p : corners.p) box.add(p);
                boxes_.push_back(box);
                sources_.push_back({d, t});
            }
        }
        for (Index s = 0; features_.spheres && s < posed_.spheres.size(); ++s) {
            const dvec3 center = posed_.spheres[s].center - out_.origin;
            // A float centre and radius move the surface by an ulp of either.
            const double reach = posed_.spheres[s].radius * (1 + 1e-6) + 1e-6 * length(center);
            Box box;
            box.add(vec3(center - reach));
            box.add(vec3(center + reach));
            boxes_.push_back(box);
            sources_.push_back({kNone, s});
        }
    }

    void write(std::size_t position)
    {
        const Source source = sources_[out_.bvh.order[position]];
        if (source.draw == kNone) {
            write_sphere(position, source.element);
        } else {
            write_triangle(position, source);
        }
    }

    std::uint32_t flags_of(Index index) const
    {
        const Material& m = material(index);
        const bool gltf = m.model == BsdfModel::metallic_roughness || m.model == BsdfModel::unlit ||
                          m.model == BsdfModel::specular_glossiness;
        // (SH-63) The back of a body is the way out of it.
        const bool body = features_.volume && layered(m) && m.layers->volumetric();
        std::uint32_t flags = index & shared::kPrimitiveMaterial;
        if (gltf && !m.double_sided && !body) flags |= shared::kPrimitiveCulled;
        if (m.alpha_mode != AlphaMode::opaque) flags |= shared::kPrimitiveAlpha;
        if (m.double_sided && !m.emits_front_only) flags |= shared::kPrimitiveEmitsBack;
        if (features_.glass_shadows && is_smooth_thin_glass(m)) flags |= shared::kPrimitiveGlass;
        return flags;
    }

    void write_sphere(std::size_t position, Index index)
    {
        const PosedSphere& sphere = posed_.spheres[index];
        uvec4* out = &out_.primitives[3 * position];
        out[0] = texel(vec3(sphere.center - out_.origin), flags_of(sphere.material) | shared::kPrimitiveSphere);
        out[1] = texel(vec3(static_cast<float>(sphere.radius), 0, 0), 0);
        out[2] = texel(vec3(0), static_cast<std::uint32_t>(posed_.draws.size()) + index + 1);
        // Spheres have neither texture coordinates nor vertex colours: (0, 0) and white.
        if (!features_.colors) return;
        uvec4* colors = &out_.attributes[features_.attribute_stride() * (position + 1) - 3];
        for (int i = 0; i < 3; ++i) colors[i] = texel(vec4(1));
    }

    void write_triangle(std::size_t position, const Source& source)
    {
        const Primitive& primitive = posed_.primitive(posed_.draws[source.draw]);
        const DrawFrame& frame = frames_[source.draw];
        const Corners corners = corners_of(primitive, frame, source.element);
        uvec4* out = &out_.primitives[3 * position];
        out[0] = texel(corners.p[0], flags_of(primitive.material));
        out[1] = texel(corners.p[1], 0);
        out[2] = texel(corners.p[2], source.draw + 1);

        uvec4* attribute = out_.attributes.data() + features_.attribute_stride() * position;
        const auto section = [&](auto value_at) {
            for (const std::uint32_t vertex : corners.vertex) *attribute++ = value_at(vertex);
        };
        if (features_.normals)
            section([&](std::uint32_t v) {
                if (!primitive.has_normals) return texel(vec4(0));  // (SH-2): the geometric normal is used
                return texel(vec3(frame.normal_from_object * dvec3(primitive.normals[v])), 0);
            });
        if (features_.uv)
            section([&](std::uint32_t v) {
                const vec2 a = primitive.uv[0].empty() ? vec2(0) : primitive.uv[0][v];
                const vec2 b = primitive.uv[1].empty() ? vec2(0) : primitive.uv[1][v];
                return texel(vec4(a, b));
            });
        if (features_.tangents)
            section([&](std::uint32_t v) {
                if (primitive.tangents.empty()) return texel(vec4(0));
                const vec4& t = primitive.tangents[v];
                const float sign = (t.w < 0) == frame.mirrored ? 1.f : -1.f;
                return texel(vec4(vec3(frame.vector_from_object * dvec3(t)), sign));
            });
        if (features_.colors)
            section([&](std::uint32_t v) { return texel(primitive.colors.empty() ? vec4(1) : primitive.colors[v]); });
    }

    void add_emitter(std::size_t position)
    {
        const Source source = sources_[out_.bvh.order[position]];
        const bool sphere = source.draw == kNone;
        const Index index =
            sphere ? posed_.spheres[source.element].material : posed_.primitive(posed_.draws[source.draw]).material;
        const Material& m = material(index);
        if (m.model == BsdfModel::unlit || m.emission == dvec3(0)) return;
        PathEmitter emitter{.primitive = static_cast<std::uint32_t>(position), .box = boxes_[out_.bvh.order[position]]};
        double radiance = 0;
        if (sphere) {
            const double radius = posed_.spheres[source.element].radius;
            emitter.area = 4 * kPi * radius * radius;
            radiance = mean_emission(*posed_.scene, m, {});
        } else {
            const Primitive& primitive = posed_.primitive(posed_.draws[source.draw]);
            const Corners corners = corners_of(primitive, frames_[source.draw], source.element);
            emitter.area = area_of(corners);
            const dvec3 a(corners.p[0]);
            emitter.normal = normalize(cross(dvec3(corners.p[1]) - a, dvec3(corners.p[2]) - a));
            const std::vector<vec2>& uv = primitive.uv[std::size_t(m.emissive_texture.uv_set == 1)];
            std::array<vec2, 3> at{};
            for (std::size_t i = 0; i < 3 && !uv.empty(); ++i) at[i] = uv[corners.vertex[i]];
            radiance = mean_emission(*posed_.scene, m, at);
        }
        const bool both = (out_.primitives[3 * position].w & shared::kPrimitiveEmitsBack) != 0;
        emitter.weight = radiance * emitter.area * (both ? 2 : 1);
        emitter.everywhere = both || sphere;
        if (emitter.weight > 0 && std::isfinite(emitter.weight)) out_.emitters.push_back(emitter);
    }

    const PosedScene& posed_;
    const PathFeatures& features_;
    unsigned threads_;
    std::vector<DrawFrame> frames_;
    std::vector<Source> sources_;
    std::vector<Box> boxes_;
    PathGeometry out_;
};

}  // namespace

PathGeometry make_path_geometry(const PosedScene& posed, const PathFeatures& features, const dvec3& origin,
                                unsigned threads)
{
    return Flattening(posed, features, origin, threads).run();
}

}  // namespace etalon
