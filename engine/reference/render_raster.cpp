#include <algorithm>
#include <optional>
#include <vector>

#include "engine/base/error.h"
#include "engine/base/parallel.h"
#include "engine/reference/aov.h"
#include "engine/reference/raster_band.h"
#include "engine/reference/raster_filter.h"
#include "engine/reference/reference.h"
#include "engine/scene/knobs.h"

namespace etalon::reference {
namespace {

constexpr int kBandRows = 16;  // of the picture that one unit of work draws

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
                          : posed.materials()[posed.spheres[object - draws].material];
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

DrawList make_draw_list(const PosedScene& posed, const RasterShader& shader, const Widths& widths)
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
            const std::vector<Piece> pieces = pieces_of_draw(posed, *it, clip_from_camera, widths);
            list.pieces.insert(list.pieces.end(), pieces.begin(), pieces.end());
        } else if (const auto piece = piece_of_sphere(posed, *it - static_cast<std::uint32_t>(posed.draws.size()))) {
            list.pieces.push_back(*piece);
        }
    }
    if (second == order.end()) list.first_transmitting = list.pieces.size();
    if (middle == order.end()) list.first_blended = list.pieces.size();
    return list;
}

/// A film in the making, band by band.
class Picture {
 public:
    Picture(const World& world, const RasterShader& shader, const RenderSettings& settings, const Progress& progress)
        : world_(&world),
          shader_(&shader),
          settings_(&settings),
          progress_(&progress),
          list_(make_draw_list(*world.posed, shader,
                               {.point = double(settings.point_size), .line = double(settings.line_width)})),
          width_(world.posed->view.width),
          height_(world.posed->view.height),
          by_band_(static_cast<std::size_t>((height_ + kBandRows - 1) / kBandRows)),
          nonfinite_(by_band_.size(), 0)
    {
        for (std::uint32_t i = 0; i < list_.pieces.size(); ++i) {
            const Piece& piece = list_.pieces[i];
            for (int b = piece.y0 / kBandRows; b * kBandRows < piece.y1; ++b)
                by_band_[static_cast<std::size_t>(b)].push_back(i);
        }
        film_.width = width_;
        film_.height = height_;
        film_.samples = static_cast<std::uint64_t>(settings.msaa);
        film_.mean.assign(film_.pixel_count(), vec3(0));
        film_.alpha.assign(film_.pixel_count(), 0);
    }

    Film draw() &&
    {
        list_.transmits ? draw_with_behind() : draw_at_once();
        for (const std::uint64_t n : nonfinite_) film_.nonfinite += n;
        return std::move(film_);
    }

 private:
    void draw_at_once()
    {
        over_bands([&](std::size_t b) {
            Band band = start(b);
            finish(b, band, nullptr);
        });
    }

    void draw_with_behind()
    {
        std::vector<std::optional<Band>> bands(by_band_.size());
        std::vector<dvec4> drawn(film_.pixel_count(), dvec4(0));
        over_bands([&](std::size_t b) {
            bands[b].emplace(start(b));
            for_each_pixel(b, [&](int x, int y, std::size_t at) { drawn[at] = bands[b]->resolve_drawn(x, y); });
        });
        const PictureBehind behind({width_, height_}, std::move(drawn));
        over_bands([&](std::size_t b) {
            if (bands[b]) finish(b, *bands[b], &behind);
        });
    }

    /// With what transmitting surfaces may show.
    Band start(std::size_t b) const
    {
        const int y0 = static_cast<int>(b) * kBandRows, y1 = std::min(height_, y0 + kBandRows);
        Band band(*world_, *shader_, y0, y1, *settings_);
        for (const std::uint32_t i : by_band_[b])
            if (i < list_.first_transmitting) band.draw(list_.pieces[i], false);
        return band;
    }

    void finish(std::size_t b, Band& band, const PictureBehind* behind)
    {
        band.set_behind(behind);
        for (const std::uint32_t i : by_band_[b])
            if (i >= list_.first_transmitting) band.draw(list_.pieces[i], i >= list_.first_blended);
        for_each_pixel(b, [&](int x, int y, std::size_t at) {
            const dvec4 pixel = band.resolve(x, y);
            film_.mean[at] = vec3(pixel);
            film_.alpha[at] = static_cast<float>(pixel.w);
            if (!is_finite(dvec3(pixel))) ++nonfinite_[b];
        });
    }

    /// Column, row, index in the film.
    template <class Visit>
    void for_each_pixel(std::size_t b, Visit&& visit) const
    {
        const int y0 = static_cast<int>(b) * kBandRows;
        for (int y = y0; y < std::min(height_, y0 + kBandRows); ++y)
            for (int x = 0; x < width_; ++x)
                visit(x, y,
                      static_cast<std::size_t>(y) * static_cast<std::size_t>(width_) + static_cast<std::size_t>(x));
    }

    template <class Work>
    void over_bands(Work&& work) const
    {
        parallel_for(
            by_band_.size(),
            [&](std::size_t b) {
                if (!progress_->stopped()) work(b);
            },
            settings_->threads);
    }

    const World* world_;
    const RasterShader* shader_;
    const RenderSettings* settings_;
    const Progress* progress_;
    DrawList list_;
    int width_, height_;
    std::vector<std::vector<std::uint32_t>> by_band_;  // indices of pieces
    std::vector<std::uint64_t> nonfinite_;             // by band
    Film film_;
};

Film draw_picture(const PosedScene& posed, const Requirements& required, const RenderSettings& settings,
                  const Progress& progress)
{
    World world(posed, required.texture_used, settings.mipmaps);
    world.textures.read_by(settings.texture_filter, settings.anisotropy);
    const RasterShader shader(world, settings);
    Film film = Picture(world, shader, settings, progress).draw();
    if (settings.aovs) film.aovs = render_aovs(world, shader.camera(), true, settings.threads);
    return film;
}

/// Each pixel from several drawn ones; AOVs are of the picture's own pixels.
Film draw_filtered(const PosedScene& posed, const Requirements& required, const RenderSettings& settings,
                   const Progress& progress)
{
    const View& view = posed.view;
    PosedScene fine = posed;
    fine.view.width *= settings.ssaa;
    fine.view.height *= settings.ssaa;
    RenderSettings plain = settings;
    plain.aovs = false;
    plain.point_size *= settings.ssaa;
    plain.line_width *= settings.ssaa;
    Film film = reconstruct(draw_picture(fine, required, plain, progress), {view.width, view.height}, settings.ssaa,
                            settings.pixel_filter);
    if (!settings.aovs) return film;
    World world(posed, required.texture_used, settings.mipmaps);
    world.textures.read_by(settings.texture_filter, settings.anisotropy);
    film.aovs = render_aovs(world, CameraRays(view), true, settings.threads);
    return film;
}

}  // namespace

Film render_raster(const PosedScene& posed, const Requirements& required, const RenderSettings& settings,
                   const Progress& progress)
{
    assume(posed.scene != nullptr && posed.view.width > 0 && posed.view.height > 0);
    check_knobs(settings);
    if (settings.ambient_rays > 0)
        throw Error(Blame::input, "the reference rasterizer has no --ambient-rays",
                    "render with --renderer raster, or by paths with --renderer reference");
    progress.report({.stage = "decoding textures", .fraction = 0, .error = {}, .samples = {}});
    Film film = settings.ssaa == 1 && settings.pixel_filter == PixelFilter::box
                    ? draw_picture(posed, required, settings, progress)
                    : draw_filtered(posed, required, settings, progress);
    progress.report({.stage = "rasterizing", .fraction = 1, .error = {}, .samples = {}});
    return film;
}

}  // namespace etalon::reference
