#include "tools/etalon/options.h"

#include <algorithm>

namespace etalon::cli {

const Command* find_command(std::string_view name)
{
    const auto found =
        std::find_if(commands().begin(), commands().end(), [&](const Command& c) { return c.name == name; });
    return found == commands().end() ? nullptr : &*found;
}

const Option* find_option(const Command& command, std::string_view name)
{
    const auto found =
        std::find_if(command.options.begin(), command.options.end(), [&](const Option& o) { return o.name == name; });
    return found == command.options.end() ? nullptr : &*found;
}

}  // namespace etalon::cli
