#pragma once
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "engine/base/progress.h"
#include "engine/gpu/commands.h"
#include "engine/image/film.h"
#include "engine/render/environment.h"
#include "engine/render/path_gather.h"
#include "engine/render/raster_behind.h"
#include "engine/render/raster_emitters.h"
#include "engine/render/raster_filter.h"
#include "engine/render/raster_frame.h"
#include "engine/render/raster_geometry.h"
#include "engine/render/raster_pipelines.h"
#include "engine/render/raster_shadows.h"
#include "engine/render/raster_targets.h"
#include "engine/render/raster_textures.h"

namespace etalon {

/// What a stage of the rasterizer took. Work of the device by its own clock, the rest by the host's.
struct RasterStage {
    std::string name;
    double milliseconds = 0;
};

/// The names of the passes that make up a picture of these requirements, in order.
std::vector<std::string_view> raster_passes(const Requirements& required);

/// A posed scene on a device, ready to be drawn from any view: docs/shading.md §4. Geometry, textures, environment
/// tables and pipelines are made once, as `required` says. `posed` (with its scene) must outlive it; posed.view is not
/// used.
class RasterScene {
 public:
    /// Throws Error(machine) when the device lacks memory or so many samples of float colour, Error(input) when
    /// `required` lacks a material's model.
    RasterScene(gpu::Device& device, const PosedScene& posed, const Requirements& required,
                const RenderSettings& settings, const Progress& progress = {});

    /// Hands a picture of the scene to the device; what was drawn before is replaced. Its kind of camera (perspective
    /// or orthographic) must be that of the posed scene. Waits for the draw before it, not for this one.
    void draw(const View& view);
    /// The picture drawn last: linear premultiplied radiance, RGBA float32, one sample a pixel, in use `sampled`.
    gpu::Image& picture() { return targets_.picture(); }
    /// Waits for the picture and reads it, with its AOVs where settings ask for them.
    Film read();
    /// Of construction, the last draw and the last read.
    std::vector<RasterStage> times() const;

 private:
    /// A mesh primitive in one place, or a sphere.
    struct Item {
        RasterShape shape = RasterShape::mesh;
        std::uint32_t index = 0;  ///< of PosedScene::draws or spheres
        Index material = 0;
        AlphaMode mode = AlphaMode::opaque;
        const gpu::GraphicsPipeline* color = nullptr;
        const gpu::GraphicsPipeline* aovs = nullptr;             ///< null: not asked for
        const gpu::GraphicsPipeline* shadow = nullptr;           ///< null: no light needs it
        const gpu::GraphicsPipeline* parallel_shadow = nullptr;  ///< likewise
        const gpu::Bindings* textures = nullptr;
        bool transmits = false;  ///< drawn after what it shows, but for BLEND, which is drawn last anyway
        bool culled = false;     ///< back faces are not drawn
        bool mirrored = false;   ///< fronts are clockwise
        dvec3 center{0};         ///< world, metres: what BLEND is sorted by (SH-32)
    };
    void add_items(const Progress& progress);
    Item item_of(std::uint32_t draw);
    Item item_of_sphere(std::uint32_t sphere);
    void finish(Item& item, const RasterVariant& color, const std::optional<RasterVariant>& aovs);
    const gpu::Bindings& texture_bindings(const gpu::Layout& layout, const Material& material,
                                          const RasterVariant& variant);
    void add_environment();
    void add_background(bool environment);
    void add_albedo();
    using FrameBindings = std::map<RasterShape, gpu::Bindings>;
    FrameBindings bind_frame(const gpu::Buffer& frame, const gpu::Image& behind) const;
    /// All but those that read what is behind, which come and go with the targets.
    void bind_frames();
    /// The view with so many pixels as are drawn.
    View drawn(View view) const;
    void resize(const View& view);
    void write_lights(const View& view);
    /// `view` has so many pixels along a side of a pixel.
    void write_frame(const gpu::Buffer& frame, const View& view, int per_side, DepthKind depth);
    void draw_color(gpu::Commands& commands, const View& view);
    void draw_passes(gpu::Commands& commands, const View& view, bool behind);
    void draw_background(gpu::Commands& commands) const;
    void draw_aovs(gpu::Commands& commands, const View& view);
    void add_shadows();
    void add_rays(const Progress& progress);
    void trace_rays(const View& view);
    void draw_shadows(gpu::Commands& commands);
    const gpu::GraphicsPipeline& pipeline_of(const Item& item, RasterTarget target) const;
    /// The items that `wanted` says, in their order.
    struct Selection {
        AlphaMode mode = AlphaMode::opaque;
        bool transmits = false;  ///< of no meaning to BLEND
    };
    void draw_items(gpu::Commands& commands, const View& view, const Selection& wanted, RasterTarget target,
                    const FrameBindings& frame) const;
    /// Nothing of it can be seen from there.
    bool is_hidden(const Item& item, const View& view, RasterTarget target) const;
    void draw_mesh(gpu::Commands& commands, const View& view, const Item& item, RasterTarget target) const;
    void draw_sphere(gpu::Commands& commands, const View& view, const Item& item) const;
    std::vector<const Item*> ordered(const Selection& wanted, const View& view) const;
    bool draws_background() const { return background_ != nullptr; }

    gpu::Device& device_;
    const PosedScene& posed_;
    Requirements required_;
    RenderSettings settings_;
    RasterVariants variants_;
    std::vector<RasterStage> times_;
    double read_milliseconds_ = 0;
    RasterGeometry geometry_;
    RasterTextures textures_;
    RasterPipelines pipelines_;
    std::optional<EnvironmentTables> tables_;  // of a map
    gpu::Image atlas_;
    gpu::Image environment_map_;
    gpu::Buffer frame_;
    gpu::Buffer aov_frame_;  // of the picture's own pixels
    gpu::Buffer materials_;
    gpu::Buffer layers_;
    gpu::Buffer albedo_;  // shaders/shared/albedo.h; one cell where nothing needs it
    gpu::Buffer lights_;
    std::vector<RasterEmitter> emitters_;
    gpu::Buffer emitter_records_;
    std::vector<Item> items_;
    std::map<RasterTextures::Key, gpu::Bindings> texture_bindings_;
    const gpu::GraphicsPipeline* background_ = nullptr;  // null: cleared
    gpu::Bindings background_map_;
    std::optional<RasterBehind> behind_;  // nothing: no item transmits
    gpu::Image nothing_behind_;
    FrameBindings frame_bindings_;
    FrameBindings behind_bindings_;  // with the picture behind transmitting surfaces
    FrameBindings aov_bindings_;
    std::optional<RasterShadows> shadows_;  // nothing: lights cast none
    gpu::Buffer shadow_records_;
    std::vector<gpu::Buffer> shadow_frames_;  // of each map
    std::vector<FrameBindings> shadow_bindings_;
    bool shadows_drawn_ = false;
    std::optional<PathGather> rays_;  // nothing: no ray is asked for
    double rays_milliseconds_ = 0;
    gpu::Image nothing_lit_;
    std::optional<RasterFilter> filter_;  // nothing: a drawn pixel is a pixel
    RasterTargets targets_;
    std::optional<gpu::Commands> commands_;  // of the last draw
};

}  // namespace etalon
