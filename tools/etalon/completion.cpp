#include <fmt/format.h>

#include "engine/base/error.h"
#include "engine/scene/load.h"
#include "tools/etalon/arguments.h"
#include "tools/etalon/terminal.h"

namespace etalon::cli {
namespace {

std::vector<std::string> command_names()
{
    std::vector<std::string> names;
    for (const Command& command : commands()) names.push_back(command.name);
    return names;
}

std::vector<std::string> scene_names()
{
    std::vector<std::string> names;
    for (const BuiltinScene& scene : builtin_scenes()) names.push_back(fmt::format("builtin:{}", scene.name));
    return names;
}

/// Inside single quotes of a shell.
std::string shell_quoted(std::string_view text)
{
    std::string out = "'";
    for (const char c : text)
        if (c == '\'')
            out += "'\\''";
        else
            out += c;
    return out + '\'';
}

std::string bash_option_case(const Option& option)
{
    std::string pattern = "--" + option.name;
    if (option.letter != 0) pattern += fmt::format("|-{}", option.letter);
    std::string answer = "COMPREPLY=()";
    if (!option.choices.empty())
        answer = fmt::format("COMPREPLY=($(compgen -W {} -- \"$word\"))",
                             shell_quoted(fmt::format("{}", fmt::join(option.choices, " "))));
    else if (option.completes == Completes::folder)
        answer = "COMPREPLY=($(compgen -d -- \"$word\"))";
    else if (option.completes == Completes::file)
        answer = "COMPREPLY=($(compgen -f -- \"$word\"))";
    return fmt::format("                {}) {}; return ;;\n", pattern, answer);
}

std::string bash_command_case(const Command& command)
{
    std::string options;
    std::string cases;
    for (const Option& option : command.options) {
        options += (options.empty() ? "--" : " --") + option.name;
        if (!option.argument.empty()) cases += bash_option_case(option);
    }
    std::string rest = "COMPREPLY=()";
    if (command.name == "completion")
        rest = "COMPREPLY=($(compgen -W 'bash zsh fish' -- \"$word\"))";
    else if (command.completes == Completes::scene)
        rest = fmt::format("COMPREPLY=($(compgen -W {} -- \"$word\") $(compgen -f -- \"$word\"))",
                           shell_quoted(fmt::format("{}", fmt::join(scene_names(), " "))));
    else if (command.completes == Completes::file)
        rest = "COMPREPLY=($(compgen -f -- \"$word\"))";
    if (!cases.empty()) cases = fmt::format("            case \"$before\" in\n{}            esac\n", cases);
    return fmt::format(
        "        {})\n{}            if [[ $word == -* ]]; then COMPREPLY=($(compgen -W {} -- \"$word\"))\n"
        "            else {}; fi ;;\n",
        command.name, cases, shell_quoted(options), rest);
}

std::string bash_script()
{
    std::string cases;
    for (const Command& command : commands()) cases += bash_command_case(command);
    // A colon splits words in bash, so that builtin:cornell arrives in three; __ltrim_colon_completions mends the
    // answer.
    return fmt::format(
        "# bash completion of etalon; made by `etalon completion bash`\n"
        "_etalon()\n{{\n"
        "    local word before\n"
        "    if declare -F _get_comp_words_by_ref > /dev/null; then _get_comp_words_by_ref -n : -c word -p before\n"
        "    else word=${{COMP_WORDS[COMP_CWORD]}} before=${{COMP_WORDS[COMP_CWORD - 1]}}; fi\n"
        "    if ((COMP_CWORD == 1)); then COMPREPLY=($(compgen -W {} -- \"$word\")); return; fi\n"
        "    case ${{COMP_WORDS[1]}} in\n{}    esac\n"
        "    if declare -F __ltrim_colon_completions > /dev/null; then __ltrim_colon_completions \"$word\"; fi\n"
        "}}\n"
        "complete -o filenames -F _etalon etalon\n",
        shell_quoted(fmt::format("{} --help --version", fmt::join(command_names(), " "))), cases);
}

/// The text of one option inside _arguments: brackets, colons and backslashes have a meaning there.
std::string zsh_escaped(std::string_view text)
{
    std::string out;
    for (const char c : text) {
        if (c == '[' || c == ']' || c == ':' || c == '\\') out += '\\';
        out += c;
    }
    return out;
}

std::string zsh_option(const Option& option)
{
    std::string action;
    if (!option.choices.empty())
        action = fmt::format("({})", fmt::join(option.choices, " "));
    else if (option.completes == Completes::file)
        action = "_files";
    else if (option.completes == Completes::folder)
        action = "_files -/";
    std::string value;
    if (!option.argument.empty()) value = fmt::format(":{}:{}", zsh_escaped(option.argument), action);
    const std::string repeat = option.repeats ? "*" : "";
    std::string line = shell_quoted(fmt::format("{}--{}[{}]{}", repeat, option.name, zsh_escaped(option.help), value));
    if (option.letter != 0)
        line += ' ' + shell_quoted(fmt::format("{}-{}[{}]{}", repeat, option.letter, zsh_escaped(option.help), value));
    return line;
}

std::string zsh_positional(const Command& command)
{
    if (command.name == "completion") return "'1:shell:(bash zsh fish)'";
    if (command.completes == Completes::scene) return "'*:scene:_etalon_scenes'";
    if (command.completes == Completes::file) return "'*:picture:_files'";
    return "";
}

std::string zsh_script()
{
    std::string names;
    std::string cases;
    for (const Command& command : commands()) {
        names += fmt::format("        {}\n", shell_quoted(command.name + ':' + command.summary));
        cases += fmt::format("        {}) _arguments", command.name);
        for (const Option& option : command.options) cases += " \\\n            " + zsh_option(option);
        const std::string positional = zsh_positional(command);
        cases += (positional.empty() ? "" : " \\\n            " + positional) + " ;;\n";
    }
    std::string scenes;
    for (const std::string& name : scene_names()) scenes += ' ' + shell_quoted(name);
    return fmt::format(
        "#compdef etalon\n# zsh completion of etalon; made by `etalon completion zsh`\n"
        "_etalon_scenes()\n{{\n    compadd --{}\n    _files\n}}\n"
        "_etalon()\n{{\n    local -a names\n    names=(\n{}    )\n"
        "    if ((CURRENT == 2)); then _describe command names; return; fi\n"
        "    local chosen=$words[2]\n    shift words\n    ((CURRENT--))\n"
        "    case $chosen in\n{}    esac\n}}\n"
        "if [ \"$funcstack[1]\" = _etalon ]; then _etalon \"$@\"; else compdef _etalon etalon; fi\n",
        scenes, names, cases);
}

std::string fish_option(const Command& command, const Option& option)
{
    std::string line =
        fmt::format("complete -c etalon -n '__fish_seen_subcommand_from {}' -l {}", command.name, option.name);
    if (option.letter != 0) line += fmt::format(" -s {}", option.letter);
    if (!option.choices.empty())
        line += fmt::format(" -x -a {}", shell_quoted(fmt::format("{}", fmt::join(option.choices, " "))));
    else if (option.completes == Completes::folder)
        line += " -x -a '(__fish_complete_directories)'";
    else if (option.completes == Completes::file)
        line += " -r -F";
    else if (!option.argument.empty())
        line += " -x";
    return line + " -d " + shell_quoted(option.help) + '\n';
}

std::string fish_script()
{
    const std::string names = fmt::format("{}", fmt::join(command_names(), " "));
    std::string text = "# fish completion of etalon; made by `etalon completion fish`\n";
    for (const Command& command : commands()) {
        text += fmt::format("complete -c etalon -f -n 'not __fish_seen_subcommand_from {}' -a {} -d {}\n", names,
                            command.name, shell_quoted(command.summary));
        for (const Option& option : command.options) text += fish_option(command, option);
        const std::string seen = fmt::format("complete -c etalon -n '__fish_seen_subcommand_from {}'", command.name);
        if (command.name == "completion")
            text += seen + " -f -a 'bash zsh fish'\n";
        else if (command.completes == Completes::scene)
            text += fmt::format("{} -a {}\n", seen, shell_quoted(fmt::format("{}", fmt::join(scene_names(), " "))));
        else if (command.completes == Completes::nothing)
            text += seen + " -f\n";
    }
    return text;
}

}  // namespace

int completion(const Arguments& arguments)
{
    const std::string& shell = arguments.positional().front();
    if (shell == "bash")
        put(bash_script());
    else if (shell == "zsh")
        put(zsh_script());
    else if (shell == "fish")
        put(fish_script());
    else
        throw Error(Blame::input, fmt::format("no completion for the shell '{}'", shell), "one of bash, zsh, fish");
    return 0;
}

}  // namespace etalon::cli
