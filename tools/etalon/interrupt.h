#pragma once
#include <csignal>

#include <array>
#include <atomic>

namespace etalon::cli {

/// While one lives, the first Ctrl-C (SIGINT), SIGTERM or SIGHUP asks the running job to finish its pass, write what it
/// has and end with exit_code(); a second one ends the process at once. A signal that was ignored when the program
/// began (nohup, jobs in the background of a script) stays ignored. One at a time.
class Interrupt {
 public:
    Interrupt();
    ~Interrupt();
    Interrupt(const Interrupt&) = delete;
    Interrupt& operator=(const Interrupt&) = delete;

    /// Set by the first signal; for Progress.
    const std::atomic<bool>* flag() const;
    bool stopped() const { return flag()->load(std::memory_order_relaxed); }
    /// As of a program that the first signal ended: 130 for SIGINT, 143 for SIGTERM, 129 for SIGHUP.
    int exit_code() const;

 private:
    static constexpr std::array kSignals{SIGINT, SIGTERM, SIGHUP};
    std::array<struct sigaction, kSignals.size()> before_{};
};

}  // namespace etalon::cli
