#include "engine/base/parallel.h"

#include <algorithm>
#include <atomic>
#include <exception>
#include <mutex>
#include <system_error>
#include <thread>
#include <vector>

namespace etalon {
namespace {

/// True while this thread runs a body, so that nested calls stay on it instead of multiplying threads.
thread_local bool inside_parallel_for = false;

struct Inside {
    Inside() { inside_parallel_for = true; }
    ~Inside() { inside_parallel_for = false; }
    Inside(const Inside&) = delete;
    Inside& operator=(const Inside&) = delete;
};

/// The indices that are still to do, and the first failure among those done.
class Work {
 public:
    Work(std::size_t count, std::size_t chunk, const std::function<void(std::size_t)>& body)
        : count_(count), chunk_(chunk), body_(body), failed_(count)
    {}

    void run()
    {
        const Inside inside;
        for (;;) {
            const std::size_t begin = next_.fetch_add(chunk_, std::memory_order_relaxed);
            if (begin >= count_) return;
            for (std::size_t i = begin; i < std::min(begin + chunk_, count_); ++i) run_one(i);
        }
    }

    void rethrow() const
    {
        if (error_) std::rethrow_exception(error_);
    }

 private:
    void run_one(std::size_t i)
    {
        // Indices above a failure are pointless; those below it must run, for the lowest failure is the one to report.
        if (i > failed_.load(std::memory_order_relaxed)) return;
        try {
            body_(i);
        } catch (...) {
            const std::lock_guard lock(mutex_);
            if (i < failed_.load(std::memory_order_relaxed)) {
                failed_.store(i, std::memory_order_relaxed);
                error_ = std::current_exception();
            }
        }
    }

    std::size_t count_;
    std::size_t chunk_;
    const std::function<void(std::size_t)>& body_;
    std::atomic<std::size_t> next_{0};
    std::atomic<std::size_t> failed_;
    std::mutex mutex_;
    std::exception_ptr error_;
};

}  // namespace

void parallel_for(std::size_t count, const std::function<void(std::size_t)>& body, unsigned threads)
{
    if (threads == 0) threads = std::max(1u, std::thread::hardware_concurrency());
    const std::size_t workers = std::min<std::size_t>(threads, count);
    if (workers <= 1 || inside_parallel_for) {
        for (std::size_t i = 0; i < count; ++i) body(i);
        return;
    }
    // Small enough that the last chunks level out, large enough that a million tiny bodies do not fight over one
    // counter.
    Work work(count, std::max<std::size_t>(1, count / (workers * 64)), body);
    {
        std::vector<std::jthread> others;
        others.reserve(workers - 1);
        try {
            while (others.size() + 1 < workers) others.emplace_back([&work] { work.run(); });
        } catch (const std::system_error&) {
            // No more threads to be had: those that started, and this one, do it all.
        }
        work.run();
    }
    work.rethrow();
}

}  // namespace etalon
