// A scene in a window: SCENE [--renderer raster|path] [--size WxH] [--device NAME] [--frames N] [--screenshot FILE.png]
// [--validate]. The whole of the command line is `etalon view`; this is how a program of one's own would do it.
#include <cstdio>
#include <cstdlib>
#include <string>
#include <string_view>

#include "engine/base/error.h"
#include "engine/scene/load.h"
#include "samples/viewer/viewer.h"

namespace {

using etalon::Blame;
using etalon::Error;

struct Arguments {
    std::string scene;
    etalon::ViewOptions view;
};

etalon::ivec2 parse_size(const std::string& text)
{
    etalon::ivec2 size(0);
    if (std::sscanf(text.c_str(), "%dx%d", &size.x, &size.y) != 2 || size.x < 1 || size.y < 1)
        throw Error(Blame::input, "\"" + text + "\" is no size such as 1280x720");
    return size;
}

void set_option(Arguments& arguments, std::string_view name, const std::string& value)
{
    if (name == "--renderer" && value == "raster")
        arguments.view.render.renderer = etalon::Renderer::raster;
    else if (name == "--renderer" && value == "path")
        arguments.view.render.renderer = etalon::Renderer::path;
    else if (name == "--size")
        arguments.view.pose.size = parse_size(value);
    else if (name == "--device")
        arguments.view.device.device = value;
    else if (name == "--frames")
        arguments.view.frames = std::strtoull(value.c_str(), nullptr, 10);
    else if (name == "--screenshot")
        arguments.view.screenshot = value;
    else
        throw Error(Blame::input, "what does " + std::string(name) + " " + value + " mean?");
}

Arguments parse(int count, char** words)
{
    Arguments arguments;
    arguments.view.render.spp = 4096;  // a window need not stop where a file would
    for (int i = 1; i < count; ++i) {
        const std::string_view word = words[i];
        if (word == "--validate")
            arguments.view.device.validate = true;
        else if (word.starts_with("--") && i + 1 < count)
            set_option(arguments, word, words[++i]);
        else if (arguments.scene.empty())
            arguments.scene = word;
        else
            throw Error(Blame::input, "one scene at a time, please: " + std::string(word));
    }
    if (arguments.scene.empty()) throw Error(Blame::input, "which scene?", "builtin:cornell, or a glTF file");
    return arguments;
}

}  // namespace

int main(int count, char** words)
{
    try {
        Arguments arguments = parse(count, words);
        int faults = 0;
        arguments.view.device.on_message = [&](const std::string& message) {
            ++faults;
            std::fprintf(stderr, "%s\n", message.c_str());
        };
        const etalon::Scene scene = etalon::load_scene(arguments.scene);
        etalon::view(scene, arguments.view);
        return faults == 0 ? 0 : 1;
    } catch (const Error& error) {
        std::fprintf(stderr, "%s\n", error.message().c_str());
        return error.exit_code();
    }
}
