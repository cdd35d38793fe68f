// A program of another project: renders a built-in scene with the reference and checks that the picture is one.
#include <cstdio>

#include "engine/image/develop.h"
#include "engine/image/io.h"
#include "engine/reference/reference.h"
#include "engine/render/render.h"
#include "engine/scene/load.h"

int main(int, char** argv)
{
    using namespace etalon;
    const Scene scene = load_scene("builtin:cornell");
    const PosedScene posed = pose(scene, {.size = ivec2(24, 24)});
    const RenderSettings settings{.renderer = Renderer::reference, .spp = 4};
    const Film film = reference::render_path(posed, require(posed, settings), settings, Progress{});
    write_png(develop(film, {}), {}, argv[1]);

    // The device side links as well; whether a device is there is not asked here.
    const auto vulkan = static_cast<Film (*)(gpu::Device&, const PosedScene&, const Requirements&,
                                             const RenderSettings&, const Progress&)>(&render_path);
    const FilmCheck findings = check(film);
    const bool sound = vulkan != nullptr && film.samples == 4 && findings.nan_pixels == 0 && !findings.single_colour;
    std::puts(sound ? "consumer: a picture" : "consumer: no picture");
    return sound ? 0 : 1;
}
