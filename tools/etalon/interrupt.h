#pragma once
#include <atomic>

namespace etalon::cli {

inline constexpr int kInterruptedExitCode = 130;

/// While one lives, the first Ctrl-C (SIGINT) or SIGTERM asks the running job to finish its pass, write what it has and
/// end with exit code 130; a second one ends the process at once. One at a time.
class Interrupt {
 public:
    Interrupt();
    ~Interrupt();
    Interrupt(const Interrupt&) = delete;
    Interrupt& operator=(const Interrupt&) = delete;

    /// Set by the first signal; for Progress.
    const std::atomic<bool>* flag() const;
    bool stopped() const { return flag()->load(std::memory_order_relaxed); }
};

}  // namespace etalon::cli
