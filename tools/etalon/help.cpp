#include "tools/etalon/help.h"

#include <fmt/format.h>

#include <algorithm>

namespace etalon::cli {
namespace {

constexpr std::size_t kHelpColumn = 32;  // where the sentences start: most spellings are shorter

std::string row(const std::string& left, std::string_view text)
{
    std::string line = "  " + left;
    if (line.size() + 2 > kHelpColumn)
        line += '\n' + std::string(kHelpColumn, ' ');
    else
        line.resize(kHelpColumn, ' ');
    return line + wrapped(text, kHelpColumn).substr(kHelpColumn);
}

std::string sentence(const Option& option)
{
    std::string text = option.help;
    if (!option.choices.empty()) text += fmt::format(": {}", fmt::join(option.choices, ", "));
    if (!option.standard.empty()) text += fmt::format(" [{}]", option.standard);
    return text;
}

std::string rows(const Option& option)
{
    std::string text = row(spelling(option), sentence(option));
    for (const Detail& detail : option.details) text += row("    " + detail.name, detail.text);
    return text;
}

std::vector<std::string> headings(const Command& command)
{
    std::vector<std::string> all;
    for (const Option& option : command.options)
        if (std::find(all.begin(), all.end(), option.heading) == all.end()) all.push_back(option.heading);
    return all;
}

}  // namespace

std::string wrapped(std::string_view text, std::size_t indent, std::size_t width)
{
    std::string out;
    std::string line;
    for (std::size_t at = 0; at <= text.size();) {
        const std::size_t end = std::min(text.find(' ', at), text.size());
        const std::string_view word = text.substr(at, end - at);
        if (!line.empty() && indent + line.size() + 1 + word.size() > width) {
            out += std::string(indent, ' ') + line + '\n';
            line.clear();
        }
        if (!line.empty()) line += ' ';
        line += word;
        at = end + 1;
    }
    return out + std::string(indent, ' ') + line + '\n';
}

std::string spelling(const Option& option)
{
    return fmt::format("{}--{}{}{}", option.letter != 0 ? fmt::format("-{}, ", option.letter) : "", option.name,
                       option.argument.empty() ? "" : " ", option.argument);
}

std::string overview()
{
    std::string text =
        "etalon: a glTF renderer whose every picture comes with its error\n\nusage: etalon COMMAND [OPTIONS] ...\n\n";
    for (const Command& command : commands()) text += row(command.name, command.summary);
    return text +
           "\netalon COMMAND --help says more; etalon --version says which this is.\n"
           "example: etalon compare builtin:cornell -o out/cornell\n";
}

std::string help(const Command& command)
{
    std::string text = fmt::format("usage: etalon {} [OPTIONS]{}{}\n\n", command.name,
                                   command.argument.empty() ? "" : " ", command.argument);
    text += wrapped(command.description, 0);
    for (const std::string& heading : headings(command)) {
        text += fmt::format("\n{}:\n", heading);
        for (const Option& option : command.options)
            if (option.heading == heading) text += rows(option);
    }
    text += "\nExamples:\n";
    for (const Example& example : command.examples) text += fmt::format("  {}\n      {}\n", example.line, example.why);
    return text + fmt::format("\nExit codes: {}.\n", command.exit_codes);
}

}  // namespace etalon::cli
