#pragma once
#include <filesystem>
#include <string>
#include <vector>

#include "engine/image/develop.h"
#include "engine/image/film.h"

namespace etalon::cli {

/// Refuses, before anything is rendered, an output that could not be written: an extension that is neither .png nor
/// .exr, a folder in its place, a parent that is no folder or cannot be written to. Makes missing parent folders.
void check_output(const std::string& path);

/// Refuses a folder that is not there and could not be made, or that may not be written to. Makes nothing.
void check_folder(const std::filesystem::path& path);

/// Writes the film as the extension says; "-" is PNG on standard output.
void write_output(const Film& film, const DevelopSettings& develop, const std::string& path);

/// What must not be overlooked in a film, one line each: NaN, Inf, left-out samples, one single colour.
std::vector<std::string> suspicions(const Film& film);

}  // namespace etalon::cli
