// A program of another project: renders a built-in scene on the CPU and on the Vulkan device, and checks that both are
// pictures.
#include <cstdio>

#include "engine/image/develop.h"
#include "engine/image/io.h"
#include "engine/reference/reference.h"
#include "engine/render/render.h"
#include "engine/scene/load.h"

namespace {

bool is_picture(const etalon::Film& film)
{
    const etalon::FilmCheck findings = check(film);
    return film.width == 24 && findings.nan_pixels == 0 && !findings.single_colour;
}

}  // namespace

int main(int, char** argv)
{
    using namespace etalon;
    const Scene scene = load_scene("builtin:cornell");
    const PosedScene posed = pose(scene, {.size = ivec2(24, 24)});
    const RenderSettings settings{.spp = 4};
    const Requirements required = require(posed, settings);

    const Film reference = reference::render_path(posed, required, settings, Progress{});
    gpu::Device device;
    const Film raster = render_raster(device, posed, required, settings, Progress{});
    write_png(develop(reference, {}), {}, argv[1]);

    const bool sound = is_picture(reference) && is_picture(raster);
    std::puts(sound ? "consumer: two pictures" : "consumer: no pictures");
    return sound ? 0 : 1;
}
