#include <fmt/format.h>

#include "engine/base/error.h"
#include "engine/image/io.h"
#include "engine/image/shard.h"
#include "tools/etalon/arguments.h"
#include "tools/etalon/json.h"
#include "tools/etalon/output.h"
#include "tools/etalon/renderers.h"
#include "tools/etalon/settings.h"
#include "tools/etalon/terminal.h"

namespace etalon::cli {

int merge(const Arguments& arguments)
{
    const std::vector<std::string> outputs = arguments.all("output");
    if (outputs.empty())
        throw Error(Blame::input, "merge needs to know where to write", "add -o FILE.exr, -o FILE.png or -o -");
    for (const std::string& output : outputs) {
        if (output == "-" && arguments.has("json"))
            throw Error(Blame::input, "-o - and --json both want standard output", "leave one of them out");
        check_output(output);
    }
    const DevelopSettings develop = develop_settings(arguments);
    std::vector<NamedFilm> shards;
    for (const std::string& file : arguments.positional()) shards.push_back({file, read_film(file)});
    const std::size_t count = shards.size();
    Film film = merge_shards(std::move(shards));
    film.metadata["error"] = describe_error(film, Renderer::path);
    film.metadata["samples"] = fmt::format("{}", film.samples);
    for (const std::string& output : outputs) write_output(film, develop, output);

    say(fmt::format("{}: {}x{} of {} shards, {} spp; error {}", outputs.front(), film.width, film.height, count,
                    film.samples, film.metadata.at("error")));
    const std::vector<std::string> findings = suspicions(film);
    for (const std::string& finding : findings) warn(Terminal::of_standard_error(), finding);
    if (arguments.has("json"))
        put(Json::object({{"schema", "etalon-merge/1"},
                          {"outputs", outputs},
                          {"shards", count},
                          {"width", film.width},
                          {"height", film.height},
                          {"samples", film.samples},
                          {"error_text", film.metadata.at("error")},
                          {"findings", findings}})
                .text() +
            "\n");
    return 0;
}

}  // namespace etalon::cli
