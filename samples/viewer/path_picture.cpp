#include "samples/viewer/path_picture.h"

#include <algorithm>
#include <chrono>
#include <utility>

namespace etalon {
namespace {

constexpr int kCoarse = 4;  // first a picture of this fraction of the size, so that a drag is seen at once
constexpr std::chrono::milliseconds kBetweenFilms(100);  // reading a film back costs time that tracing could use

}  // namespace

PathPicture::PathPicture(gpu::Device& device, const PosedScene& posed, const RenderSettings& settings)
    : device_(device), posed_(posed), settings_(settings)
{
    settings_.renderer = Renderer::path;
    settings_.aovs = false;
    thread_ = std::thread([this] { work(); });
}

PathPicture::~PathPicture()
{
    {
        const std::lock_guard lock(mutex_);
        quit_ = true;
        stop_ = true;
    }
    wake_.notify_one();
    thread_.join();
}

void PathPicture::start(const View& view)
{
    {
        const std::lock_guard lock(mutex_);
        wanted_ = view;
        film_.reset();
        stop_ = true;
    }
    wake_.notify_one();
}

std::optional<Film> PathPicture::take()
{
    const std::lock_guard lock(mutex_);
    if (failure_) std::rethrow_exception(failure_);
    return std::exchange(film_, std::nullopt);
}

void PathPicture::work()
{
    try {
        PathTracer tracer(device_, posed_, require(posed_, settings_), settings_);
        while (true) {
            std::unique_lock lock(mutex_);
            wake_.wait(lock, [this] { return quit_ || wanted_.has_value(); });
            if (quit_) return;
            const View view = *std::exchange(wanted_, std::nullopt);
            stop_ = false;
            lock.unlock();
            trace(tracer, view);
        }
    } catch (...) {
        const std::lock_guard lock(mutex_);
        failure_ = std::current_exception();
    }
}

void PathPicture::trace(PathTracer& tracer, const View& view)
{
    View coarse = view;
    coarse.width = std::max(1, view.width / kCoarse);
    coarse.height = std::max(1, view.height / kCoarse);
    tracer.start(coarse);
    while (!tracer.step(1))
        if (stop_) return;
    if (!publish(tracer)) return;

    tracer.start(view);
    auto published = std::chrono::steady_clock::time_point::min();
    while (!stop_ && tracer.samples() < settings_.spp) {
        if (!tracer.step(settings_.spp)) continue;
        const bool last = tracer.samples() >= settings_.spp;
        if (!last && std::chrono::steady_clock::now() < published + kBetweenFilms) continue;
        if (!publish(tracer)) return;
        published = std::chrono::steady_clock::now();
    }
}

bool PathPicture::publish(PathTracer& tracer)
{
    Film film = tracer.film();
    const std::lock_guard lock(mutex_);
    if (stop_) return false;  // of a view that is no longer wanted
    film_ = std::move(film);
    return true;
}

}  // namespace etalon
