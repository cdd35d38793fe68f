#include "tools/etalon/terminal.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/ioctl.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <cstring>

#include "engine/base/error.h"

namespace etalon::cli {
namespace {

bool is_set(const char* variable)
{
    const char* const value = std::getenv(variable);
    return value != nullptr && *value != '\0';
}

void write_stderr(std::string_view text)
{
    std::fwrite(text.data(), 1, text.size(), stderr);
}

void write_stdout(const char* data, std::size_t size)
{
    if (std::fwrite(data, 1, size, stdout) == size && std::fflush(stdout) == 0) return;
    if (errno == EPIPE) return;  // `etalon explain … | head` has seen all it wanted
    throw Error(Blame::machine, fmt::format("cannot write to standard output: {}", std::strerror(errno)));
}

}  // namespace

void reserve_standard_streams()
{
    // A descriptor that can neither be read nor written, so that use is an error and not silence.
    for (const int stream : {STDIN_FILENO, STDOUT_FILENO, STDERR_FILENO})
        if (fcntl(stream, F_GETFD) == -1) open("/", O_PATH);
}

Terminal Terminal::of_standard_error()
{
    Terminal terminal;
    terminal.terminal = isatty(STDERR_FILENO) == 1;
    const char* const term = std::getenv("TERM");
    const bool dumb = term == nullptr || std::string_view(term) == "dumb";
    terminal.colour = terminal.terminal && !dumb && !is_set("NO_COLOR");  // https://no-color.org
    winsize size{};
    if (terminal.terminal && ioctl(STDERR_FILENO, TIOCGWINSZ, &size) == 0 && size.ws_col > 0)
        terminal.columns = std::max<int>(size.ws_col, 20);
    return terminal;
}

void say(std::string_view line)
{
    write_stderr(line);
    write_stderr("\n");
}

void warn(const Terminal& terminal, std::string_view line)
{
    say(fmt::format("{} {}", terminal.colour ? "\033[33mwarning:\033[0m" : "warning:", line));
}

void say(const Error& error)
{
    std::string message = error.message();
    constexpr std::string_view kName = "etalon:";
    if (Terminal::of_standard_error().colour && message.starts_with(kName))
        message.replace(0, kName.size(), "\033[31metalon:\033[0m");
    say(message);
}

void put(std::string_view text)
{
    write_stdout(text.data(), text.size());
}

void put(std::span<const std::byte> bytes)
{
    write_stdout(reinterpret_cast<const char*>(bytes.data()), bytes.size());
}

std::string describe_seconds(double seconds)
{
    if (!(seconds >= 0) || seconds > 1e9) return "unknown";
    if (seconds < 60) return fmt::format("{:.{}f} s", seconds, seconds < 10 ? 2 : 0);
    const auto whole = static_cast<long>(std::lround(seconds));
    if (whole < 3600) return fmt::format("{} min {} s", whole / 60, whole % 60);
    return fmt::format("{} h {} min", whole / 3600, whole % 3600 / 60);
}

}  // namespace etalon::cli
