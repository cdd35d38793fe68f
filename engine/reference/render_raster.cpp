#include <algorithm>
#include <array>
#include <cmath>

#include "engine/base/error.h"
#include "engine/base/parallel.h"
#include "engine/reference/aov.h"
#include "engine/reference/raster_geometry.h"
#include "engine/reference/raster_shade.h"
#include "engine/reference/reference.h"

namespace etalon::reference {
namespace {

constexpr int kBandRows = 16;  // of the picture that one unit of work draws

/// Sample positions in a pixel: Vulkan's standard ones (Vulkan 1.3 §25.4), in 1/256 pixel.
std::vector<FixedPoint> sample_positions(int count)
{
    if (count == 4) return {{96, 32}, {224, 96}, {32, 160}, {160, 224}};
    return {{128, 128}};
}

dvec2 in_pixels(const FixedPoint& p)
{
    return dvec2(p.x, p.y) / static_cast<double>(kSubPixels);
}

/// Far enough for everything, for orthographic depth (TF-5).
double far_plane(const PosedScene& posed, const CameraRays& camera)
{
    double far = posed.view.camera.znear * 2 + 1;
    for (int corner = 0; corner < 8; ++corner) {
        const dvec3 p(corner & 1 ? posed.bounds_max.x : posed.bounds_min.x,
                      corner & 2 ? posed.bounds_max.y : posed.bounds_min.y,
                      corner & 4 ? posed.bounds_max.z : posed.bounds_min.z);
        far = std::max(far, camera.depth(p) * 1.001);
    }
    return far;
}

/// What is drawn in which order: opaque and masked objects as they come, then the transmitting ones, then the blended
/// ones, farthest first. (SH-32), (SH-65)
struct DrawList {
    std::vector<Piece> pieces;
    std::size_t first_transmitting = 0;  ///< from here on pieces may show what has been drawn before
    std::size_t first_blended = 0;       ///< from here on pieces blend and write no depth
    bool transmits = false;              ///< some piece does
};

const Material& material_of(const PosedScene& posed, std::uint32_t object)
{
    const std::size_t draws = posed.draws.size();
    return object < draws ? posed.material(posed.draws[object])
                          : posed.scene->materials[posed.spheres[object - draws].material];
}

bool blends(const PosedScene& posed, std::uint32_t object)
{
    return material_of(posed, object).alpha_mode == AlphaMode::blend;
}

/// Camera-space depth of the centre of an object's own box.
double sorting_depth(const PosedScene& posed, const CameraRays& camera, std::uint32_t object)
{
    if (object >= posed.draws.size()) return camera.depth(posed.spheres[object - posed.draws.size()].center);
    const Draw& draw = posed.draws[object];
    dvec3 low(1e300), high(-1e300);
    for (const vec3& p : posed.primitive(draw).positions) {
        low = glm::min(low, dvec3(p));
        high = glm::max(high, dvec3(p));
    }
    return camera.depth(dvec3(draw.world_from_object * dvec4(0.5 * (low + high), 1)));
}

DrawList make_draw_list(const PosedScene& posed, const RasterShader& shader)
{
    const CameraRays& camera = shader.camera();
    const auto count = static_cast<std::uint32_t>(posed.draws.size() + posed.spheres.size());
    std::vector<std::uint32_t> order(count);
    std::vector<double> depth(count, 0);
    for (std::uint32_t i = 0; i < count; ++i) {
        order[i] = i;
        if (blends(posed, i)) depth[i] = sorting_depth(posed, camera, i);
    }
    const auto middle =
        std::stable_partition(order.begin(), order.end(), [&](std::uint32_t i) { return !blends(posed, i); });
    const auto transmits = [&](std::uint32_t i) { return shader.transmits(material_of(posed, i)); };
    const auto second = std::stable_partition(order.begin(), middle, [&](std::uint32_t i) { return !transmits(i); });
    std::stable_sort(middle, order.end(), [&](std::uint32_t a, std::uint32_t b) { return depth[a] > depth[b]; });

    const dmat4 clip_from_camera = projection(posed.view, far_plane(posed, camera));
    DrawList list;
    list.transmits = std::any_of(second, order.end(), transmits);
    for (auto it = order.begin(); it != order.end(); ++it) {
        if (it == second) list.first_transmitting = list.pieces.size();
        if (it == middle) list.first_blended = list.pieces.size();
        if (*it < posed.draws.size()) {
            const std::vector<Piece> pieces = pieces_of_draw(posed, *it, clip_from_camera);
            list.pieces.insert(list.pieces.end(), pieces.begin(), pieces.end());
        } else if (const auto piece = piece_of_sphere(posed, *it - static_cast<std::uint32_t>(posed.draws.size()))) {
            list.pieces.push_back(*piece);
        }
    }
    if (second == order.end()) list.first_transmitting = list.pieces.size();
    if (middle == order.end()) list.first_blended = list.pieces.size();
    return list;
}

/// Some rows of the picture with all their samples.
class Band {
 public:
    Band(const World& world, const RasterShader& shader, int y0, int y1, int samples)
        : world_(&world),
          posed_(world.posed),
          shader_(&shader),
          y0_(y0),
          y1_(y1),
          far_(far_plane(*world.posed, shader.camera())),
          positions_(sample_positions(samples))
    {
        const auto count =
            static_cast<std::size_t>(posed_->view.width) * static_cast<std::size_t>(y1 - y0) * positions_.size();
        color_.reserve(count);
        for (int y = y0; y < y1; ++y)
            for (int x = 0; x < posed_->view.width; ++x) {
                const Shaded back = shader.background({x + 0.5, y + 0.5});
                color_.insert(color_.end(), positions_.size(), dvec4(back.radiance, back.alpha));
            }
        depth_.assign(count, 0);  // reversed: 0 is infinitely far
    }

    /// What transmitting pieces show from now on.
    void set_behind(const PictureBehind* behind) { behind_ = behind; }

    void draw(const Piece& piece, bool blend)
    {
        const bool sphere = piece.object >= posed_->draws.size();
        for (int y = std::max(piece.y0, y0_); y < std::min(piece.y1, y1_); ++y)
            for (int x = piece.x0; x < piece.x1; ++x)
                sphere ? draw_sphere(piece, x, y, blend) : draw_triangle(piece, x, y, blend);
    }

    /// Mean of the samples (SH-30): radiance and coverage.
    dvec4 resolve(int x, int y) const
    {
        dvec4 sum(0);
        for (std::size_t s = 0; s < positions_.size(); ++s) sum += color_[at(x, y) + s];
        return sum / static_cast<double>(positions_.size());
    }

    /// The same of what has been drawn, without the background: premultiplied.
    dvec4 resolve_drawn(int x, int y) const
    {
        dvec4 sum(0);
        for (std::size_t s = 0; s < positions_.size(); ++s)
            if (depth_[at(x, y) + s] > 0) sum += color_[at(x, y) + s];
        return sum / static_cast<double>(positions_.size());
    }

 private:
    std::size_t at(int x, int y) const
    {
        return (static_cast<std::size_t>(y - y0_) * static_cast<std::size_t>(posed_->view.width) +
                static_cast<std::size_t>(x)) *
               positions_.size();
    }

    FixedPoint sample_point(int x, int y, std::size_t s) const
    {
        return {x * kSubPixels + positions_[s].x, y * kSubPixels + positions_[s].y};
    }

    void draw_triangle(const Piece& piece, int x, int y, bool blend);
    void draw_sphere(const Piece& piece, int x, int y, bool blend);
    std::optional<Fragment> triangle_fragment(const Piece& piece, int x, int y, const FixedPoint& covered) const;
    double depth_of(double distance) const;
    void write(int x, int y, const std::array<double, 4>& depth, const Fragment& fragment, bool blend);

    const World* world_;
    const PosedScene* posed_;
    const RasterShader* shader_;
    const PictureBehind* behind_ = nullptr;
    int y0_, y1_;
    double far_;
    std::vector<FixedPoint> positions_;
    std::vector<dvec4> color_;
    std::vector<double> depth_;
};

constexpr double kUncovered = -1;

void Band::draw_triangle(const Piece& piece, int x, int y, bool blend)
{
    const std::array<FixedPoint, 3> corners{piece.v[0].snapped, piece.v[1].snapped, piece.v[2].snapped};
    std::array<double, 4> depth;
    depth.fill(kUncovered);
    std::optional<FixedPoint> first;
    for (std::size_t s = 0; s < positions_.size(); ++s) {
        const FixedPoint p = sample_point(x, y, s);
        if (!covers(corners, p)) continue;
        const double z = depth_at(piece, in_pixels(p));
        if (!(z > depth_[at(x, y) + s])) continue;
        depth[s] = z;
        if (!first) first = p;
    }
    if (!first) return;
    if (const auto fragment = triangle_fragment(piece, x, y, *first)) write(x, y, depth, *fragment, blend);
}

// Attributes at the pixel's centre, even where that lies outside (SH-30); where the triangle's plane does not reach the
// centre, at a sample that it covers.
std::optional<Fragment> Band::triangle_fragment(const Piece& piece, int x, int y, const FixedPoint& covered) const
{
    Interpolation at = interpolate(piece, {x + 0.5, y + 0.5});
    if (!at.valid) at = interpolate(piece, in_pixels(covered));
    if (!at.valid) return std::nullopt;
    const Draw& draw = posed_->draws[piece.object];
    const Primitive& primitive = posed_->primitive(draw);
    const World::Frame& frame = world_->frames[piece.object];
    const auto corner = [&](std::size_t i) {
        return dvec3(draw.world_from_object * dvec4(dvec3(primitive.positions[piece.vertices[i]]), 1));
    };
    const dvec3 p0 = corner(0), p1 = corner(1), p2 = corner(2);
    Fragment out;
    out.material = &posed_->material(draw);
    out.attributes = interpolate(primitive, frame, piece.vertices, at.b.x, at.b.y);
    out.position = p0 + at.b.x * (p1 - p0) + at.b.y * (p2 - p0);
    out.object = piece.object;
    out.film = {x + 0.5, y + 0.5};
    const dmat3 m(draw.world_from_object);
    out.scale = std::cbrt(std::abs(dot(cross(m[0], m[1]), m[2])));
    out.front = piece.front;
    TexturePoint& texture = out.attributes.at;
    texture.has_footprint = true;
    for (std::size_t set = 0; set < 2; ++set) {
        if (primitive.uv[set].empty()) continue;
        const dvec2 uv0(primitive.uv[set][piece.vertices[0]]);
        const dvec2 e1 = dvec2(primitive.uv[set][piece.vertices[1]]) - uv0,
                    e2 = dvec2(primitive.uv[set][piece.vertices[2]]) - uv0;
        texture.uv_dx[set] = at.b_dx.x * e1 + at.b_dx.y * e2;
        texture.uv_dy[set] = at.b_dy.x * e1 + at.b_dy.y * e2;
    }
    if (primitive.topology == Topology::triangles)
        out.ng = geometric_normal(Shape{.p0 = p0, .p1 = p1, .p2 = p2, .mirrored = frame.handedness < 0}, p0);
    else
        out.is_lit = out.attributes.normal != dvec3(0);
    return out;
}

/// Where a camera ray meets a sphere that a rasterizer draws: beyond the near plane, the back only where it is not
/// culled.
struct SphereMeeting {
    double t = 0;
    bool front = true;
};

std::optional<SphereMeeting> meet(const PosedScene& posed, const PosedSphere& sphere, const CameraRays& camera,
                                  const Ray& ray)
{
    const Material& m = posed.scene->materials[sphere.material];
    const bool cull = !m.double_sided && !is_dielectric(m.model);
    const SphereHits hits = intersect_sphere(ray, sphere.center, sphere.radius);
    for (int i = 0; i < hits.count; ++i) {
        const double t = hits.t[static_cast<std::size_t>(i)];
        const dvec3 p = ray.origin + t * ray.direction;
        if (camera.depth(p) < posed.view.camera.znear) continue;
        const bool front = dot(p - sphere.center, ray.direction) < 0;
        if (front || !cull) return SphereMeeting{t, front};
    }
    return std::nullopt;
}

double Band::depth_of(double distance) const
{
    const double near = posed_->view.camera.znear;
    if (posed_->view.camera.orthographic) return (far_ - distance) / (far_ - near);
    return near / distance;
}

void Band::draw_sphere(const Piece& piece, int x, int y, bool blend)
{
    const PosedSphere& sphere = posed_->spheres[piece.object - posed_->draws.size()];
    const CameraRays& camera = shader_->camera();
    std::array<bool, 4> covered{};
    bool any = false;
    for (std::size_t s = 0; s < positions_.size(); ++s)
        any |= covered[s] = meet(*posed_, sphere, camera, camera.pinhole(in_pixels(sample_point(x, y, s)))).has_value();
    if (!any) return;

    Fragment fragment;
    fragment.material = &posed_->scene->materials[sphere.material];
    fragment.object = piece.object;
    fragment.film = {x + 0.5, y + 0.5};
    fragment.scale = sphere.radius / posed_->scene->nodes[sphere.node].sphere->radius;
    const Ray ray = camera.pinhole({x + 0.5, y + 0.5});
    double distance;
    if (const auto at = meet(*posed_, sphere, camera, ray)) {
        const dvec3 p = ray.origin + at->t * ray.direction;
        fragment.ng = normalize(p - sphere.center);
        fragment.front = at->front;
        distance = camera.depth(p);
    } else {  // the centre just misses: the silhouette nearest to it
        const dvec3 nearest = ray.origin + dot(sphere.center - ray.origin, ray.direction) * ray.direction;
        fragment.ng = normalize(nearest - sphere.center);
        distance = camera.depth(nearest);
    }
    fragment.position = sphere.center + sphere.radius * fragment.ng;
    const double z = depth_of(distance);
    std::array<double, 4> depth;
    depth.fill(kUncovered);
    any = false;
    for (std::size_t s = 0; s < positions_.size(); ++s)
        if (covered[s] && z > depth_[at(x, y) + s]) depth[s] = z, any = true;
    if (any) write(x, y, depth, fragment, blend);
}

void Band::write(int x, int y, const std::array<double, 4>& depth, const Fragment& fragment, bool blend)
{
    const auto shaded = shader_->shade(fragment, behind_);
    if (!shaded) return;
    for (std::size_t s = 0; s < positions_.size(); ++s) {
        if (depth[s] == kUncovered) continue;
        dvec4& color = color_[at(x, y) + s];
        if (blend) {
            color = dvec4(shaded->radiance, 1) * shaded->alpha + color * (1 - shaded->alpha);
        } else {
            color = dvec4(shaded->radiance, 1);
            depth_[at(x, y) + s] = depth[s];
        }
    }
}

/// Of the rows of band `b`: column, row, index in the film.
template <class Visit>
void for_each_pixel(std::size_t b, int width, int height, Visit&& visit)
{
    const int y0 = static_cast<int>(b) * kBandRows;
    for (int y = y0; y < std::min(height, y0 + kBandRows); ++y)
        for (int x = 0; x < width; ++x)
            visit(x, y, static_cast<std::size_t>(y) * static_cast<std::size_t>(width) + static_cast<std::size_t>(x));
}

}  // namespace

Film render_raster(const PosedScene& posed, const Requirements& required, const RenderSettings& settings,
                   const Progress& progress)
{
    assume(posed.scene != nullptr && posed.view.width > 0 && posed.view.height > 0);
    if (settings.msaa != 1 && settings.msaa != 4)
        throw Error(Blame::input,
                    "the rasterizer takes 1 or 4 samples per pixel, not " + std::to_string(settings.msaa));
    progress.report({.stage = "decoding textures", .fraction = 0, .error = {}, .samples = {}});
    const World world(posed, required.texture_used, settings.mipmaps);
    const RasterShader shader(world, settings);
    const DrawList list = make_draw_list(posed, shader);

    const int width = posed.view.width, height = posed.view.height;
    const auto count = static_cast<std::size_t>((height + kBandRows - 1) / kBandRows);
    std::vector<std::vector<std::uint32_t>> by_band(count);
    for (std::uint32_t i = 0; i < list.pieces.size(); ++i) {
        const Piece& piece = list.pieces[i];
        for (int b = piece.y0 / kBandRows; b * kBandRows < piece.y1; ++b)
            by_band[static_cast<std::size_t>(b)].push_back(i);
    }

    Film film;
    film.width = width;
    film.height = height;
    film.samples = static_cast<std::uint64_t>(settings.msaa);
    film.mean.assign(film.pixel_count(), vec3(0));
    film.alpha.assign(film.pixel_count(), 0);
    std::vector<std::uint64_t> nonfinite(count, 0);
    const auto finish = [&](std::size_t b, Band& band, const PictureBehind* behind) {
        band.set_behind(behind);
        for (const std::uint32_t i : by_band[b])
            if (i >= list.first_transmitting) band.draw(list.pieces[i], i >= list.first_blended);
        for_each_pixel(b, width, height, [&](int x, int y, std::size_t at) {
            const dvec4 pixel = band.resolve(x, y);
            film.mean[at] = vec3(pixel);
            film.alpha[at] = static_cast<float>(pixel.w);
            if (!is_finite(dvec3(pixel))) ++nonfinite[b];
        });
    };
    const auto start = [&](std::size_t b) {
        const int y0 = static_cast<int>(b) * kBandRows, y1 = std::min(height, y0 + kBandRows);
        Band band(world, shader, y0, y1, settings.msaa);
        for (const std::uint32_t i : by_band[b])
            if (i < list.first_transmitting) band.draw(list.pieces[i], false);
        return band;
    };
    const auto over_bands = [&](auto&& work) {
        parallel_for(
            count,
            [&](std::size_t b) {
                if (!progress.stopped()) work(b);
            },
            settings.threads);
    };
    if (!list.transmits) {
        over_bands([&](std::size_t b) {
            Band band = start(b);
            finish(b, band, nullptr);
        });
    } else {
        std::vector<std::optional<Band>> bands(count);
        std::vector<dvec4> drawn(film.pixel_count(), dvec4(0));
        over_bands([&](std::size_t b) {
            bands[b].emplace(start(b));
            for_each_pixel(b, width, height,
                           [&](int x, int y, std::size_t at) { drawn[at] = bands[b]->resolve_drawn(x, y); });
        });
        const PictureBehind behind({width, height}, std::move(drawn));
        over_bands([&](std::size_t b) {
            if (bands[b]) finish(b, *bands[b], &behind);
        });
    }
    for (const std::uint64_t n : nonfinite) film.nonfinite += n;
    if (settings.aovs) film.aovs = render_aovs(world, shader.camera(), true, settings.threads);
    progress.report({.stage = "rasterizing", .fraction = 1, .error = {}, .samples = {}});
    return film;
}

}  // namespace etalon::reference
