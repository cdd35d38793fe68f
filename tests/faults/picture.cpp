#include "tests/faults/picture.h"

#include <algorithm>
#include <cstdlib>
#include <cstring>
#include <new>
#include <random>
#include <set>
#include <string_view>

#include "engine/reference/reference.h"
#include "engine/render/render.h"
#include "engine/scene/load.h"

namespace etalon::test {
namespace {

template <class T>
bool same(const std::vector<T>& a, const std::vector<T>& b)
{
    return a.size() == b.size() && (a.empty() || std::memcmp(a.data(), b.data(), a.size() * sizeof(T)) == 0);
}

PoseSettings sized(int side)
{
    PoseSettings settings;
    settings.size = ivec2(side);
    return settings;
}

RenderSettings of(Renderer renderer, std::uint64_t spp)
{
    RenderSettings settings;
    settings.renderer = renderer;
    settings.spp = spp;
    settings.threads = 1;
    settings.aovs = true;
    return settings;
}

}  // namespace

Picture::Picture(const std::string& builtin, Renderer renderer, int side, std::uint64_t spp)
    : scene_(load_scene("builtin:" + builtin)),
      posed_(pose(scene_, sized(side))),
      settings_(of(renderer, spp)),
      required_(require(posed_, settings_))
{}

Film Picture::render(gpu::Device* device) const
{
    switch (settings_.renderer) {
        case Renderer::raster:
            return render_raster(*device, posed_, required_, settings_, {});
        case Renderer::path:
            return render_path(*device, posed_, required_, settings_, {});
        case Renderer::reference:
            return reference::render_path(posed_, required_, settings_, {});
        case Renderer::reference_raster:
            return reference::render_raster(posed_, required_, settings_, {});
    }
    return {};
}

Outcome attempt(const std::function<void()>& action)
{
    try {
        action();
    } catch (const Error& error) {
        return {.blame = error.blame(), .message = error.message()};
    } catch (const std::bad_alloc&) {
        return {.blame = Blame::machine, .message = "out of memory", .out_of_memory = true};
    }
    return {};
}

bool same_bits(const Film& a, const Film& b)
{
    return a.width == b.width && a.height == b.height && a.samples == b.samples && same(a.mean, b.mean) &&
           same(a.variance, b.variance) && same(a.alpha, b.alpha) && same(a.aovs.depth, b.aovs.depth) &&
           same(a.aovs.normal, b.aovs.normal) && same(a.aovs.albedo, b.aovs.albedo) &&
           same(a.aovs.object_id, b.aovs.object_id);
}

bool every_fault()
{
    const char* const how = std::getenv("ETALON_FAULTS");
    return how != nullptr && std::string_view(how) == "every";
}

std::vector<std::size_t> faults_to_try(std::size_t count, std::size_t few)
{
    std::set<std::size_t> chosen;
    if (every_fault() || count <= few) {
        for (std::size_t i = 0; i < count; ++i) chosen.insert(i);
    } else {
        chosen = {0, 1, count - 1};
        std::mt19937_64 random(count);
        while (chosen.size() < few) chosen.insert(random() % count);
    }
    return {chosen.begin(), chosen.end()};
}

}  // namespace etalon::test
