#include "engine/render/prepared.h"

#include <fmt/format.h>

#include <algorithm>
#include <list>
#include <optional>
#include <string>

#include "engine/base/error.h"
#include "engine/render/path.h"
#include "engine/render/raster.h"
#include "engine/scene/knobs.h"
#include "engine/scene/requirements.h"

namespace etalon {
namespace {

/// All that a scene on the device is made for: everything but samples and seed.
std::string key_of(const RenderSettings& settings)
{
    const dvec3 b = settings.background_color;
    std::string key = fmt::format("{} {} {} {} {} {} {} {}/{}", name(settings.renderer),
                                  static_cast<int>(settings.shading), static_cast<int>(settings.background), b.x, b.y,
                                  b.z, settings.aovs, settings.shard.number, settings.shard.count);
    for (const Knob& knob : knobs())
        if (knob.name != "spp") key += fmt::format(" {}", knob_value(settings, knob.name));
    return key;
}

Film trace(PathTracer& tracer, const View& view, const RenderSettings& settings, const Progress& progress)
{
    tracer.start(view, settings.seed);
    const auto has_something = [&] { return tracer.samples() > 0 || tracer.pass_fraction() > 0; };
    while (tracer.samples() < settings.spp && !(progress.stopped() && has_something())) tracer.step(settings.spp);
    if (tracer.samples() == 0) tracer.stop_pass();
    return tracer.film();
}

}  // namespace

struct PreparedScene::State {
    struct Kept {
        std::string key;
        std::optional<RasterScene> raster{};
        std::optional<PathTracer> tracer{};
    };

    gpu::Device& device;
    const PosedScene& posed;
    std::size_t most;
    std::list<Kept> kept{};  ///< the one used last in front

    Kept& of(const RenderSettings& settings, const Progress& progress)
    {
        const std::string key = key_of(settings);
        const auto found = std::find_if(kept.begin(), kept.end(), [&](const Kept& one) { return one.key == key; });
        if (found != kept.end()) {
            kept.splice(kept.begin(), kept, found);
            return kept.front();
        }
        // Room first: the device need not hold one more than allowed.
        while (kept.size() >= most) kept.pop_back();
        const Requirements required = require(posed, settings);
        std::list<Kept> one;  // where nothing is half made when this throws
        one.push_back({.key = key});
        if (settings.renderer == Renderer::raster)
            one.front().raster.emplace(device, posed, required, settings, progress);
        else
            one.front().tracer.emplace(device, posed, required, settings, progress);
        kept.splice(kept.begin(), one);
        return kept.front();
    }
};

PreparedScene::PreparedScene(gpu::Device& device, const PosedScene& posed, std::size_t most)
    : state_(new State{.device = device, .posed = posed, .most = std::max<std::size_t>(most, 1)})
{}
PreparedScene::PreparedScene(PreparedScene&&) noexcept = default;
PreparedScene& PreparedScene::operator=(PreparedScene&&) noexcept = default;
PreparedScene::~PreparedScene() = default;

std::size_t PreparedScene::size() const
{
    return state_->kept.size();
}

Film PreparedScene::draw(const RenderSettings& settings, const Progress& progress)
{
    assume(settings.renderer == Renderer::raster || settings.renderer == Renderer::path);
    State::Kept& kept = state_->of(settings, progress);
    const View& view = state_->posed.view;
    if (kept.tracer) return trace(*kept.tracer, view, settings, progress);
    kept.raster->draw(view);
    return kept.raster->read();
}

}  // namespace etalon
