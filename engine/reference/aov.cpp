#include "engine/reference/aov.h"

#include "engine/base/parallel.h"

namespace etalon::reference {
namespace {

void fill(Aovs& aovs, std::size_t pixel, const CameraRays& camera, const Surface& surface)
{
    aovs.depth[pixel] = static_cast<float>(camera.depth(surface.position));
    aovs.normal[pixel] = vec3(surface.n);
    aovs.albedo[pixel] = vec3(surface.point.color);
    aovs.emission[pixel] = vec3(surface.emission);
    aovs.object_id[pixel] = surface.object + 1;
    aovs.material_id[pixel] = surface.material + 1;
    aovs.uv[pixel] = vec2(surface.attributes.at.uv[0]);
}

}  // namespace

Aovs render_aovs(const World& world, const CameraRays& camera, bool cull_all, unsigned threads)
{
    const auto width = static_cast<std::size_t>(world.posed->view.width);
    const auto height = static_cast<std::size_t>(world.posed->view.height);
    const std::size_t count = width * height;
    Aovs aovs{.depth = std::vector<float>(count, std::numeric_limits<float>::infinity()),
              .normal = std::vector<vec3>(count, vec3(0)),
              .albedo = std::vector<vec3>(count, vec3(0)),
              .emission = std::vector<vec3>(count, vec3(0)),
              .object_id = std::vector<std::uint32_t>(count, 0),
              .material_id = std::vector<std::uint32_t>(count, 0),
              .uv = std::vector<vec2>(count, vec2(0))};
    parallel_for(
        height,
        [&](std::size_t y) {
            for (std::size_t x = 0; x < width; ++x) {
                const Ray ray = camera.pinhole({static_cast<double>(x) + 0.5, static_cast<double>(y) + 0.5});
                // BLEND counts as a surface wherever it is not wholly clear.
                const auto hit =
                    world.index.closest(ray, [&](const Hit& h) { return opacity(world, ray, h, cull_all) > 0; });
                if (hit) fill(aovs, y * width + x, camera, surface_at(world, ray, *hit));
            }
        },
        threads);
    return aovs;
}

}  // namespace etalon::reference
