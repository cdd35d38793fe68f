#pragma once
#include <algorithm>
#include <atomic>
#include <chrono>
#include <cstdint>
#include <functional>
#include <optional>
#include <string_view>

namespace etalon {

/// Where a long job stands.
struct ProgressUpdate {
    std::string_view stage;                ///< what is being done: "path tracing", "building the BVH"
    double fraction = 0;                   ///< of this stage, 0 … 1
    std::optional<double> error;           ///< relative standard error of the picture so far, where it is known
    std::optional<std::uint64_t> samples;  ///< samples per pixel done, for path tracing
};

/// How a long job tells what it does and hears that it should stop. Default constructed: silent, never stopped.
/// `report` may be called from one thread at a time; `stopped` from any.
class Progress {
 public:
    using Sink = std::function<void(const ProgressUpdate&)>;
    Progress() = default;
    /// `stop` (may be null) is set from elsewhere, by a signal handler for instance, and must outlive this.
    Progress(Sink sink, const std::atomic<bool>* stop) : sink_(std::move(sink)), stop_(stop) {}

    void report(const ProgressUpdate& update) const
    {
        if (sink_) sink_(update);
    }
    /// True once the job should finish what it is at and return what it has.
    bool stopped() const
    {
        if (stop_ != nullptr && stop_->load(std::memory_order_relaxed)) return true;
        return deadline_ != TimePoint::max() && std::chrono::steady_clock::now() >= deadline_;
    }
    /// The same stop, and nothing said: for one of many jobs that a longer one is made of.
    Progress silent() const
    {
        Progress out({}, stop_);
        out.deadline_ = deadline_;
        return out;
    }
    using TimePoint = std::chrono::steady_clock::time_point;
    /// The same, but stopped from `when` on as well.
    Progress until(TimePoint when) const
    {
        Progress out = *this;
        out.deadline_ = std::min(deadline_, when);
        return out;
    }

 private:
    Sink sink_;
    const std::atomic<bool>* stop_ = nullptr;
    TimePoint deadline_ = TimePoint::max();
};

}  // namespace etalon
