#pragma once
#include <chrono>
#include <optional>
#include <string>
#include <vector>

#include "engine/image/develop.h"
#include "engine/scene/settings.h"
#include "tools/etalon/arguments.h"

namespace etalon::cli {

// --max-time: a picture that is written in the time asked, with as many samples as fit into it.

using TimePoint = std::chrono::steady_clock::time_point;

/// When this process was started, by the kernel's clock: loading the libraries is part of the time that people wait.
TimePoint process_start();

/// Seconds of --max-time. Refuses the one renderer that neither stops early nor has a profile to be chosen by.
std::optional<double> time_goal(const Arguments& arguments, const RenderSettings& settings);

/// The time of one picture, and what of it is kept for reading the film back, developing and writing, estimated by
/// doing so to a strip of noise on this machine as busy as it is now.
struct TimePlan {
    TimePoint begin;
    double seconds = 0;
    double writing = 0;

    TimePoint last_sample() const;
    /// Seconds until then.
    double left() const;
    /// Begin to now.
    double spent() const;
};
TimePlan plan_time(TimePoint begin, double seconds, ivec2 size, const std::vector<std::string>& outputs,
                   const DevelopSettings& develop);

/// "4.93 s of 5 s asked, 1.20 s of them before the first sample; the machine is busy (load 7.1 on 2 processors)"; when
/// it was too late, what is the least that this picture takes here.
std::string tell_time(const TimePlan& plan, double before_samples, double written);

}  // namespace etalon::cli
