#include "tools/etalon/progress_display.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <mutex>

#include "tools/etalon/json.h"
#include "tools/etalon/terminal.h"

namespace etalon::cli {
namespace {

using Clock = std::chrono::steady_clock;

enum class Form { bar, plain, json, none };

Form form_of(const Arguments& arguments, const Terminal& terminal)
{
    switch (arguments.choice("progress")) {
        case 1:
            return Form::bar;
        case 2:
            return Form::plain;
        case 3:
            return Form::json;
        case 4:
            return Form::none;
        default:
            return terminal.terminal ? Form::bar : Form::plain;
    }
}

/// Seconds between two showings of the same stage: often enough to look alive, rarely enough to cost nothing.
double interval(Form form)
{
    return form == Form::bar ? 0.1 : form == Form::json ? 0.5 : 5.0;
}

std::string details(const ProgressUpdate& update, double left)
{
    std::string text;
    if (update.samples) text += fmt::format(", {} spp", *update.samples);
    if (update.error) text += fmt::format(", error {:.2f}%", *update.error * 100);
    if (left > 0) text += fmt::format(", {} left", describe_seconds(left));
    return text;
}

}  // namespace

struct ProgressDisplay::State {
    Terminal terminal = Terminal::of_standard_error();
    Form form = Form::none;
    std::mutex mutex;
    std::string stage;
    Clock::time_point stage_start;
    Clock::time_point last;
    bool bar_shown = false;

    void clear_bar()
    {
        if (!bar_shown) return;
        std::fputs("\r\033[K", stderr);
        bar_shown = false;
    }

    void show_bar(const std::string& what, const ProgressUpdate& update, double left)
    {
        constexpr int kCells = 24;
        const int full = static_cast<int>(std::lround(std::clamp(update.fraction, 0.0, 1.0) * kCells));
        std::string line = fmt::format("[{:=<{}}{: <{}}] {:3.0f}% {}: {}{}", "", full, "", kCells - full,
                                       update.fraction * 100, what, update.stage, details(update, left));
        const auto columns = static_cast<std::size_t>(terminal.columns - 1);
        if (line.size() > columns) line.resize(columns);
        std::fprintf(stderr, "\r\033[K%s", line.c_str());
        std::fflush(stderr);
        bar_shown = true;
    }

    static void show_json(const std::string& what, const ProgressUpdate& update, double elapsed, double left)
    {
        const std::optional<double> seconds_left = left > 0 ? std::optional(left) : std::nullopt;
        say(Json::object({{"event", "progress"},
                          {"scene", what},
                          {"stage", update.stage},
                          {"fraction", update.fraction},
                          {"samples", update.samples},
                          {"error", update.error},
                          {"elapsed_s", elapsed},
                          {"left_s", seconds_left}})
                .text());
    }

    void show(const std::string& what, const ProgressUpdate& update)
    {
        const std::lock_guard lock(mutex);
        const auto now = Clock::now();
        const bool new_stage = update.stage != stage;
        if (new_stage) {
            stage = update.stage;
            stage_start = now;
        }
        const double since_last = std::chrono::duration<double>(now - last).count();
        const bool finished = update.fraction >= 1;
        if (!new_stage && since_last < interval(form) && !(finished && form != Form::plain)) return;
        last = now;
        const double elapsed = std::chrono::duration<double>(now - stage_start).count();
        // Under a tenth of a second or a thousandth of the work the estimate would be noise.
        const double left =
            elapsed > 0.1 && update.fraction > 1e-3 && !finished ? elapsed * (1 / update.fraction - 1) : 0;
        if (form == Form::bar)
            show_bar(what, update, left);
        else if (form == Form::json)
            show_json(what, update, elapsed, left);
        else if (new_stage && update.fraction <= 0)
            say(fmt::format("{}: {}", what, update.stage));
        else
            say(fmt::format("{}: {} {:.0f}%{}", what, update.stage, update.fraction * 100, details(update, left)));
    }
};

ProgressDisplay::ProgressDisplay(const Arguments& arguments) : state_(std::make_unique<State>())
{
    state_->form = form_of(arguments, state_->terminal);
}

ProgressDisplay::~ProgressDisplay()
{
    clear();
}

Progress ProgressDisplay::progress(const std::string& what, const std::atomic<bool>* stop)
{
    if (state_->form == Form::none) return {nullptr, stop};
    State* const state = state_.get();
    return {[state, what](const ProgressUpdate& update) { state->show(what, update); }, stop};
}

void ProgressDisplay::clear()
{
    const std::lock_guard lock(state_->mutex);
    state_->clear_bar();
}

}  // namespace etalon::cli
