#include "engine/render/raster.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>

#include "engine/base/error.h"
#include "engine/image/mips.h"
#include "engine/render/albedo.h"
#include "engine/render/material.h"
#include "engine/scene/knobs.h"

namespace etalon {
namespace {

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
auto timed(std::vector<RasterStage>& times, const char* name, Make make)
{
    const Stopwatch watch;
    auto made = make();
    times.push_back({name, watch.milliseconds()});
    return made;
}

/// Throws Error(machine) with what the device can do.
void check_samples(const gpu::Device& device, std::uint32_t samples)
{
    const auto can = [&](std::uint32_t count) {
        return (device.limits().samples & count) != 0 &&
               device.supports(kRasterColor, VK_FORMAT_FEATURE_COLOR_ATTACHMENT_BIT, count);
    };
    if (can(samples)) return;
    std::string counts;
    for (const std::uint32_t count : {1u, 2u, 4u, 8u, 16u})
        if (can(count)) counts += fmt::format("{}{}", counts.empty() ? "" : ", ", count);
    throw Error(Blame::machine, fmt::format("{} cannot draw {} samples a pixel in float32", device.name(), samples),
                fmt::format("--msaa may be {}; --ssaa draws any number of pixels for one", counts));
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
      textures_(device, *posed.scene, settings.mipmaps && required.has(Feature::mipmaps), settings.texture_filter,
                settings.threads),
      pipelines_(device, geometry_.streams(), RasterGeometry::attributes()),
      frame_(device, {.size = sizeof(shared::RasterFrame), .memory = gpu::MemoryKind::upload, .name = "frame"}),
      aov_frame_(device, {.size = sizeof(shared::RasterFrame), .memory = gpu::MemoryKind::upload, .name = "AOV frame"}),
      materials_(gpu::make_buffer(device, pack_materials(posed.materials()), "materials")),
      layers_(gpu::make_buffer(device, pack_layers(posed.materials()), "material layers")),
      lights_(device, {.size = posed.lights.size() * sizeof(shared::LightRecord),
                       .memory = gpu::MemoryKind::upload,
                       .name = "lights"}),
      emitters_(required.has(Feature::emission) ? find_emitters(posed) : std::vector<RasterEmitter>{}),
      emitter_records_(device, {.size = emitters_.size() * sizeof(shared::EmitterRecord),
                                .memory = gpu::MemoryKind::upload,
                                .name = "emitters"})
{
    check_knobs(settings);
    check_samples(device, variants_.samples());
    if (!device.supports(depth_format(settings.depth), VK_FORMAT_FEATURE_DEPTH_STENCIL_ATTACHMENT_BIT,
                         variants_.samples()))
        throw Error(Blame::machine,
                    fmt::format("{} has no depth of the kind {}", device.name(), knob_value(settings, "depth")),
                    "render with --depth reversed-32");
    if (RasterFilter::is_needed(settings)) filter_.emplace(device, settings);
    add_items(progress);
    if (std::any_of(items_.begin(), items_.end(), [](const Item& item) { return item.transmits; }))
        behind_.emplace(device);
    add_environment();
    add_albedo();
    add_shadows();
    add_rays(progress);
    nothing_behind_ = upload_picture(device, Image(), "nothing behind");
    bind_frames();
}

void RasterScene::bind_frames()
{
    frame_bindings_ = bind_frame(frame_, nothing_behind_);
    shadow_bindings_.clear();
    for (const gpu::Buffer& frame : shadow_frames_) shadow_bindings_.push_back(bind_frame(frame, nothing_behind_));
    if (settings_.aovs && required_.has(Feature::aovs)) aov_bindings_ = bind_frame(aov_frame_, nothing_behind_);
}

void RasterScene::add_environment()
{
    const Environment& environment = posed_.environment;
    const bool mapped = environment.map && !environment.is_black() && required_.has(Feature::environment_map);
    if (mapped) tables_ = timed(times_, "environment", [&] { return tabulate(*environment.map, settings_.threads); });
    atlas_ = upload_picture(device_, mapped ? tables_->atlas : Image(), "environment tables");

    const bool shines = !environment.is_black() && (mapped || required_.has(Feature::environment_constant));
    const bool seen = settings_.background == Background::environment;
    if (seen && shines && required_.has(Feature::visible_background))
        add_background(true);
    else if (behind_ && settings_.background != Background::transparent)
        add_background(false);  // drawn, not cleared: what is seen through surfaces has no background
}

void RasterScene::add_background(bool environment)
{
    background_ = &pipelines_.get(variants_.background(environment));
    const bool mapped = environment && tables_.has_value();
    const int most = static_cast<int>(std::min(device_.limits().image_side, 1u << 15));
    const Image* map = mapped ? posed_.environment.map.get() : nullptr;
    if (map != nullptr && (map->width > most || map->height > most))
        environment_map_ = upload_picture(
            device_, shrink(*map, std::min(map->width, most), std::min(map->height, most), settings_.threads),
            "environment");
    else
        environment_map_ = upload_picture(device_, map != nullptr ? *map : Image(), "environment");
    background_map_ = {device_, background_->layout(), {{0, environment_map_}}, 1};
}

void RasterScene::add_albedo()
{
    bool any = false, sheen = false;
    for (const Item& item : items_) {
        const Material& material = posed_.materials()[item.material];
        const bool own = variants_.has_layers(material);
        any |= own || variants_.is_glossy(material);
        sheen |= own && material.layers && material.layers->sheen_color != dvec3(0);
    }
    const bool reflects = !posed_.environment.is_black();
    const auto make = [&] {
        return reflects ? make_raster_albedo_cells(sheen, settings_.threads)
                        : make_albedo_cells(sheen, settings_.threads);
    };
    const std::vector<vec4> cells = any ? timed(times_, "albedo", make) : std::vector<vec4>{vec4(1)};
    albedo_ = gpu::make_buffer(device_, cells, "albedo");
}

void RasterScene::add_shadows()
{
    if (variants_.shadows() == Shadows::map) shadows_.emplace(device_, posed_);
    const std::size_t records = std::max<std::size_t>(1, shadows_ ? 6 * posed_.lights.size() : 0);
    shadow_records_ = {
        device_,
        {.size = records * sizeof(shared::RasterShadow), .memory = gpu::MemoryKind::upload, .name = "shadow records"}};
    if (!shadows_) return;
    bool cones = false, parallel = false;
    for (const RasterShadows::Map& map : shadows_->maps()) {
        (map.parallel ? parallel : cones) = true;
        shadow_frames_.emplace_back(device_, gpu::BufferSpec{.size = sizeof(shared::RasterFrame),
                                                             .memory = gpu::MemoryKind::upload,
                                                             .name = "shadow frame"});
        write_frame(shadow_frames_.back(), map.view, 1, DepthKind::reversed_32);
    }
    for (Item& item : items_) {
        if (item.mode == AlphaMode::blend) continue;
        const auto variant = [&](RasterTarget target) {
            return item.shape == RasterShape::mesh ? variants_.of(posed_.draws[item.index], target)
                                                   : variants_.of(posed_.spheres[item.index], target);
        };
        if (cones) item.shadow = &pipelines_.get(variant(RasterTarget::shadow));
        if (parallel) item.parallel_shadow = &pipelines_.get(variant(RasterTarget::parallel_shadow));
    }
}

void RasterScene::add_rays(const Progress& progress)
{
    nothing_lit_ = {device_,
                    {.format = VK_FORMAT_R32G32B32A32_UINT,
                     .width = 1,
                     .height = 1,
                     .usage = VK_IMAGE_USAGE_SAMPLED_BIT,
                     .name = "nothing lit"}};
    const uvec4 nothing(0);
    gpu::upload(device_, nothing_lit_, std::array{gpu::ImagePart{.texels = std::as_bytes(std::span(&nothing, 1))}});
    const PathGather::Wanted wanted{.paths = variants_.gathers_light() ? settings_.ambient_rays : 0,
                                    .shadows = variants_.shadows() == Shadows::ray};
    if (wanted.paths == 0 && !wanted.shadows) return;
    const Stopwatch watch;
    rays_.emplace(device_, posed_, settings_, wanted, progress);
    times_.push_back({"scene for rays", watch.milliseconds()});
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
    const Material& material = posed_.materials()[item.material];
    item.mode = material.alpha_mode;
    item.transmits = color.get(RasterConstant::transmission) != 0;
    textures_.require(material, color);
    item.color = &pipelines_.get(color);
    if (aovs) item.aovs = &pipelines_.get(*aovs);
    item.textures = &texture_bindings(item.color->layout(), material, color);
}

const gpu::Bindings& RasterScene::texture_bindings(const gpu::Layout& layout, const Material& material,
                                                   const RasterVariant& variant)
{
    RasterTextures::Key key = RasterTextures::key(material, variant);
    const auto found = texture_bindings_.find(key);
    if (found != texture_bindings_.end()) return found->second;
    return texture_bindings_.emplace(std::move(key), textures_.bind(layout, material, variant)).first->second;
}

RasterScene::FrameBindings RasterScene::bind_frame(const gpu::Buffer& frame, const gpu::Image& behind) const
{
    FrameBindings bindings;
    const auto bind = [&](RasterShape shape, const gpu::GraphicsPipeline& pipeline) {
        if (bindings.contains(shape)) return;
        const std::vector<gpu::Bind> binds{{0, frame},
                                           {1, materials_},
                                           {2, lights_},
                                           {3, geometry_.face_normals()},
                                           {4, emitter_records_},
                                           {5, atlas_},
                                           {6, layers_},
                                           {7, albedo_},
                                           {8, behind},
                                           {9, shadow_records_},
                                           {10, shadows_ ? shadows_->depths() : albedo_},  // the latter is not read
                                           {11, rays_ ? rays_->light() : nothing_behind_},
                                           {12, rays_ ? rays_->lit() : nothing_lit_}};
        bindings.emplace(shape, gpu::Bindings(device_, pipeline.layout(), binds, 0));
    };
    for (const Item& item : items_) bind(item.shape, *item.color);
    if (draws_background()) bind(RasterShape::background, *background_);
    return bindings;
}

}  // namespace etalon
