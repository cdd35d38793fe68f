#pragma once
#include <cstddef>
#include <span>
#include <string>
#include <string_view>

namespace etalon {
class Error;
}

namespace etalon::cli {

/// Puts something in the place of standard streams that were closed when the program began, else the next file to be
/// opened would take their number and receive what is meant for people. Reading or writing there still fails.
void reserve_standard_streams();

/// How the program speaks: data goes to standard output, everything said about it to standard error.
struct Terminal {
    bool colour = false;    ///< standard error takes colours: a terminal, NO_COLOR unset or empty, TERM not "dumb"
    bool terminal = false;  ///< standard error is a terminal
    int columns = 80;       ///< of that terminal

    static Terminal of_standard_error();
};

/// One line for the user on standard error.
void say(std::string_view line);
/// The same with "warning: " in yellow before it.
void warn(const Terminal& terminal, std::string_view line);

/// A failure with where it was met and how it is mended, the program's name in red.
void say(const Error& error);

/// Writes to standard output. A reader that closed the pipe is no failure; any other is Error(machine).
void put(std::string_view text);
void put(std::span<const std::byte> bytes);

/// A time as people read it: "0.42 s", "3 min 12 s", "2 h 5 min".
std::string describe_seconds(double seconds);

}  // namespace etalon::cli
