#include "tools/etalon/output.h"

#include <fmt/format.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <filesystem>

#include "engine/base/error.h"
#include "engine/base/files.h"
#include "engine/image/io.h"
#include "tools/etalon/terminal.h"

namespace etalon::cli {
namespace fs = std::filesystem;

void check_output(const std::string& path)
{
    if (path == "-") return;
    static_cast<void>(picture_format(path));  // throws for an extension that is none of ours
    const fs::path folder = fs::path(path).parent_path();
    check_folder(folder);
    check_replaceable(path);
    if (folder.empty()) return;
    std::error_code fault;
    fs::create_directories(folder, fault);
    if (fault)
        throw Error(Blame::input, fmt::format("cannot make the folder {}: {}", folder.string(), fault.message()),
                    "choose another place");
}

void check_folder(const fs::path& path)
{
    std::error_code fault;
    fs::path nearest = path.lexically_normal();
    while (!nearest.empty() && nearest != nearest.root_path() && !fs::exists(nearest, fault))
        nearest = nearest.parent_path();
    if (nearest.empty()) nearest = ".";
    const bool is_folder = fs::is_directory(nearest, fault);
    if (is_folder && access(nearest.c_str(), W_OK) == 0) return;
    throw Error(Blame::input,
                fmt::format("cannot write to {}: {}{}", path.empty() ? "the current folder" : path.string(),
                            nearest == path || path.empty() ? "" : nearest.string() + ": ",
                            is_folder ? std::strerror(errno) : "no folder"),
                "choose another place, or change its permissions");
}

void write_output(const Film& film, const DevelopSettings& settings, const std::string& path)
{
    if (path != "-" && picture_format(path) == PictureFormat::exr) {
        write_film(film, path);
        return;
    }
    constexpr std::string_view kTones[] = {"none", "aces", "neutral", "reinhard", "agx"};
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
