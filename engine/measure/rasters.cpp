#include "engine/measure/rasters.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "engine/reference/reference.h"
#include "engine/scene/builder.h"

namespace etalon {
namespace {

constexpr double kRounding = 5e-5;
constexpr double kTurn = 4e-7;            // radians
constexpr double kSnapping = 1.01 / 256;  // pixels; a hundredth more, so that what lies on the bound is within

Film by_reference(const PosedScene& posed, RenderSettings settings)
{
    settings.renderer = Renderer::reference_raster;
    return reference::render_raster(posed, require(posed, settings), settings, {});
}

constexpr double kSharpest = 1e-3;  // the model's own bound: a texture may go down to it

double alpha_of(double roughness, const TextureUse& texture)
{
    return texture.present() ? kSharpest : std::max(roughness * roughness, kSharpest);
}

double sharpest_layer(const MaterialLayers& layers)
{
    double alpha = 1;
    if (layers.clearcoat > 0) alpha = alpha_of(layers.clearcoat_roughness, layers.clearcoat_roughness_texture);
    // Sheen: D goes with sin^(1/alpha), no steeper than GGX of that alpha.
    if (layers.sheen_color != dvec3(0)) alpha = std::min(alpha, std::pow(std::max(layers.sheen_roughness, 0.07), 2));
    if (layers.sheen_roughness_texture.present()) alpha = std::min(alpha, 0.07 * 0.07);
    return alpha;
}

bool is_gltf_model(const Material& m)
{
    return m.model == BsdfModel::metallic_roughness || m.model == BsdfModel::specular_glossiness;
}

double sharpest_alpha(const Material& m)
{
    switch (m.model) {
        case BsdfModel::metallic_roughness:
        case BsdfModel::specular_glossiness:
            return std::min(alpha_of(m.roughness, m.metallic_roughness_texture),
                            m.layers ? sharpest_layer(*m.layers) : 1);
        case BsdfModel::rough_conductor:
        case BsdfModel::rough_dielectric:
            return std::max(m.ggx_alpha, kSharpest);
        case BsdfModel::dielectric:
            return kSharpest;
        default:
            return 1;
    }
}

/// Both sides know E to 3e-4 (SH-53), and E ≥ 1 - 0.7 α; M = 1 + F (1 - E)/E is off by F/E² of that.
double share_error(const Material& m)
{
    if (!is_gltf_model(m)) return 0;
    const bool metal = m.metallic > 0 || m.model == BsdfModel::specular_glossiness || m.layers;
    const double f = metal ? 1 : 0.04;
    const double e = 1 - 0.7 * (m.metallic_roughness_texture.present() ? 1 : std::min(m.roughness * m.roughness, 1.0));
    double error = 6e-4 * f / (e * (e + f * (1 - e)));
    // E_s, to 10⁻³ on one side and 5·10⁻⁴ on the other: S = 1 - E_s.
    if (m.layers && m.layers->sheen_color != dvec3(0)) error += 1.5e-3;
    return error;
}

bool is_textured(const Material& m)
{
    if (m.base_color_texture.present() || m.metallic_roughness_texture.present() || m.normal_texture.present() ||
        m.occlusion_texture.present() || m.emissive_texture.present())
        return true;
    if (!m.layers) return false;
    const MaterialLayers& l = *m.layers;
    const std::array<const TextureUse*, 14> all{&l.specular_texture,
                                                &l.specular_color_texture,
                                                &l.clearcoat_texture,
                                                &l.clearcoat_roughness_texture,
                                                &l.clearcoat_normal_texture,
                                                &l.sheen_color_texture,
                                                &l.sheen_roughness_texture,
                                                &l.transmission_texture,
                                                &l.thickness_texture,
                                                &l.iridescence_texture,
                                                &l.iridescence_thickness_texture,
                                                &l.anisotropy_texture,
                                                &l.diffuse_transmission_texture,
                                                &l.diffuse_transmission_color_texture};
    return std::any_of(all.begin(), all.end(), [](const TextureUse* use) { return use->present(); });
}

vec4 value(const Film& film, std::size_t pixel)
{
    return {film.mean[pixel], film.alpha[pixel]};
}

/// The smallest and largest values of some pictures about each pixel.
struct Hull {
    vec4 low{std::numeric_limits<float>::infinity()};
    vec4 high{-std::numeric_limits<float>::infinity()};
};

Hull hull_about(const std::vector<Film>& films, int x, int y)
{
    Hull hull;
    for (const Film& film : films)
        for (int j = std::max(0, y - 1); j <= std::min(film.height - 1, y + 1); ++j)
            for (int i = std::max(0, x - 1); i <= std::min(film.width - 1, x + 1); ++i) {
                const vec4 v = value(film, static_cast<std::size_t>(j * film.width + i));
                hull.low = glm::min(hull.low, v);
                hull.high = glm::max(hull.high, v);
            }
    return hull;
}

/// The scene with its picture moved by (dx, dy) pixels.
PosedScene moved(const PosedScene& posed, double dx, double dy)
{
    PosedScene out = posed;
    const Camera& camera = posed.view.camera;
    const double height = posed.view.height, width = posed.view.width;
    if (camera.orthographic) {
        out.view.world_from_camera *= translation({-2 * camera.xmag * dx / width, 2 * camera.ymag * dy / height, 0});
    } else {
        const double pixel = 2 * std::tan(camera.yfov / 2) / height;
        out.view.world_from_camera *= rotation_y(dx * pixel) * rotation_x(dy * pixel);
    }
    return out;
}

std::vector<Film> moved_references(const PosedScene& posed, const RenderSettings& settings)
{
    std::vector<Film> films;
    for (const double dx : {-kSnapping, kSnapping})
        for (const double dy : {-kSnapping, kSnapping}) films.push_back(by_reference(moved(posed, dx, dy), settings));
    return films;
}

double brightest(const Film& film)
{
    float most = 0;
    for (const vec3& v : film.mean) most = std::max({most, v.x, v.y, v.z});
    return static_cast<double>(most);
}

dvec3 mean_of(const Film& film)
{
    dvec3 sum(0);
    for (const vec3& v : film.mean) sum += dvec3(v);
    return sum / static_cast<double>(film.pixel_count());
}

}  // namespace

RasterBudget raster_budget(const PosedScene& posed, const RenderSettings& settings, const RasterPrecision& precision)
{
    double alpha = 1, shares = 0;
    bool textured = false, transmits = false, glossy = false;
    bool lit = !posed.lights.empty();
    const auto add = [&](const Material& material) {
        alpha = std::min(alpha, sharpest_alpha(material));
        lit = lit || material.emission != dvec3(0);
        shares = std::max(shares, share_error(material));
        const bool plain = material.model == BsdfModel::unlit || material.model == BsdfModel::lambert;
        glossy = glossy || !(plain || material.model == BsdfModel::mirror);
        textured = textured || is_textured(material);
        transmits = transmits || (material.layers && material.layers->transmission > 0);
    };
    for (const Draw& draw : posed.draws) add(posed.material(draw));
    for (const PosedSphere& sphere : posed.spheres) add(posed.materials()[sphere.material]);
    if (!lit || settings.shading == Shading::blinn_phong) shares = 0;
    // E and w̄ of (SH-34) by two quadratures: their F0 + (F90 - F0) w̄ times E differs by at most so much.
    const bool shines = !posed.environment.is_black() && settings.shading != Shading::blinn_phong;
    if (shines && glossy) shares += 2.5e-3;
    RasterBudget budget{.relative = kRounding + 2 * kTurn / alpha + shares};
    // Where a transmitting surface looks behind: a film position off by ten roundings of its size, times a difference
    // of neighbours of at most 1.
    if (transmits) budget.absolute += 10 * std::exp2(-24.0) * std::max(posed.view.width, posed.view.height);
    if (textured) budget.absolute += 2 * std::exp2(-1.0 - double(precision.subtexel_bits));
    if (textured && settings.mipmaps) budget.absolute += std::exp2(-1.0 - double(precision.mip_bits));
    return budget;
}

RasterAgreement compare_rasters(const PosedScene& posed, const RenderSettings& settings, const Film& device,
                                const Film& reference, const RasterBudget& budget)
{
    RasterAgreement found;
    // Values under a millionth of the brightest are rounding of what was added to them.
    const double floor = (budget.absolute + 1e-6) * brightest(reference);
    std::vector<Film> moved;
    for (int y = 0; y < reference.height; ++y)
        for (int x = 0; x < reference.width; ++x) {
            const auto pixel = static_cast<std::size_t>(y * reference.width + x);
            const vec4 a = value(device, pixel), b = value(reference, pixel);
            double excess = 0;
            dvec4 allowed;
            for (int c = 0; c < 4; ++c) {
                allowed[c] = budget.relative * std::abs(static_cast<double>(b[c])) + floor;
                excess = std::max(excess, std::abs(static_cast<double>(a[c]) - static_cast<double>(b[c])) / allowed[c]);
            }
            if (excess <= 1) {
                found.worst = std::max(found.worst, excess);
                continue;
            }
            ++found.beyond;
            if (moved.empty()) moved = moved_references(posed, settings);
            const Hull hull = hull_about(moved, x, y);
            for (int c = 0; c < 4; ++c)
                if (a[c] < hull.low[c] - allowed[c] || a[c] > hull.high[c] + allowed[c]) {
                    ++found.unexplained;
                    break;
                }
        }
    const dvec3 a = mean_of(device), b = mean_of(reference);
    found.mean_error = glm::length(a - b) / std::max(glm::length(b), 1e-30);
    found.pixels = reference.pixel_count();
    // Errors of texture weights have no sign, and a box-filtered level has the mean of the one above, so they cancel
    // over the picture as independent ones would, 4x4 pixels at a time being alike; each edge pixel may be wholly off.
    const double contrast = brightest(reference) / std::max(glm::length(b), 1e-30);
    const double count = static_cast<double>(found.pixels);
    found.mean_budget = budget.relative + budget.absolute * contrast / std::sqrt(count / 16) +
                        static_cast<double>(found.beyond) / count * contrast;
    return found;
}

Comparison judge_rasters(const PosedScene& posed, const RenderSettings& settings, const RasterPrecision& precision,
                         const Film& device, const Film& reference)
{
    Comparison result = compare(device, reference);
    if (result.verdict == Verdict::not_finite) return result;
    const RasterBudget budget = raster_budget(posed, settings, precision);
    const RasterAgreement found = compare_rasters(posed, settings, device, reference, budget);
    result.verdict = found.holds() ? Verdict::within_budget : Verdict::over_budget;
    result.reasons.push_back(
        fmt::format("pixels may differ by {:.2g} of their value + {:.2g} of the brightest; the worst takes {:.0f}% of "
                    "it",
                    budget.relative, budget.absolute, 100 * found.worst));
    result.reasons.push_back(
        fmt::format("{} edge pixels are beyond it, {} of them not explained by snapping vertices to 1/256 pixel",
                    found.beyond, found.unexplained));
    result.reasons.push_back(
        fmt::format("means differ by {:.2g} of an allowed {:.2g}", found.mean_error, found.mean_budget));
    return result;
}

}  // namespace etalon
