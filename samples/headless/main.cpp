// The whole flow on one page: load a scene, pose it, ask what it requires, render it, develop the film, write the
// picture.
#include <cstdio>

#include "engine/base/error.h"
#include "engine/image/develop.h"
#include "engine/image/io.h"
#include "engine/render/render.h"
#include "engine/scene/load.h"

int main(int argc, char** argv)
{
    using namespace etalon;
    try {
        const Scene scene = load_scene(argc > 1 ? argv[1] : "builtin:cornell");
        const PosedScene posed = pose(scene, {.size = ivec2(320, 320)});

        RenderSettings settings;
        settings.renderer = Renderer::path;
        settings.spp = 64;
        const Requirements required = require(posed, settings);

        gpu::Device device;  // the best Vulkan device of this machine; a software one will do
        const Film film = render_path(device, posed, required, settings, Progress{});

        write_png(develop(film, {.exposure = 0, .tone = Tone::neutral}), {}, argc > 2 ? argv[2] : "headless.png");
        if (const auto error = estimate_error(film))
            std::printf("%s: relative error %.2f%%\n", scene.name.c_str(), 100 * error->relative);
        return 0;
    } catch (const Error& error) {
        std::fprintf(stderr, "%s\n", error.message().c_str());
        return error.exit_code();
    }
}
