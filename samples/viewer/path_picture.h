#pragma once
#include <atomic>
#include <condition_variable>
#include <exception>
#include <mutex>
#include <optional>
#include <thread>

#include "engine/gpu/device.h"
#include "engine/image/film.h"
#include "engine/scene/pose.h"
#include "engine/scene/requirements.h"
#include "engine/scene/settings.h"

namespace etalon {

/// A path-traced picture that gets better for as long as its view stays. It is traced on a thread of its own, so that
/// the window answers while the device is busy.
class PathPicture {
 public:
    /// `posed` and the device must outlive it.
    PathPicture(gpu::Device& device, const PosedScene& posed, const RenderSettings& settings);
    ~PathPicture();
    PathPicture(const PathPicture&) = delete;
    PathPicture& operator=(const PathPicture&) = delete;

    /// From now on this view: what was traced of another is dropped. A quarter of its size comes first.
    void start(const View& view);
    /// The picture so far, when there is a better one than was taken last. Rethrows what stopped the tracing.
    std::optional<Film> take();

 private:
    void work();
    void trace(PosedScene posed, std::uint64_t turn);
    bool add(Film film, std::uint64_t turn);

    gpu::Device& device_;
    const PosedScene& posed_;
    RenderSettings settings_;

    std::mutex mutex_;  // guards what follows, but for stop_
    std::condition_variable wake_;
    std::optional<View> wanted_;
    std::uint64_t turn_ = 0;  ///< counts start()
    bool quit_ = false;
    std::optional<Film> sum_;  ///< of this turn
    bool fresh_ = false;       ///< sum_ was not taken yet
    std::exception_ptr failure_;

    std::atomic<bool> stop_ = false;  ///< what is being traced is no longer wanted
    std::thread thread_;
};

}  // namespace etalon
