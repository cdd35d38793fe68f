#include "engine/render/raster.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <limits>

#include "engine/base/error.h"
#include "engine/image/mips.h"
#include "engine/render/material.h"
#include "engine/render/render.h"

namespace etalon {
namespace {

/// A part of a frame, in the order of drawing.
struct RasterPass {
    const char* name;
    AlphaMode mode;
    bool (*needed)(const Requirements&);
};

constexpr std::array<RasterPass, 3> kPasses{{
    {.name = "opaque", .mode = AlphaMode::opaque, .needed = [](const Requirements&) { return true; }},
    {.name = "mask",
     .mode = AlphaMode::mask,
     .needed = [](const Requirements& required) { return required.has(Feature::alpha_mask); }},
    {.name = "blend",
     .mode = AlphaMode::blend,
     .needed = [](const Requirements& required) { return required.has(Feature::alpha_blend); }},
}};

class Stopwatch {
 public:
    double milliseconds() const
    {
        return std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start_).count();
    }

 private:
    std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
};

template <class Make>
auto timed(std::vector<StageTime>& times, const char* name, Make make)
{
    const Stopwatch watch;
    auto made = make();
    times.push_back({name, watch.milliseconds()});
    return made;
}

template <class T>
void write(const gpu::Buffer& buffer, std::span<const T> values)
{
    const std::span<const std::byte> bytes = std::as_bytes(values);
    assume(bytes.size() <= buffer.mapped().size());
    std::copy(bytes.begin(), bytes.end(), buffer.mapped().begin());
}

dvec3 center_of(const PosedScene& posed, const Draw& draw)
{
    const std::vector<vec3>& positions = posed.primitive(draw).positions;
    if (positions.empty()) return dvec3(draw.world_from_object[3]);
    vec3 low = positions[0], high = positions[0];
    for (const vec3& p : positions) {
        low = glm::min(low, p);
        high = glm::max(high, p);
    }
    return dvec3(draw.world_from_object * dvec4((dvec3(low) + dvec3(high)) / 2.0, 1));
}

}  // namespace

RasterScene::RasterScene(gpu::Device& device, const PosedScene& posed, const Requirements& required,
                         const RenderSettings& settings, const Progress& progress)
    : device_(device),
      posed_(posed),
      required_(required),
      settings_(settings),
      variants_(posed, required_, settings_),
      geometry_(timed(times_, "geometry", [&] { return RasterGeometry(device, posed, required); })),
      textures_(device, *posed.scene, settings.mipmaps && required.has(Feature::mipmaps), settings.threads),
      pipelines_(device, geometry_.streams(), RasterGeometry::attributes()),
      frame_(device, {.size = sizeof(shared::RasterFrame), .memory = gpu::MemoryKind::upload, .name = "frame"}),
      materials_(gpu::make_buffer(device, pack_materials(*posed.scene), "materials")),
      lights_(device, {.size = posed.lights.size() * sizeof(shared::LightRecord),
                       .memory = gpu::MemoryKind::upload,
                       .name = "lights"}),
      emitters_(required.has(Feature::emission) ? find_emitters(posed) : std::vector<RasterEmitter>{}),
      emitter_records_(device, {.size = emitters_.size() * sizeof(shared::EmitterRecord),
                                .memory = gpu::MemoryKind::upload,
                                .name = "emitters"})
{
    if (settings.msaa != 1 && settings.msaa != 4)
        throw Error(Blame::input, fmt::format("the rasterizer takes 1 or 4 samples a pixel, not {}", settings.msaa));
    if (variants_.samples() == 4 && (device.limits().samples >> 2 & 1) == 0)
        throw Error(Blame::machine, fmt::format("{} cannot draw 4 samples a pixel in float32", device.name()),
                    "render with --msaa 1");
    add_environment();
    add_items(progress);
    bind_frame();
}

void RasterScene::add_environment()
{
    const Environment& environment = posed_.environment;
    const bool mapped = environment.map && !environment.is_black() && required_.has(Feature::environment_map);
    if (mapped) tables_ = timed(times_, "environment", [&] { return tabulate(*environment.map, settings_.threads); });
    atlas_ = upload_picture(device_, mapped ? tables_->atlas : Image(), "environment tables");

    const bool shines = !environment.is_black() && (mapped || required_.has(Feature::environment_constant));
    if (settings_.background != Background::environment || !shines || !required_.has(Feature::visible_background))
        return;
    background_ = &pipelines_.get(variants_.background());
    const int most = static_cast<int>(std::min(device_.limits().image_side, 1u << 15));
    const bool too_large = mapped && (environment.map->width > most || environment.map->height > most);
    if (too_large)
        environment_map_ = upload_picture(device_,
                                          shrink(*environment.map, std::min(environment.map->width, most),
                                                 std::min(environment.map->height, most), settings_.threads),
                                          "environment");
    else
        environment_map_ = upload_picture(device_, mapped ? *environment.map : Image(), "environment");
    background_map_ = {device_, background_->layout(), {{0, environment_map_}}, 1};
}

void RasterScene::add_items(const Progress& progress)
{
    const Stopwatch watch;
    for (std::uint32_t i = 0; i < posed_.draws.size(); ++i) {
        progress.report(
            {.stage = "uploading", .fraction = double(i) / double(posed_.draws.size()), .error = {}, .samples = {}});
        if (geometry_.range(posed_.draws[i]).index_count != 0) items_.push_back(item_of(i));
    }
    for (std::uint32_t i = 0; required_.has(Feature::spheres) && i < posed_.spheres.size(); ++i)
        items_.push_back(item_of_sphere(i));
    times_.push_back({"textures and pipelines", watch.milliseconds()});
}

RasterScene::Item RasterScene::item_of(std::uint32_t draw)
{
    const Draw& placed = posed_.draws[draw];
    const bool triangles = posed_.primitive(placed).topology == Topology::triangles;
    Item item{.shape = RasterShape::mesh,
              .index = draw,
              .material = posed_.primitive(placed).material,
              .culled = triangles && variants_.culls_back(posed_.material(placed)),
              .mirrored = is_mirrored(placed.world_from_object),
              .center = {}};
    if (posed_.material(placed).alpha_mode == AlphaMode::blend) item.center = center_of(posed_, placed);
    std::optional<RasterVariant> aovs;
    if (settings_.aovs && required_.has(Feature::aovs)) aovs = variants_.of(placed, RasterTarget::aovs);
    finish(item, variants_.of(placed, RasterTarget::color), aovs);
    return item;
}

RasterScene::Item RasterScene::item_of_sphere(std::uint32_t sphere)
{
    const PosedSphere& placed = posed_.spheres[sphere];
    Item item{.shape = RasterShape::sphere, .index = sphere, .material = placed.material, .center = placed.center};
    std::optional<RasterVariant> aovs;
    if (settings_.aovs && required_.has(Feature::aovs)) aovs = variants_.of(placed, RasterTarget::aovs);
    finish(item, variants_.of(placed, RasterTarget::color), aovs);
    return item;
}

void RasterScene::finish(Item& item, const RasterVariant& color, const std::optional<RasterVariant>& aovs)
{
    const Material& material = posed_.scene->materials[item.material];
    item.mode = material.alpha_mode;
    textures_.require(material, color);
    item.color = &pipelines_.get(color);
    if (aovs) item.aovs = &pipelines_.get(*aovs);
    item.textures = &texture_bindings(item.color->layout(), material, color);
}

const gpu::Bindings& RasterScene::texture_bindings(const gpu::Layout& layout, const Material& material,
                                                   const RasterVariant& variant)
{
    using C = RasterConstant;
    const auto read = [&](C constant, const TextureUse& use) {
        return variant.get(constant) != 0 ? use.texture : kNone;
    };
    const std::array<Index, 5> key{read(C::base_color_texture, material.base_color_texture),
                                   read(C::metallic_roughness_texture, material.metallic_roughness_texture),
                                   read(C::normal_texture, material.normal_texture),
                                   read(C::occlusion_texture, material.occlusion_texture),
                                   read(C::emissive_texture, material.emissive_texture)};
    const auto found = texture_bindings_.find(key);
    if (found != texture_bindings_.end()) return found->second;
    return texture_bindings_.emplace(key, textures_.bind(layout, material, variant)).first->second;
}

void RasterScene::bind_frame()
{
    const auto bind = [&](RasterShape shape, const gpu::GraphicsPipeline& pipeline) {
        if (frame_bindings_.contains(shape)) return;
        const std::vector<gpu::Bind> binds{{0, frame_},           {1, materials_},
                                           {2, lights_},          {3, geometry_.face_normals()},
                                           {4, emitter_records_}, {5, atlas_}};
        frame_bindings_.emplace(shape, gpu::Bindings(device_, pipeline.layout(), binds, 0));
    };
    for (const Item& item : items_) bind(item.shape, *item.color);
    if (draws_background()) bind(RasterShape::background, *background_);
}

void RasterScene::resize(const View& view)
{
    const bool fits = targets_.resolved && targets_.resolved.width() == static_cast<std::uint32_t>(view.width) &&
                      targets_.resolved.height() == static_cast<std::uint32_t>(view.height);
    if (fits) return;
    targets_ = {};  // before the new ones take their memory
    targets_ = make_targets(device_, {view.width, view.height}, variants_.samples(),
                            settings_.aovs && required_.has(Feature::aovs));
}

void RasterScene::write_frame(const View& view)
{
    std::vector<shared::LightRecord> lights;
    for (const PosedLight& light : posed_.lights) lights.push_back(pack(light, eye_of(view)));
    write(lights_, std::span<const shared::LightRecord>(lights));
    std::vector<shared::EmitterRecord> emitters;
    for (const RasterEmitter& emitter : emitters_) emitters.push_back(pack(emitter, eye_of(view)));
    write(emitter_records_, std::span<const shared::EmitterRecord>(emitters));
    const shared::RasterFrame frame =
        make_frame(posed_, view, tables_ ? &*tables_ : nullptr, static_cast<std::uint32_t>(lights.size()),
                   static_cast<std::uint32_t>(emitters_.size()));
    write(frame_, std::span<const shared::RasterFrame>(&frame, 1));
}

void RasterScene::draw(const View& view)
{
    assume(view.width > 0 && view.height > 0);
    assume(view.camera.orthographic == posed_.view.camera.orthographic);
    commands_.reset();  // waits: the last draw may still read what is written now
    resize(view);
    write_frame(view);
    gpu::Commands& commands = commands_.emplace(device_, "raster");
    draw_color(commands, view);
    if (targets_.has_aovs()) draw_aovs(commands, view);
    commands.prepare(targets_.resolved, gpu::ImageUse::sampled);
    commands.submit();
}

void RasterScene::draw_color(gpu::Commands& commands, const View& view)
{
    VkClearColorValue clear{{0, 0, 0, settings_.background == Background::transparent ? 0.f : 1.f}};
    if (settings_.background == Background::colour)
        for (int c = 0; c < 3; ++c) clear.float32[c] = static_cast<float>(settings_.background_color[c]);
    const bool multisampled = targets_.is_multisampled();
    const std::array<gpu::ColorTarget, 1> color{{{.image = multisampled ? &targets_.color : &targets_.resolved,
                                                  .clear = clear,
                                                  .resolve = multisampled ? &targets_.resolved : nullptr,
                                                  .store = !multisampled}}};
    commands.begin_rendering(color, gpu::DepthTarget{.image = &targets_.depth});
    if (draws_background()) {
        commands.begin_region("background");
        commands.bind(*background_);
        commands.bind(frame_bindings_.at(RasterShape::background));
        commands.bind(background_map_);
        commands.draw(3);
        commands.end_region();
    }
    for (const RasterPass& pass : kPasses) {
        if (!pass.needed(required_)) continue;
        commands.begin_region(pass.name);
        draw_items(commands, view, pass.mode, RasterTarget::color);
        commands.end_region();
    }
    commands.begin_region("resolve");
    commands.end_rendering();
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
        if (pass.needed(required_)) draw_items(commands, view, pass.mode, RasterTarget::aovs);
    commands.end_rendering();
    commands.end_region();
}

std::vector<const RasterScene::Item*> RasterScene::ordered(AlphaMode mode, const View& view) const
{
    std::vector<const Item*> items;
    for (const Item& item : items_)
        if (item.mode == mode) items.push_back(&item);
    if (mode != AlphaMode::blend) return items;
    const auto depth = [&](const Item* item) {
        return -dot(item->center - eye_of(view), dvec3(view.world_from_camera[2]));
    };
    std::stable_sort(items.begin(), items.end(), [&](const Item* a, const Item* b) { return depth(a) > depth(b); });
    return items;
}

void RasterScene::draw_items(gpu::Commands& commands, const View& view, AlphaMode mode, RasterTarget target) const
{
    const gpu::GraphicsPipeline* bound = nullptr;
    std::optional<RasterShape> shape;
    for (const Item* item : ordered(mode, view)) {
        const gpu::GraphicsPipeline* pipeline = target == RasterTarget::color ? item->color : item->aovs;
        if (pipeline != bound) commands.bind(*pipeline);
        if (shape != item->shape) {
            commands.bind(frame_bindings_.at(item->shape));
            if (item->shape == RasterShape::mesh) geometry_.bind(commands);
        }
        commands.bind(*item->textures);
        bound = pipeline;
        shape = item->shape;
        if (item->shape == RasterShape::mesh)
            draw_mesh(commands, view, *item);
        else
            draw_sphere(commands, view, *item);
    }
}

void RasterScene::draw_mesh(gpu::Commands& commands, const View& view, const Item& item) const
{
    const Draw& draw = posed_.draws[item.index];
    const RasterGeometry::Range& range = geometry_.range(draw);
    shared::RasterDraw record{.object_rows = {},
                              .normal_matrix = mat3(1),
                              .handedness = 1,
                              .material = item.material,
                              .object_id = item.index + 1,
                              .first_face = range.first_face};
    place(draw.world_from_object, eye_of(view), record);
    commands.set_cull(item.culled ? VK_CULL_MODE_BACK_BIT : VK_CULL_MODE_NONE,
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
    commands.push(shared::RasterSphere{.center = vec3(sphere.center - eye_of(view)),
                                       .radius = static_cast<float>(sphere.radius),
                                       .material = item.material,
                                       .object_id = static_cast<std::uint32_t>(posed_.draws.size()) + item.index + 1});
    commands.draw(3);
    commands.set_scissor(0, 0, static_cast<std::uint32_t>(view.width), static_cast<std::uint32_t>(view.height));
}

Film RasterScene::read()
{
    assume(commands_.has_value());
    commands_->wait();
    const Stopwatch watch;
    Film film = read_targets(device_, targets_);
    read_milliseconds_ = watch.milliseconds();
    film.samples = variants_.samples();
    film.metadata["renderer"] = "raster";
    film.metadata["device"] = device_.description();
    film.metadata["msaa"] = std::to_string(variants_.samples());
    for (const StageTime& time : times())
        film.metadata["milliseconds." + time.name] = fmt::format("{:.3f}", time.milliseconds);
    return film;
}

std::vector<StageTime> RasterScene::times() const
{
    std::vector<StageTime> all = times_;
    if (commands_)
        for (const gpu::RegionTime& region : commands_->times()) all.push_back({region.name, region.milliseconds});
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
