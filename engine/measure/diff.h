#pragma once
#include <filesystem>
#include <optional>

#include "engine/measure/compare.h"

namespace etalon {

/// Two picture files and how they compare.
struct FileDiff {
    Film a;
    Film b;
    Comparison comparison;
};

/// A film from a file: our EXR with its variance, or any picture read_image reads, without variance (sRGB is decoded).
Film load_film(const std::filesystem::path& path);

/// Compares two files. Where there is neither variance on both sides nor a budget, every value must be equal to within
/// `settings.rounding` of the larger one, or the verdict is `different`: a diff always has a verdict.
FileDiff diff_files(const std::filesystem::path& a, const std::filesystem::path& b,
                    const CompareSettings& settings = {});

/// The table that a terminal prints, and the same as JSON (schema "etalon-diff/1").
std::string diff_table(const FileDiff& diff);
std::string diff_json(const FileDiff& diff, const std::string& name_a, const std::string& name_b);

}  // namespace etalon
