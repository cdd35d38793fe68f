#include "tools/etalon/frames.h"

#include <fmt/format.h>

#include "engine/base/error.h"

namespace etalon::cli {
namespace {

constexpr std::uint64_t kLast = 10'000'000;  // a frame's number
constexpr std::uint64_t kMost = 1'000'000;   // frames of one run
constexpr std::size_t kLooks = 16;           // frames whose bounds are measured

}  // namespace

std::vector<Frame> frames(const Arguments& arguments)
{
    const auto time = arguments.number("time", -1e9, 1e9);
    const auto text = arguments.text("frames");
    const double fps = arguments.number("fps", 1e-6, 1e6).value_or(24);
    if (!text) return {{.number = {}, .time = time}};
    if (time) throw Error(Blame::input, "--time and --frames exclude each other", "frame n is at n/fps seconds");
    const std::vector<std::string> parts = split(*text, ':');
    const auto first = parse_count(parts.front());
    const auto last = parse_count(parts.back());
    if (parts.size() > 2 || !first || !last || *last < *first || *last > kLast)
        refuse("frames", *text, fmt::format("A:B, the first and the last frame, both from 0 to {}", kLast),
               "for example --frames 0:47 --fps 24 -o 'out/####.png'");
    if (*last - *first >= kMost)
        refuse("frames", *text, fmt::format("at most {} frames", kMost), "render it in several runs");
    std::vector<Frame> out;
    for (std::uint64_t n = *first; n <= *last; ++n)
        out.push_back({.number = static_cast<std::int64_t>(n), .time = static_cast<double>(n) / fps});
    return out;
}

std::string with_number(const std::string& pattern, const Frame& frame)
{
    if (!frame.number) return pattern;
    const std::size_t end = pattern.find_last_of('#');
    if (end == std::string::npos)
        throw Error(Blame::input, fmt::format("the output {} has no place for the frame's number", pattern),
                    "put #### into it: -o 'out/####.png'");
    const std::size_t before = pattern.find_last_not_of('#', end);
    const std::size_t begin = before == std::string::npos ? 0 : before + 1;
    return pattern.substr(0, begin) + fmt::format("{:0{}}", *frame.number, end + 1 - begin) + pattern.substr(end + 1);
}

std::pair<dvec3, dvec3> bounds_over(const Scene& scene, PoseSettings settings, const std::vector<Frame>& frames)
{
    assume(!frames.empty());
    std::optional<std::pair<dvec3, dvec3>> box;
    const std::size_t looks = std::min(frames.size(), kLooks);
    for (std::size_t i = 0; i < looks; ++i) {
        settings.time = frames[looks == 1 ? 0 : i * (frames.size() - 1) / (looks - 1)].time;
        const PosedScene posed = pose(scene, settings);
        if (!box) box = {posed.bounds_min, posed.bounds_max};
        box = {glm::min(box->first, posed.bounds_min), glm::max(box->second, posed.bounds_max)};
    }
    return *box;
}

}  // namespace etalon::cli
