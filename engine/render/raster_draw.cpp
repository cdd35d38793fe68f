#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <limits>

#include "engine/base/error.h"
#include "engine/render/material.h"
#include "engine/render/raster.h"
#include "engine/render/render.h"
#include "engine/scene/knobs.h"
#include "engine/scene/unseen.h"

namespace etalon {
namespace {

/// A part of a frame, in the order of drawing.
struct RasterPass {
    const char* name;
    AlphaMode mode;
    bool transmits;
    bool behind;  ///< belongs to the picture that transmitting surfaces show
    bool (*needed)(const Requirements&);
};

bool needs_mask(const Requirements& required)
{
    return required.has(Feature::alpha_mask);
}
bool needs_transmission(const Requirements& required)
{
    return required.has(Feature::transmission);
}

constexpr std::array<RasterPass, 5> kPasses{{
    {"opaque", AlphaMode::opaque, false, true, [](const Requirements&) { return true; }},
    {"mask", AlphaMode::mask, false, true, needs_mask},
    {"transmission", AlphaMode::opaque, true, false, needs_transmission},
    {"masked transmission", AlphaMode::mask, true, false,
     [](const Requirements& required) { return needs_mask(required) && needs_transmission(required); }},
    {"blend", AlphaMode::blend, false, false,
     [](const Requirements& required) { return required.has(Feature::alpha_blend); }},
}};

template <class T>
void write(const gpu::Buffer& buffer, std::span<const T> values)
{
    const std::span<const std::byte> bytes = std::as_bytes(values);
    assume(bytes.size() <= buffer.mapped().size());
    std::copy(bytes.begin(), bytes.end(), buffer.mapped().begin());
}

}  // namespace

std::vector<std::string_view> raster_passes(const Requirements& required)
{
    std::vector<std::string_view> names;
    for (const RasterPass& pass : kPasses)
        if (pass.needed(required)) names.emplace_back(pass.name);
    if (needs_transmission(required)) names.emplace_back("levels behind");
    if (required.has(Feature::visible_background)) names.emplace_back("background");
    if (required.has(Feature::msaa)) names.emplace_back("resolve");
    if (required.has(Feature::aovs)) names.emplace_back("aovs");
    return names;
}

void RasterScene::resize(const View& view)
{
    const View fine = drawn(view);
    const bool fits = targets_.resolved && targets_.resolved.width() == static_cast<std::uint32_t>(fine.width) &&
                      targets_.resolved.height() == static_cast<std::uint32_t>(fine.height);
    if (fits) return;
    targets_ = {};  // before the new ones take their memory
    targets_ = make_targets(device_, {.size = {view.width, view.height},
                                      .per_side = settings_.ssaa,
                                      .filtered = filter_.has_value(),
                                      .samples = variants_.samples(),
                                      .depth = depth_format(settings_.depth),
                                      .aovs = settings_.aovs && required_.has(Feature::aovs),
                                      .levels = behind_.has_value()});
    if (filter_) filter_->bind(targets_);
    if (rays_ && rays_->resize(fine)) bind_frames();
    if (!behind_) return;
    behind_->bind(targets_);
    behind_bindings_ = bind_frame(frame_, targets_.levels);
}

void RasterScene::trace_rays(const View& view)
{
    const auto start = std::chrono::steady_clock::now();
    rays_->run(view);
    rays_milliseconds_ = std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count();
}

View RasterScene::drawn(View view) const
{
    view.width *= settings_.ssaa;
    view.height *= settings_.ssaa;
    return view;
}

void RasterScene::write_lights(const View& view)
{
    std::vector<shared::LightRecord> lights;
    for (const PosedLight& light : posed_.lights) lights.push_back(pack(light, eye_of(view)));
    write(lights_, std::span<const shared::LightRecord>(lights));
    std::vector<shared::EmitterRecord> emitters;
    for (const RasterEmitter& emitter : emitters_) emitters.push_back(pack(emitter, eye_of(view)));
    write(emitter_records_, std::span<const shared::EmitterRecord>(emitters));
    if (!shadows_) return;
    const std::vector<shared::RasterShadow> shadows = shadows_->records(eye_of(view));
    write(shadow_records_, std::span<const shared::RasterShadow>(shadows));
}

void RasterScene::write_frame(const gpu::Buffer& buffer, const View& view, int per_side, DepthKind depth)
{
    const shared::RasterFrame frame =
        make_frame(posed_, view, tables_ ? &*tables_ : nullptr, static_cast<std::uint32_t>(posed_.lights.size()),
                   static_cast<std::uint32_t>(emitters_.size()),
                   settings_.background == Background::colour ? settings_.background_color : dvec3(0),
                   vec2(dvec2(settings_.point_size, settings_.line_width) * double(per_side)), depth);
    write(buffer, std::span<const shared::RasterFrame>(&frame, 1));
}

void RasterScene::draw(const View& view)
{
    assume(view.width > 0 && view.height > 0);
    assume(view.camera.orthographic == posed_.view.camera.orthographic);
    commands_.reset();  // waits: the last draw may still read what is written now
    resize(view);
    write_lights(view);
    write_frame(frame_, drawn(view), settings_.ssaa, settings_.depth);
    if (rays_) trace_rays(drawn(view));
    gpu::Commands& commands = commands_.emplace(device_, "raster");
    if (shadows_ && !shadows_drawn_) draw_shadows(commands);
    draw_color(commands, drawn(view));
    if (filter_) filter_->record(commands, targets_);
    if (targets_.has_aovs()) {
        write_frame(aov_frame_, view, 1, DepthKind::reversed_32);
        draw_aovs(commands, view);
    }
    commands.prepare(targets_.picture(), gpu::ImageUse::sampled);
    commands.submit();
}

void RasterScene::draw_color(gpu::Commands& commands, const View& view)
{
    VkClearColorValue clear{{0, 0, 0, behind_ || settings_.background == Background::transparent ? 0.f : 1.f}};
    if (!behind_ && settings_.background == Background::colour)
        for (int c = 0; c < 3; ++c) clear.float32[c] = static_cast<float>(settings_.background_color[c]);
    const bool multisampled = targets_.is_multisampled();
    std::array<gpu::ColorTarget, 1> color{{{.image = multisampled ? &targets_.color : &targets_.resolved,
                                            .clear = clear,
                                            .resolve = multisampled ? &targets_.resolved : nullptr,
                                            .store = !multisampled}}};
    gpu::DepthTarget depth{.image = &targets_.depth, .clear = settings_.depth == DepthKind::reversed_32 ? 0.f : 1.f};
    if (behind_) {
        color[0].store = depth.store = true;
        commands.begin_rendering(color, depth);
        draw_passes(commands, view, true);
        commands.end_rendering();
        commands.begin_region("levels behind");
        behind_->record(commands, targets_);
        commands.end_region();
        color[0].clear.reset();
        depth.clear.reset();
        color[0].store = !multisampled;
        depth.store = false;
    }
    commands.begin_rendering(color, depth);
    if (!behind_) draw_passes(commands, view, true);
    draw_background(commands);
    draw_passes(commands, view, false);
    commands.begin_region("resolve");
    commands.end_rendering();
    commands.end_region();
}

void RasterScene::draw_passes(gpu::Commands& commands, const View& view, bool behind)
{
    for (const RasterPass& pass : kPasses) {
        if (pass.behind != behind || !pass.needed(required_)) continue;
        commands.begin_region(pass.name);
        draw_items(commands, view, {pass.mode, pass.transmits}, RasterTarget::color,
                   behind || !behind_ ? frame_bindings_ : behind_bindings_);
        commands.end_region();
    }
}

void RasterScene::draw_background(gpu::Commands& commands) const
{
    if (!draws_background()) return;
    commands.begin_region("background");
    commands.bind(*background_);
    commands.bind(frame_bindings_.at(RasterShape::background));
    commands.bind(background_map_);
    commands.draw(3);
    commands.end_region();
}

void RasterScene::draw_aovs(gpu::Commands& commands, const View& view)
{
    std::array<gpu::ColorTarget, kRasterAovTargets> targets;
    for (std::size_t i = 0; i < kRasterAovTargets; ++i)
        targets[i] = {.image = &targets_.aovs[i], .clear = VkClearColorValue{}};
    targets[0].clear->float32[3] = std::numeric_limits<float>::infinity();  // depth of nothing
    commands.begin_region("aovs");
    commands.begin_rendering(targets, gpu::DepthTarget{.image = &targets_.aov_depth});
    for (const RasterPass& pass : kPasses)
        if (pass.needed(required_))
            draw_items(commands, view, {pass.mode, pass.transmits}, RasterTarget::aovs, aov_bindings_);
    commands.end_rendering();
    commands.end_region();
}

const gpu::GraphicsPipeline& RasterScene::pipeline_of(const Item& item, RasterTarget target) const
{
    switch (target) {
        case RasterTarget::color:
            return *item.color;
        case RasterTarget::aovs:
            return *item.aovs;
        case RasterTarget::shadow:
            return *item.shadow;
        case RasterTarget::parallel_shadow:
            return *item.parallel_shadow;
    }
    assume(false);
    return *item.color;
}

void RasterScene::draw_shadows(gpu::Commands& commands)
{
    commands.begin_region("shadow maps");
    for (std::size_t i = 0; i < shadows_->maps().size(); ++i) {
        const RasterShadows::Map& map = shadows_->maps()[i];
        const RasterTarget target = map.parallel ? RasterTarget::parallel_shadow : RasterTarget::shadow;
        commands.begin_rendering({}, gpu::DepthTarget{.image = &shadows_->target(), .store = true});
        for (const RasterPass& pass : kPasses)
            if (pass.mode != AlphaMode::blend && pass.needed(required_))
                draw_items(commands, map.view, {pass.mode, pass.transmits}, target, shadow_bindings_[i]);
        commands.end_rendering();
        commands.prepare(shadows_->target(), gpu::ImageUse::copy_source);
        commands.copy(shadows_->target(), shadows_->depths(), 0, 0, i * shadows_->bytes_of_a_map());
    }
    commands.barrier(gpu::Work::copy, gpu::Work::draw);
    commands.end_region();
    shadows_drawn_ = true;
}

std::vector<const RasterScene::Item*> RasterScene::ordered(const Selection& wanted, const View& view) const
{
    const bool blends = wanted.mode == AlphaMode::blend;
    std::vector<const Item*> items;
    for (const Item& item : items_)
        if (item.mode == wanted.mode && (blends || item.transmits == wanted.transmits)) items.push_back(&item);
    if (!blends) return items;
    const auto depth = [&](const Item* item) {
        return -dot(item->center - eye_of(view), dvec3(view.world_from_camera[2]));
    };
    std::stable_sort(items.begin(), items.end(), [&](const Item* a, const Item* b) { return depth(a) > depth(b); });
    return items;
}

void RasterScene::draw_items(gpu::Commands& commands, const View& view, const Selection& wanted, RasterTarget target,
                             const FrameBindings& frame) const
{
    const gpu::GraphicsPipeline* bound = nullptr;
    std::optional<RasterShape> shape;
    for (const Item* item : ordered(wanted, view)) {
        if (is_hidden(*item, view, target)) continue;
        const gpu::GraphicsPipeline* pipeline = &pipeline_of(*item, target);
        if (pipeline != bound) commands.bind(*pipeline);
        if (shape != item->shape) {
            commands.bind(frame.at(item->shape));
            if (item->shape == RasterShape::mesh) geometry_.bind(commands);
        }
        commands.bind(*item->textures);
        bound = pipeline;
        shape = item->shape;
        if (item->shape == RasterShape::mesh)
            draw_mesh(commands, view, *item, target);
        else
            draw_sphere(commands, view, *item);
    }
}

bool RasterScene::is_hidden(const Item& item, const View& view, RasterTarget target) const
{
    // What lies behind a light's eye may be between the light and the scene; lines and points are wider than their box.
    if (item.shape != RasterShape::mesh || (target != RasterTarget::color && target != RasterTarget::aovs))
        return false;
    const Draw& draw = posed_.draws[item.index];
    if (posed_.primitive(draw).topology != Topology::triangles) return false;
    const RasterGeometry::Range& range = geometry_.range(draw);
    return is_outside(view, draw.world_from_object, range.low, range.high);
}

void RasterScene::draw_mesh(gpu::Commands& commands, const View& view, const Item& item, RasterTarget target) const
{
    const Draw& draw = posed_.draws[item.index];
    const RasterGeometry::Range& range = geometry_.range(draw);
    shared::RasterDraw record{.object_rows = {},
                              .normal_matrix = mat3(1),
                              .handedness = 1,
                              .scale = 1,
                              .material = item.material,
                              .object_id = item.index + 1,
                              .first_face = range.first_face};
    place(draw.world_from_object, eye_of(view), record);
    // Towards a light the other way round: light that meets a back passes it (SH-6).
    const bool shadow = target == RasterTarget::shadow || target == RasterTarget::parallel_shadow;
    const VkCullModeFlagBits culled = shadow ? VK_CULL_MODE_FRONT_BIT : VK_CULL_MODE_BACK_BIT;
    commands.set_cull(item.culled ? culled : VK_CULL_MODE_NONE,
                      item.mirrored ? VK_FRONT_FACE_CLOCKWISE : VK_FRONT_FACE_COUNTER_CLOCKWISE);
    commands.push(record);
    commands.draw_indexed(range.index_count, 1, range.first_index, range.first_vertex);
}

void RasterScene::draw_sphere(gpu::Commands& commands, const View& view, const Item& item) const
{
    const PosedSphere& sphere = posed_.spheres[item.index];
    const auto pixels = pixels_of(sphere, view, view.camera.znear);
    if (!pixels) return;
    commands.set_cull(VK_CULL_MODE_NONE, VK_FRONT_FACE_COUNTER_CLOCKWISE);
    commands.set_scissor(pixels->x, pixels->y, pixels->width, pixels->height);
    const double own_radius = posed_.scene->nodes[sphere.node].sphere->radius;
    commands.push(shared::RasterSphere{.center = vec3(sphere.center - eye_of(view)),
                                       .radius = static_cast<float>(sphere.radius),
                                       .material = item.material,
                                       .object_id = static_cast<std::uint32_t>(posed_.draws.size()) + item.index + 1,
                                       .scale = static_cast<float>(sphere.radius / own_radius)});
    commands.draw(3);
    commands.set_scissor(0, 0, static_cast<std::uint32_t>(view.width), static_cast<std::uint32_t>(view.height));
}

Film RasterScene::read()
{
    assume(commands_.has_value());
    commands_->wait();
    const auto start = std::chrono::steady_clock::now();
    Film film = read_targets(device_, targets_);
    read_milliseconds_ = std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count();
    const auto per_side = static_cast<std::uint32_t>(settings_.ssaa);
    film.samples = std::uint64_t{variants_.samples()} * per_side * per_side;
    film.metadata["renderer"] = "raster";
    film.metadata["device"] = device_.description();
    film.metadata["msaa"] = std::to_string(variants_.samples());
    film.metadata["ssaa"] = std::to_string(settings_.ssaa);
    film.metadata["filter"] = knob_value(settings_, "filter");
    for (const RasterStage& time : times())
        film.metadata["milliseconds." + time.name] = fmt::format("{:.3f}", time.milliseconds);
    return film;
}

std::vector<RasterStage> RasterScene::times() const
{
    std::vector<RasterStage> all = times_;
    if (commands_)
        for (const gpu::RegionTime& region : commands_->times()) all.push_back({region.name, region.milliseconds});
    if (rays_) all.push_back({"rays", rays_milliseconds_});
    all.push_back({"read", read_milliseconds_});
    return all;
}

Film render_raster(gpu::Device& device, const PosedScene& posed, const Requirements& required,
                   const RenderSettings& settings, const Progress& progress)
{
    RasterScene scene(device, posed, required, settings, progress);
    scene.draw(posed.view);
    progress.report({.stage = "drawing", .fraction = 0, .error = {}, .samples = {}});
    return scene.read();
}

}  // namespace etalon
