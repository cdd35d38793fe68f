#include <fmt/format.h>

#include <algorithm>
#include <csignal>
#include <new>
#include <string>
#include <vector>

#include "engine/base/error.h"
#include "engine/base/memory.h"
#include "etalon_version.h"
#include "tools/etalon/help.h"
#include "tools/etalon/json.h"
#include "tools/etalon/parse.h"
#include "tools/etalon/terminal.h"

namespace etalon::cli {
namespace {

int run(const std::vector<std::string>& words)
{
    if (words.empty()) {
        say(overview());
        return static_cast<int>(Blame::input);
    }
    if (words[0] == "--help" || words[0] == "-h" || words[0] == "help") {
        put(overview());
        return 0;
    }
    if (words[0] == "--version") {
        put(fmt::format("etalon {} ({})\n", kVersionFull, kCompiler));
        return 0;
    }
    const Command* const command = find_command(words[0]);
    if (command == nullptr) {
        std::vector<std::string> names;
        for (const Command& known : commands()) names.push_back(known.name);
        const std::string_view meant = nearest(words[0], names);
        throw Error(Blame::input, fmt::format("there is no command '{}'", words[0]),
                    meant.empty() ? "see etalon --help" : fmt::format("did you mean {}?", meant));
    }
    const Arguments arguments = parse(*command, std::span(words).subspan(1));
    if (arguments.has("help")) {
        put(help(*command));
        return 0;
    }
    return command->run(arguments);
}

int fail(const Error& error, bool json) noexcept
{
    say(error);
    try {
        if (json) put(Json::object({{"schema", "etalon-error/1"}, {"error", as_json(error)}}).text() + "\n");
    } catch (const Error&) {
        // Standard output is what failed: the lines above have said so.
    }
    return error.exit_code();
}

}  // namespace
}  // namespace etalon::cli

int main(int argc, char** argv)
{
    using namespace etalon;
    exit_when_out_of_memory();
    std::signal(SIGPIPE, SIG_IGN);  // a closed pipe is an error code of write(), not a death
    std::signal(SIGXFSZ, SIG_IGN);  // and so is the limit on the size of files
    cli::reserve_standard_streams();
    const std::vector<std::string> words(argv + std::min(argc, 1), argv + argc);
    // Known before parsing, so that a parse that fails says so as JSON too.
    const bool json = std::find(words.begin(), words.end(), "--json") != words.end();
    try {
        return cli::run(words);
    } catch (const Error& error) {
        return cli::fail(error, json);
    } catch (const std::bad_alloc&) {
        return cli::fail(Error(Blame::machine, "out of memory", "a smaller --size or a smaller scene takes less"),
                         json);
    } catch (const std::exception& fault) {
        return cli::fail(Error(Blame::machine, fault.what(),
                               "this should have been caught earlier: please report it with the command line"),
                         json);
    }
}
