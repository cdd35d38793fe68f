#include "engine/reference/surface.h"

#include "engine/reference/layers_point.h"

#include <cmath>

namespace etalon::reference {
namespace {

constexpr double kUnit = std::numeric_limits<double>::epsilon() / 2;
constexpr double kSmallestAlpha = 1e-4;  // exact models below it: D overflows long before it matters (S7)

dvec3 normalized_or(const dvec3& v, const dvec3& otherwise)
{
    const double size = length(v);
    return size > 0 && std::isfinite(size) ? v / size : otherwise;
}

template <class Vector>
auto weigh(const std::vector<Vector>& values, const std::array<std::uint32_t, 3>& v, double b1, double b2)
{
    using Wide = glm::vec<Vector::length(), double, glm::defaultp>;
    const Wide a0(values[v[0]]), a1(values[v[1]]), a2(values[v[2]]);
    return a0 + b1 * (a1 - a0) + b2 * (a2 - a0);  // (TR-4), so that a constant stays constant
}

World::Frame frame_of(const dmat4& world_from_object)
{
    World::Frame frame;
    const dmat3 m(world_from_object);
    frame.world_from_object = m;
    frame.handedness = glm::determinant(m) < 0 ? -1 : 1;
    frame.normal_from_object = frame.handedness * dmat3(cross(m[1], m[2]), cross(m[2], m[0]), cross(m[0], m[1]));
    return frame;
}

}  // namespace

bool is_exact_model(BsdfModel model)
{
    return model != BsdfModel::metallic_roughness && model != BsdfModel::specular_glossiness &&
           model != BsdfModel::unlit;
}

bool is_layered(const Material& material)
{
    return material.model == BsdfModel::specular_glossiness ||
           (material.model == BsdfModel::metallic_roughness && material.layers);
}

bool is_body(const Material& material)
{
    return is_layered(material) && material.layers && material.layers->volumetric();
}

bool is_dielectric(BsdfModel model)
{
    return model == BsdfModel::dielectric || model == BsdfModel::rough_dielectric;
}

namespace {

// (SH-53) E for the alphas that a scene's materials can have.
ShareTable ggx_share_of(const Scene& scene)
{
    dvec2 used(1, 0);
    for (const Material& m : scene.materials) {
        if (m.model != BsdfModel::metallic_roughness && m.model != BsdfModel::specular_glossiness) continue;
        dvec2 roughness(m.roughness);
        if (m.metallic_roughness_texture.present())
            (m.model == BsdfModel::metallic_roughness ? roughness.x : roughness.y) =
                m.model == BsdfModel::metallic_roughness ? 0 : 1;
        dvec2 alpha = glm::max(roughness * roughness, dvec2(kSmallestMicrofacetAlpha));
        if (m.layers && m.layers->anisotropy > 0) alpha.y = std::sqrt(alpha.y);  // of α and at most 1 (SH-52)
        used = {std::min(used.x, alpha.x), std::max(used.y, alpha.y)};
    }
    return used.x > used.y ? ShareTable() : ShareTable(kGgxShare, used);
}

// (SH-61) E_s likewise.
ShareTable sheen_share_of(const Scene& scene)
{
    dvec2 used(1, 0);
    for (const Material& m : scene.materials) {
        if (!m.layers || m.layers->sheen_color == dvec3(0)) continue;
        const double highest = sheen_alpha(m.layers->sheen_roughness);
        used.x = std::min(used.x, m.layers->sheen_roughness_texture.present() ? sheen_alpha(0) : highest);
        used.y = std::max(used.y, highest);
    }
    return used.x > used.y ? ShareTable() : ShareTable(kSheenShare, used);
}

}  // namespace

World::World(const PosedScene& p, const std::vector<bool>& textures_used, bool mipmaps)
    : posed(&p), index(p), textures(*p.scene, textures_used, mipmaps)
{
    if (!mipmaps) {
        ggx_share = ggx_share_of(*p.scene);
        sheen_share = sheen_share_of(*p.scene);
    }
    for (const Draw& draw : p.draws) frames.push_back(frame_of(draw.world_from_object));
    for (const Material& m : p.materials())
        always_opaque.push_back(m.alpha_mode == AlphaMode::opaque &&
                                (m.double_sided || is_exact_model(m.model) || is_body(m)));
}

Attributes interpolate(const Primitive& primitive, const World::Frame& frame, const std::array<std::uint32_t, 3>& v,
                       double b1, double b2)
{
    Attributes out;
    if (primitive.has_normals && !primitive.normals.empty())
        out.normal = frame.normal_from_object * weigh(primitive.normals, v, b1, b2);
    if (!primitive.tangents.empty()) {
        const dvec4 t = weigh(primitive.tangents, v, b1, b2);
        const double sign = primitive.tangents[v[0]].w < 0 ? -1 : 1;  // w is constant over a triangle
        out.tangent = dvec4(frame.world_from_object * dvec3(t), sign * frame.handedness);
    }
    for (std::size_t set = 0; set < 2; ++set)
        if (!primitive.uv[set].empty()) out.at.uv[set] = weigh(primitive.uv[set], v, b1, b2);
    if (!primitive.colors.empty()) out.color = weigh(primitive.colors, v, b1, b2);
    return out;
}

MaterialPoint evaluate(const Material& m, const TextureSet& textures, const Attributes& attributes)
{
    MaterialPoint out;
    const dvec4 base =
        m.base_color * attributes.color * textures.sample(m.base_color_texture, Coding::srgb, attributes.at);
    out.color = dvec3(base);
    out.alpha = m.alpha_mode == AlphaMode::opaque ? 1 : base.w;
    if (m.model == BsdfModel::specular_glossiness) {  // (SH-50)
        const dvec4 texel = textures.sample(m.metallic_roughness_texture, Coding::srgb, attributes.at);
        out.specular = m.k * dvec3(texel);
        out.roughness = 1 - (1 - m.roughness) * texel.w;
    } else {
        const dvec4 texel = textures.sample(m.metallic_roughness_texture, Coding::linear, attributes.at);
        out.metallic = m.metallic * texel.z;
        out.roughness = m.roughness * texel.y;
    }
    if (m.occlusion_texture.present())
        out.occlusion =
            1 + m.occlusion_strength * (textures.sample(m.occlusion_texture, Coding::linear, attributes.at).x - 1);
    if (m.model == BsdfModel::unlit)
        out.emission = out.color;
    else if (m.emission != dvec3(0))
        out.emission = m.emission * dvec3(textures.sample(m.emissive_texture, Coding::srgb, attributes.at));
    return out;
}

dvec3 mapped_normal(const TextureUse& map, double scale, const TextureSet& textures, const Attributes& attributes,
                    const dvec3& ng)
{
    const dvec3 n = normalized_or(attributes.normal, ng);
    if (!map.present() || attributes.tangent.w == 0) return n;
    const dvec3 texel = 2.0 * dvec3(textures.sample(map, attributes.at.has_footprint ? Coding::normal : Coding::linear,
                                                    attributes.at)) -
                        1.0;
    const dvec3 t = normalized_or(dvec3(attributes.tangent), dvec3(0));
    const dvec3 b = cross(n, t) * attributes.tangent.w;
    return normalized_or(scale * (texel.x * t + texel.y * b) + texel.z * n, n);
}

dvec3 shading_normal(const Material& m, const TextureSet& textures, const Attributes& attributes, const dvec3& ng)
{
    return mapped_normal(m.normal_texture, m.normal_scale, textures, attributes, ng);
}

Bsdf bsdf_of(const Material& m, const MaterialPoint& point, bool front)
{
    Bsdf bsdf;
    bsdf.model = m.model;
    bsdf.color = point.color;
    switch (m.model) {
        case BsdfModel::metallic_roughness:  // (SH-14)
            bsdf.color = point.color * (1 - point.metallic);
            bsdf.f0 = dvec3(0.04) + point.metallic * (point.color - dvec3(0.04));
            bsdf.alpha = std::max(point.roughness * point.roughness, kSmallestMicrofacetAlpha);
            break;
        case BsdfModel::rough_conductor:
            bsdf.eta = m.eta;
            bsdf.k = m.k;
            bsdf.alpha = std::max(m.ggx_alpha, kSmallestAlpha);
            break;
        case BsdfModel::dielectric:
        case BsdfModel::rough_dielectric:
            bsdf.ior = front ? m.eta.x : 1 / m.eta.x;
            bsdf.alpha = std::max(m.ggx_alpha, kSmallestAlpha);
            break;
        default:
            break;
    }
    return bsdf;
}

namespace {

Attributes attributes_at(const World& world, const Shape& shape, const Hit& hit)
{
    if (shape.is_sphere()) return {};
    const Primitive& primitive = world.posed->primitive(world.posed->draws[shape.object]);
    const std::uint32_t* i = primitive.indices.data() + std::size_t{3} * shape.element;
    return interpolate(primitive, world.frames[shape.object], {i[0], i[1], i[2]}, hit.b1, hit.b2);
}

// Position from the shape, not along the ray: its error does not grow with the distance travelled (promise G23).
void place(Surface& surface, const Shape& shape, const Ray& ray, const Hit& hit)
{
    if (shape.is_sphere()) {
        const dvec3 towards = normalize(ray.origin + hit.t * ray.direction - shape.p0);
        surface.position = shape.p0 + shape.p1.x * towards;
        surface.error = 8 * kUnit * (glm::abs(shape.p0) + dvec3(2 * shape.p1.x));
        return;
    }
    const double b0 = 1 - hit.b1 - hit.b2;
    const dvec3 x0 = b0 * shape.p0, x1 = hit.b1 * shape.p1, x2 = hit.b2 * shape.p2;
    surface.position = x0 + x1 + x2;
    // γ₇ of PBRT 4th ed. §6.8, and the rounding of b0.
    surface.error = 10 * kUnit * (glm::abs(x0) + glm::abs(x1) + glm::abs(x2) + glm::abs(shape.p0));
}

}  // namespace

Surface surface_at(const World& world, const Ray& ray, const Hit& hit)
{
    const Shape& shape = world.index.shapes()[hit.shape];
    const Material& material = world.material(shape);
    const dvec3 wo = -normalize(ray.direction);
    Surface s;
    s.object = shape.object;
    s.material = shape.material;
    place(s, shape, ray, hit);
    s.attributes = attributes_at(world, shape, hit);
    s.point = evaluate(material, world.textures, s.attributes);
    s.ng = geometric_normal(shape, s.position);
    s.n = shading_normal(material, world.textures, s.attributes, s.ng);
    s.front = dot(s.ng, wo) > 0;  // (SH-3)
    if (!s.front) {
        s.ng = -s.ng;
        s.n = -s.n;
    }
    if (dot(s.n, wo) <= 0) s.n = s.ng;  // (SH-4)
    const bool emits = s.front || (material.double_sided && !material.emits_front_only);
    if (emits || material.model == BsdfModel::unlit) s.emission = s.point.emission;
    s.frame = ShadingFrame(s.n);
    const bool black_back =
        !s.front && !material.double_sided && !is_dielectric(material.model) && !is_body(material);  // (SH-6), (SH-63)
    if (is_layered(material)) {
        set_layered_bsdf(s, world, material, wo);
        s.is_black = black_back;
        return s;
    }
    s.bsdf = bsdf_of(material, s.point, s.front);
    s.bsdf.energy = &world.ggx_share;
    s.is_black = black_back || s.bsdf.is_black();
    return s;
}

dvec3 emission_at(const World& world, const Ray& ray, const Hit& hit)
{
    const Shape& shape = world.index.shapes()[hit.shape];
    const Material& m = world.material(shape);
    const dvec3 ng = geometric_normal(shape, ray.origin + hit.t * ray.direction);
    const bool front = dot(ng, ray.direction) < 0;
    if (!front && (!m.double_sided || m.emits_front_only)) return dvec3(0);
    const bool coated = is_layered(m) && m.layers && m.layers->clearcoat > 0;
    if (!m.emissive_texture.present() && !coated) return m.emission;
    const Attributes attributes = attributes_at(world, shape, hit);
    const dvec3 emission = m.emission * dvec3(world.textures.sample(m.emissive_texture, Coding::srgb, attributes.at));
    if (!coated) return emission;
    return emission * (1 - coat_at(m, world.textures, attributes, ng, -normalize(ray.direction)).weight);  // (SH-62)
}

double opacity(const World& world, const Ray& ray, const Hit& hit, bool cull_all)
{
    const Shape& shape = world.index.shapes()[hit.shape];
    if (world.always_opaque[shape.material] && !cull_all) return 1;
    const Material& m = world.material(shape);
    const bool passes_back =
        !m.double_sided && (cull_all ? !is_dielectric(m.model) : !is_exact_model(m.model) && !is_body(m));
    if (passes_back) {
        const dvec3 ng = geometric_normal(shape, ray.origin + hit.t * ray.direction);
        if (!(dot(ng, ray.direction) < 0)) return 0;
    }
    if (m.alpha_mode == AlphaMode::opaque) return 1;
    const Attributes attributes = attributes_at(world, shape, hit);
    const double alpha =
        (m.base_color * attributes.color * world.textures.sample(m.base_color_texture, Coding::srgb, attributes.at)).w;
    if (m.alpha_mode == AlphaMode::mask) return alpha < m.alpha_cutoff ? 0 : 1;
    return std::clamp(alpha, 0.0, 1.0);
}

}  // namespace etalon::reference
