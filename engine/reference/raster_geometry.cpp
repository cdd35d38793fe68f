#include "engine/reference/raster_geometry.h"

#include <algorithm>
#include <cmath>

namespace etalon::reference {
namespace {

// Half a guard band in pixels: coordinates stay below 2^20 pixels, edge functions below 2^59.
constexpr double kGuard = 1 << 20;

dvec4 mix(const dvec4& a, const dvec4& b, double t)
{
    return a + t * (b - a);
}

// Sutherland & Hodgman 1974 against one plane; `distance` ≥ 0 is inside.
template <class Distance>
std::vector<ClipVertex> clip_against(const std::vector<ClipVertex>& polygon, Distance&& distance)
{
    std::vector<ClipVertex> kept;
    for (std::size_t i = 0; i < polygon.size(); ++i) {
        const ClipVertex& a = polygon[i];
        const ClipVertex& b = polygon[(i + 1) % polygon.size()];
        const double da = distance(a.position), db = distance(b.position);
        if (da >= 0) kept.push_back(a);
        if ((da >= 0) == (db >= 0)) continue;
        // Always from the inner end, so that the neighbour across this edge computes the same bits.
        const ClipVertex& in = da >= 0 ? a : b;
        const ClipVertex& out = da >= 0 ? b : a;
        const double d_in = std::max(da, db), d_out = std::min(da, db);
        const double t = d_in / (d_in - d_out);
        kept.push_back({mix(in.position, out.position, t), in.b + t * (out.b - in.b)});
    }
    return kept;
}

ScreenVertex project(const ClipVertex& vertex, const View& view)
{
    ScreenVertex out;
    out.inverse_w = 1 / vertex.position.w;
    const dvec3 ndc = dvec3(vertex.position) * out.inverse_w;
    out.pixel = {(ndc.x + 1) / 2 * view.width, (ndc.y + 1) / 2 * view.height};  // (TF-6)
    out.snapped = {std::llround(out.pixel.x * kSubPixels), std::llround(out.pixel.y * kSubPixels)};
    out.depth = ndc.z;
    out.b = vertex.b;
    return out;
}

// Twice the area on the unsnapped film.
double area(const Piece& p)
{
    const dvec2 a = p.v[1].pixel - p.v[0].pixel, b = p.v[2].pixel - p.v[0].pixel;
    return a.x * b.y - a.y * b.x;
}

void bound(Piece& piece, const View& view)
{
    dvec2 low(1e30), high(-1e30);
    for (const ScreenVertex& v : piece.v) {
        low = glm::min(low, v.pixel);
        high = glm::max(high, v.pixel);
    }
    const auto limit = [](double x, int size) {
        return static_cast<int>(std::clamp(x, 0.0, static_cast<double>(size)));
    };
    piece.x0 = limit(std::floor(low.x - 0.01), view.width);
    piece.y0 = limit(std::floor(low.y - 0.01), view.height);
    piece.x1 = limit(std::ceil(high.x + 0.01), view.width);
    piece.y1 = limit(std::ceil(high.y + 0.01), view.height);
}

enum class Sides { front, both, always_front };  // drawn: front faces, all, all and called front

// Keeps a triangle that has area on the film, turned clockwise.
void keep(std::vector<Piece>& pieces, Piece piece, Sides sides, bool mirrored, const View& view)
{
    const std::int64_t twice_area = edge(piece.v[1].snapped, piece.v[2].snapped, piece.v[0].snapped);
    if (twice_area == 0) return;  // G9b
    // Counter-clockwise to the viewer, glTF's front, is a negative area with y down.
    piece.front = sides == Sides::always_front || (twice_area < 0) != mirrored;
    if (sides == Sides::front && !piece.front) return;
    if (twice_area < 0) std::swap(piece.v[1], piece.v[2]);
    if (area(piece) == 0) return;
    bound(piece, view);
    if (piece.x0 < piece.x1 && piece.y0 < piece.y1) pieces.push_back(piece);
}

// (SH-7) A quadrilateral on the film between two ends, `across` half its width at right angles, as two triangles.
void keep_strip(std::vector<Piece>& pieces, const ScreenVertex& a, const ScreenVertex& b, const dvec2& across,
                Piece piece, const View& view)
{
    const auto moved = [&](ScreenVertex v, double side) {
        v.pixel += side * across;
        v.snapped = {std::llround(v.pixel.x * kSubPixels), std::llround(v.pixel.y * kSubPixels)};
        return v;
    };
    piece.v = {moved(a, 1), moved(b, 1), moved(b, -1)};
    keep(pieces, piece, Sides::always_front, false, view);
    piece.v = {moved(a, 1), moved(b, -1), moved(a, -1)};
    keep(pieces, piece, Sides::always_front, false, view);
}

}  // namespace

bool covers(const std::array<FixedPoint, 3>& c, const FixedPoint& p)
{
    for (std::size_t i = 0; i < 3; ++i) {
        const FixedPoint& a = c[(i + 1) % 3];
        const FixedPoint& b = c[(i + 2) % 3];
        const std::int64_t e = edge(a, b, p);
        if (e < 0 || (e == 0 && !is_top_left(a, b))) return false;
    }
    return true;
}

dmat4 projection(const View& view, double far)
{
    const Camera& camera = view.camera;
    dmat4 m(0);
    if (camera.orthographic) {  // (TF-5)
        m[0][0] = 1 / camera.xmag;
        m[1][1] = -1 / camera.ymag;
        m[2][2] = 1 / (far - camera.znear);
        m[3][2] = far / (far - camera.znear);
        m[3][3] = 1;
        return m;
    }
    const double f = 1 / std::tan(camera.yfov / 2);  // (TF-4)
    m[0][0] = f * view.height / view.width;
    m[1][1] = -f;
    m[3][2] = camera.znear;
    m[2][3] = -1;
    return m;
}

std::vector<ClipVertex> clip(std::span<const ClipVertex> polygon, const dvec2& guard)
{
    std::vector<ClipVertex> kept(polygon.begin(), polygon.end());
    const auto inside = [&](const ClipVertex& v) {
        const dvec4& p = v.position;
        return p.z <= p.w && std::abs(p.x) <= guard.x * p.w && std::abs(p.y) <= guard.y * p.w;
    };
    if (std::all_of(kept.begin(), kept.end(), inside)) return kept;
    kept = clip_against(kept, [](const dvec4& p) { return p.w - p.z; });  // reversed: z ≤ w is the near plane
    kept = clip_against(kept, [&](const dvec4& p) { return guard.x * p.w - p.x; });
    kept = clip_against(kept, [&](const dvec4& p) { return guard.x * p.w + p.x; });
    kept = clip_against(kept, [&](const dvec4& p) { return guard.y * p.w - p.y; });
    return clip_against(kept, [&](const dvec4& p) { return guard.y * p.w + p.y; });
}

std::vector<Piece> pieces_of_draw(const PosedScene& posed, std::uint32_t object, const dmat4& clip_from_camera,
                                  const Widths& widths)
{
    const Draw& draw = posed.draws[object];
    const Primitive& primitive = posed.primitive(draw);
    const Material& material = posed.material(draw);
    const View& view = posed.view;
    const dmat4 clip_from_object = clip_from_camera * glm::inverse(view.world_from_camera) * draw.world_from_object;
    std::vector<dvec4> positions;
    positions.reserve(primitive.positions.size());
    for (const vec3& p : primitive.positions) positions.push_back(clip_from_object * dvec4(dvec3(p), 1));

    const dvec2 guard(2 * kGuard / view.width, 2 * kGuard / view.height);
    const bool triangles = primitive.topology == Topology::triangles;
    const std::size_t corners = triangles ? 3 : primitive.topology == Topology::lines ? 2 : 1;
    const bool dielectric = material.model == BsdfModel::dielectric || material.model == BsdfModel::rough_dielectric;
    const Sides sides = material.double_sided || dielectric ? Sides::both : Sides::front;
    const bool mirrored = glm::determinant(dmat3(draw.world_from_object)) < 0;
    std::vector<Piece> pieces;
    for (std::size_t i = 0; i + corners <= primitive.indices.size(); i += corners) {
        Piece piece;
        piece.object = object;
        std::array<ClipVertex, 3> element;
        constexpr std::array<dvec2, 3> kCorner{dvec2(0, 0), dvec2(1, 0), dvec2(0, 1)};
        for (std::size_t c = 0; c < 3; ++c) {
            piece.vertices[c] = primitive.indices[i + std::min(c, corners - 1)];
            element[c] = {positions[piece.vertices[c]], kCorner[c]};
        }
        const std::vector<ClipVertex> polygon = clip(std::span(element).first(corners), guard);
        if (polygon.size() < corners) continue;
        if (triangles) {
            for (std::size_t k = 2; k < polygon.size(); ++k) {
                piece.v = {project(polygon[0], view), project(polygon[k - 1], view), project(polygon[k], view)};
                keep(pieces, piece, sides, mirrored, view);
            }
        } else if (corners == 2) {
            const ScreenVertex a = project(polygon[0], view), b = project(polygon[1], view);
            const dvec2 along = b.pixel - a.pixel;
            if (!(length(along) > 0)) continue;
            keep_strip(pieces, a, b, dvec2(-along.y, along.x) * (0.5 * widths.line / length(along)), piece, view);
        } else {
            ScreenVertex a = project(polygon[0], view), b = a;
            a.pixel.x -= 0.5 * widths.point;
            b.pixel.x += 0.5 * widths.point;
            keep_strip(pieces, a, b, dvec2(0, 0.5 * widths.point), piece, view);
        }
    }
    return pieces;
}

std::optional<Piece> piece_of_sphere(const PosedScene& posed, std::uint32_t sphere)
{
    const PosedSphere& s = posed.spheres[sphere];
    const View& view = posed.view;
    const dmat4 clip_from_world = projection(view, 1) * glm::inverse(view.world_from_camera);
    Piece piece;
    piece.object = static_cast<std::uint32_t>(posed.draws.size()) + sphere;
    dvec2 low(1e30), high(-1e30);
    int behind = 0;
    for (int corner = 0; corner < 8; ++corner) {
        const dvec3 side(corner & 1 ? 1 : -1, corner & 2 ? 1 : -1, corner & 4 ? 1 : -1);
        const dvec4 p = clip_from_world * dvec4(s.center + s.radius * side, 1);
        if (p.w <= 0) {
            ++behind;
            continue;
        }
        const dvec2 pixel((p.x / p.w + 1) / 2 * view.width, (p.y / p.w + 1) / 2 * view.height);
        low = glm::min(low, pixel);
        high = glm::max(high, pixel);
    }
    if (behind == 8) return std::nullopt;
    if (behind > 0) low = dvec2(0), high = dvec2(view.width, view.height);
    piece.x0 = static_cast<int>(std::clamp(std::floor(low.x) - 1, 0.0, static_cast<double>(view.width)));
    piece.y0 = static_cast<int>(std::clamp(std::floor(low.y) - 1, 0.0, static_cast<double>(view.height)));
    piece.x1 = static_cast<int>(std::clamp(std::ceil(high.x) + 1, 0.0, static_cast<double>(view.width)));
    piece.y1 = static_cast<int>(std::clamp(std::ceil(high.y) + 1, 0.0, static_cast<double>(view.height)));
    return piece;
}

namespace {

// Screen-space barycentrics (TR-3): each from its own edge, over their sum; and how they change per pixel.
struct Barycentrics {
    std::array<double, 3> b{}, dx{}, dy{};
    Barycentrics(const Piece& piece, const dvec2& p)
    {
        double sum = 0;
        for (std::size_t i = 0; i < 3; ++i) {
            const dvec2 a = piece.v[(i + 1) % 3].pixel - p, c = piece.v[(i + 2) % 3].pixel - p;
            b[i] = a.x * c.y - a.y * c.x;
            dx[i] = a.y - c.y;
            dy[i] = c.x - a.x;
            sum += b[i];
        }
        for (std::size_t i = 0; i < 3; ++i) b[i] /= sum, dx[i] /= sum, dy[i] /= sum;
    }
};

}  // namespace

Interpolation interpolate(const Piece& piece, const dvec2& pixel)
{
    const Barycentrics screen(piece, pixel);
    std::array<double, 3> q{};
    double sum = 0, sum_dx = 0, sum_dy = 0;
    for (std::size_t i = 0; i < 3; ++i) {
        q[i] = screen.b[i] * piece.v[i].inverse_w;
        sum += q[i];
        sum_dx += screen.dx[i] * piece.v[i].inverse_w;
        sum_dy += screen.dy[i] * piece.v[i].inverse_w;
    }
    Interpolation out;
    if (!(sum > 0)) return out;
    out.valid = true;
    const dvec2 b0 = piece.v[0].b;
    out.b = b0 + q[1] / sum * (piece.v[1].b - b0) + q[2] / sum * (piece.v[2].b - b0);  // (TR-4)
    // d(N/D) = (dN - (N/D) dD) / D
    dvec2 n_dx(0), n_dy(0);
    for (std::size_t i = 0; i < 3; ++i) {
        n_dx += screen.dx[i] * piece.v[i].inverse_w * piece.v[i].b;
        n_dy += screen.dy[i] * piece.v[i].inverse_w * piece.v[i].b;
    }
    out.b_dx = (n_dx - out.b * sum_dx) / sum;
    out.b_dy = (n_dy - out.b * sum_dy) / sum;
    return out;
}

double depth_at(const Piece& piece, const dvec2& pixel)
{
    const Barycentrics screen(piece, pixel);
    const double d0 = piece.v[0].depth;
    return d0 + screen.b[1] * (piece.v[1].depth - d0) + screen.b[2] * (piece.v[2].depth - d0);
}

}  // namespace etalon::reference
