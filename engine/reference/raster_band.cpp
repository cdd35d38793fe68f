#include "engine/reference/raster_band.h"

#include <algorithm>
#include <cmath>

#include "engine/base/error.h"

namespace etalon::reference {
namespace {

constexpr double kUncovered = -2;  // below every depth

/// Sample positions in a pixel: Vulkan's standard ones (Vulkan 1.3, "Multisampling"), there in 1/16, here in 1/256
/// pixel.
std::vector<FixedPoint> sample_positions(int count)
{
    std::vector<FixedPoint> positions;
    switch (count) {
        case 1:
            positions = {{8, 8}};
            break;
        case 2:
            positions = {{12, 12}, {4, 4}};
            break;
        case 4:
            positions = {{6, 2}, {14, 6}, {2, 10}, {10, 14}};
            break;
        case 8:
            positions = {{9, 5}, {7, 11}, {13, 9}, {5, 3}, {3, 13}, {1, 7}, {11, 15}, {15, 1}};
            break;
        case 16:
            positions = {{9, 9},  {7, 5}, {5, 10}, {12, 7}, {3, 6}, {10, 13}, {13, 11}, {11, 3},
                         {6, 14}, {8, 1}, {4, 2},  {2, 12}, {0, 8}, {15, 4},  {14, 15}, {1, 0}};
            break;
        default:
            assume(false);
    }
    for (FixedPoint& p : positions) p = {p.x * kSubPixels / 16, p.y * kSubPixels / 16};
    return positions;
}

dvec2 in_pixels(const FixedPoint& p)
{
    return dvec2(p.x, p.y) / static_cast<double>(kSubPixels);
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
    const Material& m = posed.materials()[sphere.material];
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

}  // namespace

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

namespace {

double forward_far_plane(const PosedScene& posed, const CameraRays& camera)
{
    double far = 2 * posed.view.camera.znear;
    for (int corner = 0; corner < 8; ++corner) {
        const dvec3 p(corner & 1 ? posed.bounds_max.x : posed.bounds_min.x,
                      corner & 2 ? posed.bounds_max.y : posed.bounds_min.y,
                      corner & 4 ? posed.bounds_max.z : posed.bounds_min.z);
        far = std::max(far, 1.01 * camera.depth(p));
    }
    return far;
}

}  // namespace

Band::Band(const World& world, const RasterShader& shader, int y0, int y1, const RenderSettings& settings)
    : world_(&world),
      posed_(world.posed),
      shader_(&shader),
      y0_(y0),
      y1_(y1),
      far_(far_plane(*world.posed, shader.camera())),
      kind_(settings.depth),
      forward_far_(forward_far_plane(*world.posed, shader.camera())),
      positions_(sample_positions(settings.msaa))
{
    const auto count =
        static_cast<std::size_t>(posed_->view.width) * static_cast<std::size_t>(y1 - y0) * positions_.size();
    color_.reserve(count);
    for (int y = y0; y < y1; ++y)
        for (int x = 0; x < posed_->view.width; ++x) {
            const Shaded back = shader.background({x + 0.5, y + 0.5});
            color_.insert(color_.end(), positions_.size(), dvec4(back.radiance, back.alpha));
        }
    depth_.assign(count, kind_ == DepthKind::reversed_32 ? 0 : -1);  // what nothing is behind
}

void Band::draw(const Piece& piece, bool blend)
{
    const bool sphere = piece.object >= posed_->draws.size();
    for (int y = std::max(piece.y0, y0_); y < std::min(piece.y1, y1_); ++y)
        for (int x = piece.x0; x < piece.x1; ++x)
            sphere ? draw_sphere(piece, x, y, blend) : draw_triangle(piece, x, y, blend);
}

dvec4 Band::resolve(int x, int y) const
{
    dvec4 sum(0);
    for (std::size_t s = 0; s < positions_.size(); ++s) sum += color_[at(x, y) + s];
    return sum / static_cast<double>(positions_.size());
}

dvec4 Band::resolve_drawn(int x, int y) const
{
    dvec4 sum(0);
    for (std::size_t s = 0; s < positions_.size(); ++s)
        if (depth_[at(x, y) + s] > (kind_ == DepthKind::reversed_32 ? 0 : -1)) sum += color_[at(x, y) + s];
    return sum / static_cast<double>(positions_.size());
}

void Band::draw_triangle(const Piece& piece, int x, int y, bool blend)
{
    const std::array<FixedPoint, 3> corners{piece.v[0].snapped, piece.v[1].snapped, piece.v[2].snapped};
    SampleDepths depth;
    depth.fill(kUncovered);
    std::optional<FixedPoint> first;
    for (std::size_t s = 0; s < positions_.size(); ++s) {
        const FixedPoint p = sample_point(x, y, s);
        if (!covers(corners, p)) continue;
        const double z = kept(depth_at(piece, in_pixels(p)));
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

double Band::depth_of(double distance) const
{
    const double near = posed_->view.camera.znear;
    if (posed_->view.camera.orthographic) return (far_ - distance) / (far_ - near);
    return near / distance;
}

// Forward depth is 1 - reversed depth, but for where it ends; negated, so that nearer is greater in all kinds.
double Band::kept(double reversed) const
{
    if (kind_ == DepthKind::reversed_32) return reversed;
    const Camera& camera = posed_->view.camera;
    const double near = camera.znear;
    const double distance = camera.orthographic ? far_ - reversed * (far_ - near) : near / reversed;
    const double forward = camera.orthographic ? (distance - near) / (forward_far_ - near)
                                               : forward_far_ / (forward_far_ - near) * (1 - near / distance);
    const double z = std::clamp(forward, 0.0, 1.0);
    if (kind_ == DepthKind::forward_32) return -static_cast<double>(static_cast<float>(z));
    const double steps = kind_ == DepthKind::forward_24 ? (1 << 24) - 1 : (1 << 16) - 1;
    return -std::round(z * steps) / steps;
}

void Band::draw_sphere(const Piece& piece, int x, int y, bool blend)
{
    const PosedSphere& sphere = posed_->spheres[piece.object - posed_->draws.size()];
    const CameraRays& camera = shader_->camera();
    std::array<bool, kMostSamples> covered{};
    bool any = false;
    for (std::size_t s = 0; s < positions_.size(); ++s)
        any |= covered[s] = meet(*posed_, sphere, camera, camera.pinhole(in_pixels(sample_point(x, y, s)))).has_value();
    if (!any) return;

    Fragment fragment;
    fragment.material = &posed_->materials()[sphere.material];
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
    const double z = kept(depth_of(distance));
    SampleDepths depth;
    depth.fill(kUncovered);
    any = false;
    for (std::size_t s = 0; s < positions_.size(); ++s)
        if (covered[s] && z > depth_[at(x, y) + s]) depth[s] = z, any = true;
    if (any) write(x, y, depth, fragment, blend);
}

void Band::write(int x, int y, const SampleDepths& depth, const Fragment& fragment, bool blend)
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

}  // namespace etalon::reference
