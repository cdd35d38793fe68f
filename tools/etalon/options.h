#pragma once
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "engine/base/nearest.h"

namespace etalon::cli {

class Arguments;

/// What a shell may offer after an option or in place of an argument.
enum class Completes { nothing, scene, file, folder };

/// A line of help below an option's: a name and what it means.
struct Detail {
    std::string name;
    std::string text;
};

/// One option of a command. The parser, the help, the completions and the man page are all made from these rows.
struct Option {
    std::string name;                  ///< without dashes: "size" is --size
    char letter = 0;                   ///< 'o' for -o; 0: none
    std::string argument;              ///< what follows it: "WxH"; empty: a switch
    std::string help;                  ///< one sentence without a full stop
    std::string standard;              ///< value when absent, as text; empty: none, or said in the help
    std::vector<std::string> choices;  ///< the only values; empty: any
    Completes completes = Completes::nothing;
    bool repeats = false;              ///< may be given several times
    std::string heading;               ///< under which the help shows it: "View"
    std::vector<Detail> details = {};  ///< what the help says of the words that the option's value is made of
};

struct Example {
    std::string line;  ///< what to type
    std::string why;   ///< what it does
};

/// A subcommand: `run` is called with its parsed arguments and returns the exit code.
struct Command {
    std::string name;
    std::string summary;              ///< one line, no full stop
    std::string description;          ///< a few sentences
    std::string argument;             ///< the positional arguments as help shows them: "SCENE..."
    std::size_t least = 0, most = 0;  ///< how many of them
    Completes completes = Completes::scene;
    std::vector<Option> options;
    std::vector<Example> examples;
    std::string exit_codes;  ///< which codes it returns and when
    int (*run)(const Arguments&);
};

/// Every subcommand in the order of the help.
const std::vector<Command>& commands();
/// Null when there is none of that name.
const Command* find_command(std::string_view name);
/// Null when the command has no option of that long name.
const Option* find_option(const Command& command, std::string_view name);

inline constexpr std::uint64_t kViewSamples = 4096;  ///< per pixel, where `view` stops when --spp is not given

int render(const Arguments& arguments);
int compare(const Arguments& arguments);
int merge(const Arguments& arguments);
int tradeoff(const Arguments& arguments);
int stability(const Arguments& arguments);
int diff(const Arguments& arguments);
int explain(const Arguments& arguments);
int info(const Arguments& arguments);
int post(const Arguments& arguments);
int view(const Arguments& arguments);
int completion(const Arguments& arguments);
int man(const Arguments& arguments);

}  // namespace etalon::cli
