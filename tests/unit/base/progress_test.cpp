#include "engine/base/progress.h"

#include <gtest/gtest.h>

namespace etalon {
namespace {

TEST(Progress, is_silent_and_never_stops_by_default)
{
    const Progress progress;
    progress.report({});
    EXPECT_FALSE(progress.stopped());
}

TEST(Progress, passes_reports_on_and_hears_the_stop)
{
    std::atomic<bool> stop = false;
    double fraction = 0;
    const Progress progress([&](const ProgressUpdate& update) { fraction = update.fraction; }, &stop);
    ProgressUpdate update;
    update.fraction = 0.25;
    progress.report(update);
    EXPECT_EQ(fraction, 0.25);
    EXPECT_FALSE(progress.stopped());
    stop = true;
    EXPECT_TRUE(progress.stopped());
}

TEST(Progress, stops_from_its_deadline_on_and_so_does_its_silent_twin)
{
    const Progress progress;
    const auto now = std::chrono::steady_clock::now();
    EXPECT_FALSE(progress.until(now + std::chrono::hours(1)).stopped());
    const Progress late = progress.until(now - std::chrono::seconds(1));
    EXPECT_TRUE(late.stopped());
    EXPECT_TRUE(late.silent().stopped());
    EXPECT_TRUE(late.until(now + std::chrono::hours(1)).stopped()) << "the earlier of two deadlines";
    EXPECT_FALSE(progress.stopped());
}

}  // namespace
}  // namespace etalon
