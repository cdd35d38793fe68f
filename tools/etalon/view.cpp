#include "engine/base/error.h"
#include "samples/viewer/viewer.h"
#include "tools/etalon/arguments.h"
#include "tools/etalon/interrupt.h"
#include "tools/etalon/output.h"
#include "tools/etalon/scenes.h"
#include "tools/etalon/settings.h"
#include "tools/etalon/terminal.h"

namespace etalon::cli {

int view(const Arguments& arguments)
{
    const Interrupt interrupt;
    ViewOptions options{.pose = pose_settings(arguments),
                        .render = render_settings(arguments),
                        .develop = develop_settings(arguments),
                        .device = device_options(arguments),
                        .frames = arguments.count("frames", 1, ~std::uint64_t{0}),
                        .screenshot = arguments.text("screenshot").value_or(""),
                        .stop = interrupt.flag()};
    if (!arguments.has("spp")) options.render.spp = kViewSamples;
    if (!options.screenshot.empty()) check_output(options.screenshot.string());
    const Scene scene = open_scene(arguments.positional().front(), arguments);
    say(view_help());
    etalon::view(scene, options);
    return interrupt.stopped() ? interrupt.exit_code() : 0;
}

}  // namespace etalon::cli
