#include "tools/etalon/interrupt.h"

#include <unistd.h>

#include <csignal>
#include <string_view>

namespace etalon::cli {
namespace {

// A signal handler can reach nothing but statics: the one place in this project where state is global.
std::atomic<bool> stop_requested{false};
std::atomic<int> stop_exit_code{0};
static_assert(std::atomic<bool>::is_always_lock_free && std::atomic<int>::is_always_lock_free,
              "a signal handler may touch lock-free atomics only");

extern "C" void on_signal(int number)
{
    int none = 0;
    stop_exit_code.compare_exchange_strong(none, 128 + number);  // the shells' convention
    if (stop_requested.exchange(true)) _exit(stop_exit_code);
    constexpr std::string_view kText = "\netalon: finishing this pass; once more to stop at once\n";
    [[maybe_unused]] const auto written = write(STDERR_FILENO, kText.data(), kText.size());
}

}  // namespace

Interrupt::Interrupt()
{
    stop_requested = false;
    stop_exit_code = 0;
    struct sigaction action = {};
    action.sa_handler = on_signal;
    sigemptyset(&action.sa_mask);
    action.sa_flags = SA_RESTART;
    for (std::size_t i = 0; i < kSignals.size(); ++i) {
        sigaction(kSignals[i], nullptr, &before_[i]);
        if (before_[i].sa_handler != SIG_IGN) sigaction(kSignals[i], &action, nullptr);
    }
}

Interrupt::~Interrupt()
{
    for (std::size_t i = 0; i < kSignals.size(); ++i) sigaction(kSignals[i], &before_[i], nullptr);
}

const std::atomic<bool>* Interrupt::flag() const
{
    return &stop_requested;
}

int Interrupt::exit_code() const
{
    return stop_exit_code;
}

}  // namespace etalon::cli
