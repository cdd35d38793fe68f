#include "samples/viewer/viewer.h"

#include <fmt/format.h>

#include <cstdio>

#include "engine/base/error.h"
#include "engine/gpu/swapchain.h"
#include "engine/image/io.h"
#include "engine/render/raster.h"
#include "engine/scene/requirements.h"
#include "samples/viewer/display.h"
#include "samples/viewer/orbit_camera.h"
#include "samples/viewer/path_picture.h"
#include "samples/viewer/window.h"

namespace etalon {
namespace {

constexpr double kIdle = 0.05;  // seconds between looks for a better picture when nothing moves

ivec2 first_size(const ViewOptions& options)
{
    return options.pose.size.value_or(ivec2(1280, 720));
}

PosedScene posed_for(const Scene& scene, const ViewOptions& options)
{
    PoseSettings settings = options.pose;
    settings.size = first_size(options);
    return pose(scene, settings);
}

gpu::Device device_for(const Window& window, gpu::DeviceOptions options)
{
    window.require(options);
    return gpu::Device(options);
}

/// Everything between opening and closing; members are destroyed from the last to the first.
class Viewer {
 public:
    Viewer(const Scene& scene, const ViewOptions& options)
        : options_(options),
          posed_(posed_for(scene, options)),
          camera_(posed_.view, posed_.bounds_min, posed_.bounds_max),
          window_(fmt::format("etalon: {}", scene.name), first_size(options)),
          device_(device_for(window_, options.device)),
          swapchain_(device_, extent().x, extent().y),
          display_(device_, swapchain_.format()),
          shown_(options.render.renderer),
          title_(scene.name)
    {
        if (shown_ != Renderer::raster && shown_ != Renderer::path)
            throw Error(Blame::input, "a window shows the renderers raster and path",
                        "render the reference to a file with `etalon render`");
        size_ = window_.size();
    }

    void run()
    {
        std::uint64_t shown = 0;
        while (!(options_.stop != nullptr && options_.stop->load()) && (!options_.frames || shown < *options_.frames)) {
            const WindowInput input = window_.poll(patience());
            if (input.close) break;
            apply(input);
            follow_size();
            if (minimised()) continue;
            update_picture();
            if (drawn_ && !options_.frames) continue;
            if (show()) ++shown;
        }
        device_.wait_idle();
        if (!options_.screenshot.empty() && picture_ != nullptr)
            write_png(develop_on(device_, *picture_, options_.develop), {}, options_.screenshot);
    }

 private:
    uvec2 extent() const { return uvec2(glm::max(window_.size(), ivec2(0))); }

    bool minimised() const { return size_.x == 0 || size_.y == 0; }

    /// Seconds to wait for the user before the next turn of the loop.
    double patience() const
    {
        if (minimised() || picture_ == nullptr) return kIdle;
        return drawn_ && !options_.frames ? kIdle : 0;
    }

    void apply(const WindowInput& input)
    {
        const bool moves = input.orbit != dvec2(0) || input.pan != dvec2(0) || input.zoom != 0;
        camera_.orbit(input.orbit.x, input.orbit.y);
        camera_.pan(input.pan.x, input.pan.y);
        camera_.zoom(input.zoom);
        if (moves) moved_ = true;
        for (const char key : input.keys) press(key);
    }

    void press(char key)
    {
        if (key == 'H' || key == '?') std::fputs(view_help(), stderr);
        if (key == 'F') {
            camera_.frame(double(size_.x) / std::max(size_.y, 1));
            moved_ = true;
        }
        if (key == 'R') switch_to(Renderer::raster);
        if (key == 'P') switch_to(Renderer::path);
    }

    void switch_to(Renderer renderer)
    {
        if (shown_ == renderer) return;
        shown_ = renderer;
        path_.reset();  // two renderers at once would only slow each other down
        moved_ = true;
    }

    void follow_size()
    {
        const ivec2 now = window_.size();
        if (now == size_ && !stale_) return;
        if (now != size_) moved_ = true;
        size_ = now;
        stale_ = false;
        swapchain_.resize(extent().x, extent().y);
        drawn_ = false;
    }

    /// Brings the linear picture up to date with the camera, as far as it is ready.
    void update_picture()
    {
        if (shown_ == Renderer::raster) {
            if (moved_) draw_raster();
            return;
        }
        if (!path_) path_.emplace(device_, posed_, options_.render);
        if (moved_) path_->start(camera_.view(size_));
        moved_ = false;
        if (const std::optional<Film> film = path_->take()) take_film(*film);
    }

    void draw_raster()
    {
        device_.wait_idle();  // its picture may be on its way to the window, and is replaced when the size changes
        if (!raster_) raster_.emplace(device_, posed_, require(posed_, raster_settings()), raster_settings());
        raster_->draw(camera_.view(size_));
        set_picture(raster_->picture(), "raster");
        moved_ = false;
    }

    RenderSettings raster_settings() const
    {
        RenderSettings settings = options_.render;
        settings.renderer = Renderer::raster;
        settings.aovs = false;
        return settings;
    }

    void take_film(const Film& film)
    {
        std::vector<float> texels(4 * film.pixel_count());
        for (std::size_t i = 0; i < film.pixel_count(); ++i) {
            const float rgba[] = {film.mean[i].x, film.mean[i].y, film.mean[i].z, film.alpha[i]};
            std::copy_n(rgba, 4, &texels[4 * i]);
        }
        device_.wait_idle();
        film_ = gpu::Image(device_, {.format = VK_FORMAT_R32G32B32A32_SFLOAT,
                                     .width = static_cast<std::uint32_t>(film.width),
                                     .height = static_cast<std::uint32_t>(film.height),
                                     .usage = VK_IMAGE_USAGE_SAMPLED_BIT,
                                     .name = "film"});
        const gpu::ImagePart all{.texels = std::as_bytes(std::span(texels))};
        gpu::upload(device_, film_, std::span(&all, 1));
        set_picture(film_, fmt::format("path, {} {}", film.samples, film.samples == 1 ? "sample" : "samples"));
    }

    void set_picture(const gpu::Image& picture, const std::string& what)
    {
        picture_ = &picture;
        display_.set_picture(picture);
        window_.set_title(fmt::format("etalon: {} ({})", title_, what));
        drawn_ = false;
    }

    bool show()
    {
        if (picture_ == nullptr) return false;
        const bool done = swapchain_.draw([&](gpu::Commands& commands, gpu::Image& target) {
            display_.record(commands, target, options_.develop);
            commands.prepare(target, gpu::ImageUse::present);
        });
        stale_ = !done;
        drawn_ = done;
        return done;
    }

    const ViewOptions& options_;
    PosedScene posed_;
    OrbitCamera camera_;
    Window window_;
    gpu::Device device_;
    gpu::Swapchain swapchain_;
    Display display_;
    std::optional<RasterScene> raster_;
    gpu::Image film_;
    std::optional<PathPicture> path_;
    Renderer shown_;
    std::string title_;
    ivec2 size_{0};
    const gpu::Image* picture_ = nullptr;  ///< what the window shows: raster_'s or film_
    bool moved_ = true;                    ///< the camera, since the picture was made
    bool drawn_ = false;                   ///< the window shows the newest picture
    bool stale_ = false;                   ///< the swapchain no longer fits the window
};

}  // namespace

const char* view_help()
{
    return "left drag    turn\n"
           "right drag   move (middle too)\n"
           "wheel        nearer, farther\n"
           "F            frame the scene\n"
           "R            rasterizer\n"
           "P            path tracer\n"
           "H, ?         these keys\n"
           "Esc          close\n";
}

void view(const Scene& scene, const ViewOptions& options)
{
    Viewer(scene, options).run();
}

}  // namespace etalon
