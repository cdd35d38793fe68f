#include "engine/measure/frontier_profile.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <sstream>

#include "engine/base/digest.h"
#include "engine/base/error.h"
#include "engine/base/files.h"
#include "engine/scene/knobs.h"

namespace etalon {
namespace {

namespace fs = std::filesystem;

constexpr std::string_view kFormat = "etalon-profile/1";

/// Settings as the options of the command line say them, of the knobs alone.
std::optional<RenderSettings> settings_from(std::istringstream& words)
{
    RenderSettings settings;
    settings.renderer = Renderer::raster;
    std::string option, value;
    while (words >> option >> value) {
        if (!option.starts_with("--")) return std::nullopt;
        if (option == "--renderer") continue;
        if (find_knob(option.substr(2)) == nullptr) return std::nullopt;
        set_knob(settings, option.substr(2), value);
    }
    return settings;
}

std::string text_of(const std::string& key, const FrontierProfile& profile)
{
    std::string text = fmt::format("{}\n{}\n{} {}\n", kFormat, key, profile.size.x, profile.size.y);
    for (const FrontierProfile::Point& point : profile.points)
        text += fmt::format("{:.17g} {:.17g} {:.17g} {}\n", point.seconds, point.first_seconds, point.error,
                            flags_of(point.settings));
    return text;
}

std::optional<FrontierProfile> parsed(const std::string& text, const std::string& key)
{
    std::istringstream lines(text);
    std::string line;
    if (!std::getline(lines, line) || line != kFormat) return std::nullopt;
    if (!std::getline(lines, line) || line != key) return std::nullopt;
    FrontierProfile profile;
    if (!std::getline(lines, line)) return std::nullopt;
    std::istringstream size(line);
    if (!(size >> profile.size.x >> profile.size.y) || profile.size.x < 1 || profile.size.y < 1) return std::nullopt;
    while (std::getline(lines, line)) {
        std::istringstream words(line);
        FrontierProfile::Point point;
        if (!(words >> point.seconds >> point.first_seconds >> point.error)) return std::nullopt;
        const std::optional<RenderSettings> settings = settings_from(words);
        if (!settings || !(point.seconds >= 0) || !(point.first_seconds >= 0) || !(point.error >= 0))
            return std::nullopt;
        point.settings = *settings;
        profile.points.push_back(point);
    }
    if (profile.points.empty()) return std::nullopt;
    return profile;
}

/// The best of the points that are allowed; the first of equal ones.
template <class Allowed, class Value>
const FrontierProfile::Point* least(const std::vector<FrontierProfile::Point>& points, Allowed allowed, Value value)
{
    const FrontierProfile::Point* best = nullptr;
    for (const FrontierProfile::Point& point : points)
        if (allowed(point) && (best == nullptr || value(point) < value(*best))) best = &point;
    return best;
}

}  // namespace

double FrontierProfile::seconds(const Point& point, ivec2 picture) const
{
    const double pixels = double(picture.x) * picture.y / (double(size.x) * size.y);
    return std::max(point.first_seconds - point.seconds, 0.0) + point.seconds * pixels;
}

const FrontierProfile::Point* FrontierProfile::within_error(double error, ivec2 picture) const
{
    return least(
        points, [&](const Point& p) { return p.error <= error; }, [&](const Point& p) { return seconds(p, picture); });
}

const FrontierProfile::Point* FrontierProfile::within_time(double most, ivec2 picture) const
{
    return least(
        points, [&](const Point& p) { return seconds(p, picture) <= most; }, [](const Point& p) { return p.error; });
}

const FrontierProfile::Point* FrontierProfile::most_accurate() const
{
    return least(
        points, [](const Point&) { return true; }, [](const Point& p) { return p.error; });
}

const FrontierProfile::Point* FrontierProfile::fastest(ivec2 picture) const
{
    return least(
        points, [](const Point&) { return true; }, [&](const Point& p) { return seconds(p, picture); });
}

FrontierProfile profile_of(const Tradeoff& tradeoff)
{
    const Film& reference = tradeoff.reference;
    double mean = 0;
    for (const vec3& value : reference.mean) mean += (double(value.x) + value.y + value.z) / 3;
    mean /= std::max<double>(double(reference.mean.size()), 1);
    FrontierProfile out{.size = ivec2(reference.width, reference.height), .points = {}};
    if (!(mean > 0)) return out;
    for (const TradePoint& point : tradeoff.points) {
        const double error = point.metrics.rmse / mean;
        if (point.settings.renderer != Renderer::raster || !std::isfinite(error)) continue;
        out.points.push_back({.settings = point.settings,
                              .seconds = point.time.median(),
                              .first_seconds = point.first_seconds,
                              .error = error});
    }
    return out;
}

ProfileStore::ProfileStore(fs::path folder, std::size_t most) : folder_(std::move(folder)), most_(most) {}

fs::path ProfileStore::file_of(const std::string& key) const
{
    Digest digest;
    digest.add(key);
    return folder_ / (digest.text() + ".profile");
}

std::optional<FrontierProfile> ProfileStore::find(const std::string& key) const
{
    const fs::path path = file_of(key);
    std::error_code none;
    if (!fs::is_regular_file(path, none)) return std::nullopt;
    try {
        const std::vector<std::byte> bytes = read_file(path);
        std::optional<FrontierProfile> profile =
            parsed(std::string(reinterpret_cast<const char*>(bytes.data()), bytes.size()), key);
        if (profile) fs::last_write_time(path, fs::file_time_type::clock::now(), none);  // used: not the next to go
        return profile;
    } catch (const Error&) {
        return std::nullopt;
    }
}

bool ProfileStore::keep(const std::string& key, const FrontierProfile& profile) const
{
    if (profile.points.empty()) return false;
    try {
        make_folder(folder_);
        replace_file(file_of(key), text_of(key, profile));
        sweep();
        return true;
    } catch (const Error&) {
        return false;
    }
}

void ProfileStore::sweep() const
{
    std::vector<std::pair<fs::file_time_type, fs::path>> all;
    std::error_code none;
    for (fs::directory_iterator it(folder_, none), end; !none && it != end; it.increment(none))
        if (it->path().extension() == ".profile") all.emplace_back(it->last_write_time(none), it->path());
    std::sort(all.begin(), all.end());
    for (std::size_t i = 0; i + most_ < all.size(); ++i) fs::remove(all[i].second, none);
}

}  // namespace etalon
