#include "tools/etalon/interrupt.h"

#include <unistd.h>

#include <csignal>
#include <string_view>

namespace etalon::cli {
namespace {

// A signal handler can reach nothing but statics: the one place in this project where state is global.
std::atomic<bool> stop_requested{false};
static_assert(std::atomic<bool>::is_always_lock_free, "a signal handler may touch lock-free atomics only");

extern "C" void on_signal(int)
{
    if (stop_requested.exchange(true)) _exit(kInterruptedExitCode);
    constexpr std::string_view kText = "\netalon: finishing this pass; once more to stop at once\n";
    [[maybe_unused]] const auto written = write(STDERR_FILENO, kText.data(), kText.size());
}

void handle(int number, void (*handler)(int))
{
    struct sigaction action = {};
    action.sa_handler = handler;
    sigemptyset(&action.sa_mask);
    action.sa_flags = SA_RESTART;
    sigaction(number, &action, nullptr);
}

}  // namespace

Interrupt::Interrupt()
{
    stop_requested = false;
    handle(SIGINT, on_signal);
    handle(SIGTERM, on_signal);
}

Interrupt::~Interrupt()
{
    handle(SIGINT, SIG_DFL);
    handle(SIGTERM, SIG_DFL);
}

const std::atomic<bool>* Interrupt::flag() const
{
    return &stop_requested;
}

}  // namespace etalon::cli
