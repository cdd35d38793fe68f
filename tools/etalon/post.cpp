#include "engine/image/post.h"

#include <fmt/format.h>

#include "engine/base/error.h"
#include "engine/image/io.h"
#include "tools/etalon/arguments.h"
#include "tools/etalon/json.h"
#include "tools/etalon/output.h"
#include "tools/etalon/renderers.h"
#include "tools/etalon/settings.h"
#include "tools/etalon/terminal.h"

namespace etalon::cli {

int post(const Arguments& arguments)
{
    const std::string& input = arguments.positional().front();
    const std::vector<std::string> outputs = arguments.all("output");
    if (outputs.empty())
        throw Error(Blame::input, "post needs to know where to write", "add -o FILE.png, -o FILE.exr or -o -");
    for (const std::string& output : outputs) {
        if (output == "-" && arguments.has("json"))
            throw Error(Blame::input, "-o - and --json both want standard output", "leave one of them out");
        check_output(output);
    }
    if (!arguments.has("post"))
        throw Error(Blame::input, "post needs to know which passes",
                    "add --post PASSES; etalon post --help lists them");
    const PostChain chain = parse_post(*arguments.text("post"));
    const DevelopSettings develop = develop_settings(arguments);
    const Renderer renderer = arguments.has("reference") ? Renderer::reference : Renderer::raster;
    Renderers renderers(arguments);
    std::vector<StageTime> stages;
    Film film = read_film(input);
    const std::string before = film.metadata.contains("post") ? film.metadata.at("post") + "," : "";
    try {
        film = renderers.post(std::move(film), chain, renderer, stages);
    } catch (Error& error) {
        error.at(input);
        throw;
    }
    film.metadata["post"] = before + describe(chain);
    for (const std::string& output : outputs) write_output(film, develop, output);

    const std::string error = describe_error(film, renderer);
    say(fmt::format("{}: {}x{}; error {}", outputs.front() == "-" ? "standard output" : outputs.front(), film.width,
                    film.height, error));
    const std::vector<std::string> findings = suspicions(film);
    for (const std::string& finding : findings) warn(Terminal::of_standard_error(), finding);
    if (!arguments.has("json")) return 0;
    std::vector<std::pair<std::string, Json>> seconds;
    for (const StageTime& stage : stages) seconds.emplace_back(stage.stage, stage.seconds);
    put(Json::object({{"schema", "etalon-post/1"},
                      {"outputs", outputs},
                      {"post", film.metadata.at("post")},
                      {"device", renderers.device_of(renderer)},
                      {"seconds", Json::object(seconds)},
                      {"error_text", error},
                      {"findings", findings}})
            .text() +
        "\n");
    return 0;
}

}  // namespace etalon::cli
