#include "samples/viewer/path_picture.h"

#include <algorithm>
#include <utility>

#include "engine/render/render.h"

namespace etalon {
namespace {

constexpr int kCoarse = 4;  // first a picture of this fraction of the size, so that a drag is seen at once
constexpr std::uint64_t kMostPerPass = 16;  // samples: passes grow, but the picture still comes alive now and then

/// The mean of two films of one size by their sample counts.
void merge(Film& sum, const Film& more)
{
    const double all = static_cast<double>(sum.samples + more.samples);
    const float weight = static_cast<float>(static_cast<double>(more.samples) / all);
    for (std::size_t i = 0; i < sum.mean.size(); ++i) {
        sum.mean[i] += weight * (more.mean[i] - sum.mean[i]);
        sum.alpha[i] += weight * (more.alpha[i] - sum.alpha[i]);
    }
    sum.samples += more.samples;
}

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
        ++turn_;
        sum_.reset();
        fresh_ = false;
        stop_ = true;
    }
    wake_.notify_one();
}

std::optional<Film> PathPicture::take()
{
    const std::lock_guard lock(mutex_);
    if (failure_) std::rethrow_exception(failure_);
    if (!fresh_) return std::nullopt;
    fresh_ = false;
    return sum_;
}

void PathPicture::work()
{
    while (true) {
        PosedScene posed = posed_;
        std::uint64_t turn = 0;
        {
            std::unique_lock lock(mutex_);
            wake_.wait(lock, [this] { return quit_ || wanted_.has_value(); });
            if (quit_) return;
            posed.view = *std::exchange(wanted_, std::nullopt);
            turn = turn_;
            stop_ = false;
        }
        try {
            trace(std::move(posed), turn);
        } catch (...) {
            const std::lock_guard lock(mutex_);
            failure_ = std::current_exception();
            return;
        }
    }
}

void PathPicture::trace(PosedScene posed, std::uint64_t turn)
{
    const Progress progress(nullptr, &stop_);
    const View full = posed.view;
    posed.view.width = std::max(1, full.width / kCoarse);
    posed.view.height = std::max(1, full.height / kCoarse);
    RenderSettings settings = settings_;
    settings.spp = 1;
    if (!add(render_path(device_, posed, require(posed, settings), settings, progress), turn)) return;

    posed.view = full;
    const Requirements required = require(posed, settings);
    for (std::uint64_t pass = 0;; ++pass) {
        settings.spp = std::min(std::uint64_t{1} << std::min<std::uint64_t>(pass / 2, 16), kMostPerPass);
        settings.seed = settings_.seed + pass;
        Film film = render_path(device_, posed, required, settings, progress);
        if (stop_ || !add(std::move(film), turn)) return;
    }
}

bool PathPicture::add(Film film, std::uint64_t turn)
{
    const std::lock_guard lock(mutex_);
    if (turn != turn_ || quit_ || film.samples == 0) return false;
    if (sum_ && sum_->width == film.width)
        merge(*sum_, film);
    else
        sum_ = std::move(film);
    fresh_ = true;
    return true;
}

}  // namespace etalon
