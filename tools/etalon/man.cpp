#include <fmt/format.h>

#include "etalon_version.h"
#include "tools/etalon/arguments.h"
#include "tools/etalon/help.h"
#include "tools/etalon/terminal.h"

namespace etalon::cli {
namespace {

/// Text for roff: a backslash, and a dot or quote at the start of a line, would be commands; "-" would become a hyphen.
std::string roff(std::string_view text)
{
    std::string out = text.starts_with('.') || text.starts_with('\'') ? "\\&" : "";
    for (const char c : text) {
        if (c == '\\')
            out += "\\e";
        else if (c == '-')
            out += "\\-";
        else
            out += c;
    }
    return out;
}

std::string option_entry(const Option& option)
{
    std::string text = fmt::format(".TP\n.B {}\n{}", roff(spelling(option)), roff(option.help));
    if (!option.choices.empty()) text += roff(fmt::format(": {}", fmt::join(option.choices, ", ")));
    if (!option.standard.empty()) text += roff(fmt::format(" [{}]", option.standard));
    text += ".\n";
    if (option.details.empty()) return text;
    text += ".RS\n";
    for (const Detail& detail : option.details)
        text += fmt::format(".TP\n.B {}\n{}\n", roff(detail.name), roff(detail.text));
    return text + ".RE\n";
}

std::string command_section(const Command& command)
{
    std::string text = fmt::format(".SS \"etalon {} [OPTIONS] {}\"\n{}\n", command.name, roff(command.argument),
                                   roff(command.description));
    for (const Option& option : command.options) text += option_entry(option);
    for (const Example& example : command.examples)
        text += fmt::format(".PP\n{}:\n.PP\n.RS\n.nf\n{}\n.fi\n.RE\n", roff(example.why), roff(example.line));
    return text + fmt::format(".PP\nExit codes: {}.\n", roff(command.exit_codes));
}

}  // namespace

int man(const Arguments&)
{
    std::string text = fmt::format(
        ".TH ETALON 1 \"\" \"etalon {}\" \"User Commands\"\n.SH NAME\netalon \\- a glTF renderer whose every picture "
        "comes with its error\n"
        ".SH SYNOPSIS\n.B etalon\n.I COMMAND\n[OPTIONS] ...\n.SH DESCRIPTION\n"
        "Etalon renders a glTF scene with a Vulkan rasterizer, a Vulkan path tracer or a double precision CPU "
        "reference, and says how large the\n"
        "error of the picture is. Data goes to standard output, everything else to standard error.\n.SH COMMANDS\n",
        kVersion);
    for (const Command& command : commands()) text += command_section(command);
    text +=
        ".SH EXIT STATUS\n.TP\n.B 0\nFine.\n.TP\n.B 1\nThe comparison or check failed.\n.TP\n.B 2\nBad usage or bad "
        "input.\n.TP\n.B 3\n"
        "The machine cannot: no device, out of memory, device lost.\n.TP\n.B 130\nInterrupted (143 by SIGTERM, 129 by "
        "SIGHUP); what was "
        "rendered so far has been written.\n"
        ".SH ENVIRONMENT\n.TP\n.B NO_COLOR\nWhen set and not empty, no colours on the terminal.\n.TP\n.B "
        "VK_DRIVER_FILES\n"
        "Which Vulkan drivers the loader offers.\n";
    put(text);
    return 0;
}

}  // namespace etalon::cli
