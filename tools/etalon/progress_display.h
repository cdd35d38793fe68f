#pragma once
#include <atomic>
#include <memory>

#include "engine/base/progress.h"
#include "tools/etalon/arguments.h"

namespace etalon::cli {

/// Shows a job on standard error as --progress asks: a bar with time left and error so far that is wiped when done,
/// plain lines (each stage, then every few seconds), JSON lines, or nothing. One job at a time.
class ProgressDisplay {
 public:
    explicit ProgressDisplay(const Arguments& arguments);
    ~ProgressDisplay();
    ProgressDisplay(const ProgressDisplay&) = delete;
    ProgressDisplay& operator=(const ProgressDisplay&) = delete;

    /// For the library; `what` is said before the stage: "cornell". This must outlive it.
    Progress progress(const std::string& what, const std::atomic<bool>* stop);
    /// Takes the bar off the screen, so that a line can be said.
    void clear();

 private:
    struct State;
    std::unique_ptr<State> state_;
};

}  // namespace etalon::cli
