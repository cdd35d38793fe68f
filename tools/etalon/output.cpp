#include "tools/etalon/output.h"

#include <fmt/format.h>
#include <unistd.h>

#include <filesystem>

#include "engine/base/error.h"
#include "engine/image/io.h"
#include "tools/etalon/terminal.h"

namespace etalon::cli {
namespace fs = std::filesystem;

void check_output(const std::string& path)
{
    if (path == "-") return;
    static_cast<void>(picture_format(path));  // throws for an extension that is none of ours
    const auto refuse = [&](std::string why, std::string mend) {
        throw Error(Blame::input, fmt::format("cannot write {}: {}", path, why), std::move(mend));
    };
    std::error_code fault;
    if (fs::is_directory(path, fault)) refuse("it is a folder", "name a file in it");
    const fs::path folder = fs::absolute(path).parent_path();
    fs::create_directories(folder, fault);
    if (!fs::is_directory(folder))
        refuse(fmt::format("its folder cannot be made ({})", fault.message()), "choose another place");
    if (access(folder.c_str(), W_OK) != 0)
        refuse("its folder may not be written to", "choose another place or change its permissions");
}

void write_output(const Film& film, const DevelopSettings& settings, const std::string& path)
{
    if (path != "-" && picture_format(path) == PictureFormat::exr) {
        write_film(film, path);
        return;
    }
    constexpr std::string_view kTones[] = {"none", "aces", "neutral"};
    std::map<std::string, std::string> metadata = film.metadata;
    metadata["develop"] =
        fmt::format("exposure={} tone={}", settings.exposure, kTones[static_cast<int>(settings.tone)]);
    const Image picture = develop(film, settings);
    if (path == "-")
        put(encode_png(picture, metadata));
    else
        write_png(picture, metadata, path);
}

std::vector<std::string> suspicions(const Film& film)
{
    std::vector<std::string> found;
    const FilmCheck findings = check(film);
    if (findings.nan_pixels > 0) found.push_back(fmt::format("{} pixels are NaN (shown magenta)", findings.nan_pixels));
    if (findings.inf_pixels > 0)
        found.push_back(fmt::format("{} pixels are infinite (shown magenta)", findings.inf_pixels));
    if (film.nonfinite > 0)
        found.push_back(fmt::format("{} samples were NaN or infinite and were left out", film.nonfinite));
    if (findings.single_colour)
        found.push_back(
            "the whole picture is one single colour: is the camera looking at the scene, and is there light?");
    return found;
}

}  // namespace etalon::cli
