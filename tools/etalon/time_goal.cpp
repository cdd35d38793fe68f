#include "tools/etalon/time_goal.h"

#include <fmt/format.h>

#include <unistd.h>
#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <ctime>
#include <fstream>
#include <random>
#include <sstream>
#include <thread>

#include "engine/base/error.h"
#include "engine/image/io.h"
#include "tools/etalon/output.h"

namespace etalon::cli {
namespace {

using Seconds = std::chrono::duration<double>;

double seconds_since(TimePoint start)
{
    return Seconds(std::chrono::steady_clock::now() - start).count();
}

/// What EXR takes of a pixel against PNG: 40 bytes of float are compressed for 4 of integers (measured, 1080p).
constexpr double kExrAgainstPng = 1.5;
/// Of the estimate of writing: disks and other processes are not asked.
constexpr double kReserve = 1.25;
/// A step of the path tracer and the reading of a film may come after the last look at the clock.
constexpr double kLastStep = 0.1;

/// Noise, which compresses worst.
Film noise(int width, int height)
{
    Film film{.width = width, .height = height, .samples = 1};
    std::minstd_rand random;
    std::uniform_real_distribution<float> uniform(0, 1);
    for (std::size_t i = 0; i < film.pixel_count(); ++i)
        film.mean.emplace_back(uniform(random), uniform(random), uniform(random));
    film.alpha.assign(film.pixel_count(), 1);
    return film;
}

}  // namespace

TimePoint process_start()
{
    const TimePoint now = std::chrono::steady_clock::now();
    std::ifstream file("/proc/self/stat");
    std::string text;
    std::getline(file, text);
    // Field 22, counted behind the parenthesis that ends the name, which may hold anything.
    const std::size_t end = text.rfind(')');
    if (end == std::string::npos) return now;
    std::istringstream fields(text.substr(end + 1));
    std::string field;
    for (int i = 3; i <= 22; ++i) fields >> field;
    timespec since_boot{};
    if (clock_gettime(CLOCK_BOOTTIME, &since_boot) != 0) return now;
    const double started = std::strtod(field.c_str(), nullptr) / double(sysconf(_SC_CLK_TCK));
    const double age = double(since_boot.tv_sec) + 1e-9 * double(since_boot.tv_nsec) - started;
    // Containers may count from another boot: an age that cannot be is none.
    if (!(age > 0 && age < 60)) return now;
    return now - std::chrono::duration_cast<std::chrono::steady_clock::duration>(Seconds(age));
}

std::optional<double> time_goal(const Arguments& arguments, const RenderSettings& settings)
{
    const std::optional<double> seconds = arguments.number("max-time", 1e-3, 1e7);
    if (!seconds) return std::nullopt;
    if (settings.renderer == Renderer::reference_raster)
        throw Error(Blame::input, "--max-time needs a renderer that can stop when the time is up",
                    "add --renderer path");
    return seconds;
}

TimePoint TimePlan::last_sample() const
{
    const double left = std::max(seconds - kReserve * writing - kLastStep, 0.0);
    return begin + std::chrono::duration_cast<std::chrono::steady_clock::duration>(Seconds(left));
}

double TimePlan::left() const
{
    return Seconds(last_sample() - std::chrono::steady_clock::now()).count();
}

double TimePlan::spent() const
{
    return seconds_since(begin);
}

TimePlan plan_time(TimePoint begin, double seconds, ivec2 size, const std::vector<std::string>& outputs,
                   const DevelopSettings& develop)
{
    const Film strip = noise(std::min(size.x, 256), std::min(size.y, 32));
    // The library that codes pictures is loaded by the first: that is no cost of a pixel.
    static_cast<void>(encode_png(etalon::develop(noise(1, 1), develop), {}));
    const TimePoint start = std::chrono::steady_clock::now();
    static_cast<void>(encode_png(etalon::develop(strip, develop), {}));
    const double a_pixel = seconds_since(start) / double(strip.pixel_count());
    double pictures = 0;
    for (const std::string& output : outputs)
        pictures += output != "-" && picture_format(output) == PictureFormat::exr ? kExrAgainstPng : 1;
    return {.begin = begin, .seconds = seconds, .writing = pictures * a_pixel * double(size.x) * double(size.y)};
}

std::string tell_time(const TimePlan& plan, double before_samples, double written)
{
    const double spent = plan.spent();
    std::string text =
        fmt::format("{:.3g} s of {:.3g} s asked, {:.3g} s of them before the first sample and {:.2g} s for writing",
                    spent, plan.seconds, before_samples, written);
    double load = 0;
    const unsigned processors = std::max(std::thread::hardware_concurrency(), 1u);
    if (getloadavg(&load, 1) == 1 && load > 1.5 * processors)
        text += fmt::format("; the machine is busy (load {:.1f} on {} processors), so that others take a part of it",
                            load, processors);
    if (spent > 1.02 * plan.seconds)
        text += fmt::format("; the least that this picture takes here is about {:.2g} s",
                            before_samples + written + kLastStep);
    return text;
}

}  // namespace etalon::cli
