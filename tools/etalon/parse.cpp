#include "tools/etalon/parse.h"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>

#include "engine/base/error.h"

namespace etalon::cli {
namespace {

std::string see_help(const Command& command)
{
    return fmt::format("see etalon {} --help", command.name);
}

[[noreturn]] void refuse_unknown(const Command& command, const std::string& word)
{
    std::vector<std::string> names;
    for (const Option& option : command.options) names.push_back("--" + option.name);
    const std::string_view meant = nearest(word.substr(0, word.find('=')), names);
    throw Error(Blame::input, fmt::format("{} has no option {}", command.name, word),
                meant.empty() ? see_help(command) : fmt::format("did you mean {}?", meant));
}

void check_count(const Command& command, const std::vector<std::string>& positional)
{
    if (positional.size() < command.least)
        throw Error(Blame::input, fmt::format("{} needs {}", command.name, command.argument), see_help(command));
    if (positional.size() > command.most)
        throw Error(Blame::input, fmt::format("{} has no place for '{}'", command.name, positional[command.most]),
                    see_help(command));
}

/// CLI11 reports a missing value in words of its own; ours name the option and what it takes.
void check_values(const Command& command, const CLI::App& app)
{
    for (const Option& row : command.options) {
        const CLI::Option& option = *app.get_option("--" + row.name);
        if (option.count() == 0 || row.argument.empty()) continue;
        if (!row.repeats && option.results().size() > 1)
            throw Error(Blame::input, fmt::format("--{} is given {} times", row.name, option.results().size()),
                        "give it once");
    }
}

}  // namespace

Arguments parse(const Command& command, std::span<const std::string> words)
{
    CLI::App app;
    app.set_help_flag();
    app.allow_extras();
    for (const Option& row : command.options) {
        const std::string names = (row.letter != 0 ? fmt::format("-{},", row.letter) : "") + "--" + row.name;
        if (row.argument.empty())
            app.add_flag(names);
        else
            app.add_option(names)->type_size(1)->expected(1)->take_all();
    }
    try {
        app.parse(std::vector<std::string>(words.rbegin(), words.rend()));  // CLI11 wants the last word first
    } catch (const CLI::ParseError& fault) {
        throw Error(Blame::input, fault.what(), see_help(command));
    }
    std::vector<std::string> positional;
    bool literal = false;  // after "--" a dash means nothing
    for (const std::string& word : app.remaining()) {
        if (word == "--" && !literal)
            literal = true;
        else if (!literal && word.size() > 1 && word.front() == '-')
            refuse_unknown(command, word);
        else
            positional.push_back(word);
    }
    check_values(command, app);

    std::map<std::string, std::vector<std::string>> given;
    for (const Option& row : command.options) {
        const CLI::Option& option = *app.get_option("--" + row.name);
        if (option.count() > 0) given[row.name] = row.argument.empty() ? std::vector<std::string>{} : option.results();
    }
    Arguments arguments(command, std::move(positional), std::move(given));
    for (const Option& row : command.options)
        if (!row.choices.empty() && arguments.has(row.name)) arguments.choice(row.name);
    if (!arguments.has("help")) check_count(command, arguments.positional());
    return arguments;
}

}  // namespace etalon::cli
