#include "engine/scene/unseen.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>

#include "engine/math/transform.h"
#include "engine/scene/builder.h"
#include "engine/scene/texture_slots.h"

namespace etalon {
namespace {

/// Where a view looks, in camera space at unit depth (perspective) or at any (orthographic).
struct Film {
    bool orthographic = false;
    dvec2 half{1};   ///< to the sides of the picture
    dvec2 pixel{1};  ///< sides of one
};

/// `per_side`: pixels drawn along a side of one.
Film film_of(const View& view, int per_side = 1)
{
    const Camera& camera = view.camera;
    const double half = std::tan(camera.yfov / 2);
    Film film{
        .orthographic = camera.orthographic,
        .half = camera.orthographic ? dvec2(camera.xmag, camera.ymag) : dvec2(half * view.width / view.height, half)};
    film.pixel = 2.0 * film.half / (dvec2(view.width, view.height) * double(per_side));
    return film;
}

/// Least level over one triangle for one texel of the texture a unit of uv: λ for `texels` of area per unit of uv² is
/// this plus log2(texels) / 2. Nothing where the triangle is not seen or has no area.
std::optional<double> least_level(const Film& film, const std::array<dvec3, 3>& p, const std::array<dvec2, 3>& uv)
{
    const dvec3 normal = cross(p[1] - p[0], p[2] - p[0]);
    const double area = length(normal);
    const dvec2 a = uv[1] - uv[0], b = uv[2] - uv[0];
    const double uv_area = std::abs(a.x * b.y - a.y * b.x);
    if (!(area > 0) || !std::isfinite(area)) return std::nullopt;
    const double pixel = film.pixel.x * film.pixel.y;
    if (film.orthographic) return 0.5 * std::log2(uv_area / area * pixel);
    const double nearest = -std::max({p[0].z, p[1].z, p[2].z});
    // Through the eye's plane: as near as one likes.
    if (!(nearest > 0)) return -std::numeric_limits<double>::infinity();
    // 1/z is linear on the screen: pixels are shaded at their centre, which may lie 0.71 pixels beyond the edge.
    const double distance = std::abs(dot(normal, p[0]));
    const double slope = std::hypot(normal.x * film.pixel.x, normal.y * film.pixel.y) / distance;
    const double z = 1 / (1 / nearest + 0.71 * slope);
    const double cosine = 1 / std::sqrt(1 + dot(film.half, film.half));
    return 0.5 * std::log2(uv_area / area * pixel * z * z * cosine);
}

class LevelBounds {
    struct Bound {
        double level;
        std::string pointer;
    };

 public:
    LevelBounds(const PosedScene& posed, const Requirements& required, const RenderSettings& settings)
        : posed_(posed),
          required_(required),
          film_(film_of(posed.view, settings.ssaa)),
          all_have_levels_(settings.texture_filter != TextureFilter::file),
          anisotropy_(settings.anisotropy)
    {}

    void add(const Draw& draw)
    {
        const Primitive& primitive = posed_.primitive(draw);
        const Material& material = posed_.material(draw);
        const dmat4 camera_from_object = inverse_rigid(posed_.view.world_from_camera) * draw.world_from_object;
        std::map<int, double> of_set;
        for (const TextureSlot& slot : texture_slots()) {
            const TextureUse* const use = slot.of(material);
            if (use == nullptr || !use->present() || !required_.texture_used[use->texture]) continue;
            const Index image = posed_.scene->textures[use->texture].image;
            const auto set = static_cast<std::size_t>(use->uv_set);
            if (image == kNone) continue;
            double least = -std::numeric_limits<double>::infinity();
            const bool has_levels = all_have_levels_ || posed_.scene->textures[use->texture].sampler.mipmapped;
            if (has_levels && primitive.topology == Topology::triangles && !primitive.uv[set].empty()) {
                const auto [known, is_new] = of_set.try_emplace(use->uv_set, 0);
                if (is_new) known->second = least_of(primitive, set, camera_from_object);
                const double stretch = std::abs(glm::determinant(glm::dmat2(use->transform)));
                const Texels& texels = posed_.scene->images[image];
                least = known->second + 0.5 * std::log2(stretch * texels.width * texels.height);
            }
            const auto [bound, is_new] = bounds_.try_emplace(image, Bound{least, {}});
            if (is_new) bound->second.pointer = fmt::format("/materials/{}/{}", primitive.material, slot.where);
            bound->second.level = std::min(bound->second.level, least);
        }
    }

    std::vector<UnreadLevels> result() const
    {
        std::vector<UnreadLevels> out;
        for (const auto& [image, bound] : bounds_) {
            const Texels& texels = posed_.scene->images[image];
            const int last = static_cast<int>(std::log2(std::max(texels.width, texels.height)));
            // A hundredth of a level for what floats round.
            const double first = std::floor(bound.level - std::log2(double(anisotropy_)) - 0.01);
            const int level = static_cast<int>(std::clamp(first, 0.0, double(last)));
            if (level == 0) continue;
            UnreadLevels unread{.image = image, .pointer = bound.pointer, .first = level};
            for (int i = 0; i < level; ++i)
                unread.bytes +=
                    8 * std::uint64_t(std::max(texels.width >> i, 1)) * std::uint64_t(std::max(texels.height >> i, 1));
            out.push_back(unread);
        }
        return out;
    }

 private:
    static dmat4 inverse_rigid(const dmat4& m)
    {
        const dmat3 turned = glm::transpose(dmat3(m));
        dmat4 out(turned);
        out[3] = dvec4(-(turned * dvec3(m[3])), 1);
        return out;
    }

    double least_of(const Primitive& primitive, std::size_t set, const dmat4& camera_from_object) const
    {
        double least = std::numeric_limits<double>::infinity();
        for (std::size_t i = 0; i + 2 < primitive.indices.size(); i += 3) {
            std::array<dvec3, 3> p;
            std::array<dvec2, 3> uv;
            for (std::size_t k = 0; k < 3; ++k) {
                const std::uint32_t vertex = primitive.indices[i + k];
                p[k] = dvec3(camera_from_object * dvec4(dvec3(primitive.positions[vertex]), 1));
                uv[k] = dvec2(primitive.uv[set][vertex]);
            }
            if (const auto level = least_level(film_, p, uv)) least = std::min(least, *level);
        }
        return least;
    }

    const PosedScene& posed_;
    const Requirements& required_;
    const Film film_;
    const bool all_have_levels_;
    const int anisotropy_;
    std::map<Index, Bound> bounds_;  // by image
};

}  // namespace

bool is_outside(const View& view, const dmat4& world_from_object, const vec3& low, const vec3& high)
{
    const Film film = film_of(view);
    const dvec2 side = film.half + film.pixel;
    const dmat3 camera_from_world = glm::transpose(dmat3(view.world_from_camera));
    const dvec3 eye(view.world_from_camera[3]);
    std::array<bool, 5> beyond{true, true, true, true, true};
    for (int corner = 0; corner < 8; ++corner) {
        const dvec3 p(corner & 1 ? high.x : low.x, corner & 2 ? high.y : low.y, corner & 4 ? high.z : low.z);
        const dvec3 c = camera_from_world * (dvec3(world_from_object * dvec4(p, 1)) - eye);
        const dvec2 edge = film.orthographic ? side : -c.z * side;
        beyond[0] = beyond[0] && c.x > edge.x;
        beyond[1] = beyond[1] && -c.x > edge.x;
        beyond[2] = beyond[2] && c.y > edge.y;
        beyond[3] = beyond[3] && -c.y > edge.y;
        beyond[4] = beyond[4] && !film.orthographic && c.z > 0;
    }
    return std::any_of(beyond.begin(), beyond.end(), [](bool all) { return all; });
}

Unseen find_unseen(const PosedScene& posed, const Requirements& required, const RenderSettings& settings)
{
    Unseen out;
    LevelBounds levels(posed, required, settings);
    std::map<const Primitive*, std::pair<vec3, vec3>> boxes;
    for (const Draw& draw : posed.draws) {
        const Primitive& primitive = posed.primitive(draw);
        if (primitive.topology != Topology::triangles) {
            levels.add(draw);
            continue;
        }
        const auto [box, is_new] = boxes.try_emplace(&primitive);
        if (is_new) box->second = bounds(primitive);
        if (is_outside(posed.view, draw.world_from_object, box->second.first, box->second.second)) {
            ++out.draws;
            out.triangles += primitive.indices.size() / 3;
        } else {
            levels.add(draw);
        }
    }
    if (required.has(Feature::mipmaps)) out.levels = levels.result();
    return out;
}

}  // namespace etalon
