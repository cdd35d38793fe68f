#pragma once
#include <atomic>
#include <condition_variable>
#include <exception>
#include <mutex>
#include <optional>
#include <thread>

#include "engine/gpu/device.h"
#include "engine/image/film.h"
#include "engine/render/path.h"
#include "engine/scene/pose.h"
#include "engine/scene/requirements.h"
#include "engine/scene/settings.h"

namespace etalon {

/// A path-traced picture that gets better while its view stays, up to settings.spp samples a pixel. It is traced on a
/// thread of its own, so that the window answers while the device is busy.
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
    void trace(PathTracer& tracer, const View& view);
    bool publish(PathTracer& tracer);

    gpu::Device& device_;
    const PosedScene& posed_;
    RenderSettings settings_;

    std::mutex mutex_;  // guards what follows, but for stop_
    std::condition_variable wake_;
    std::optional<View> wanted_;
    bool quit_ = false;
    std::optional<Film> film_;  ///< of the view wanted last, not taken yet
    std::exception_ptr failure_;

    std::atomic<bool> stop_ = false;  ///< what is being traced is no longer wanted
    std::thread thread_;
};

}  // namespace etalon
