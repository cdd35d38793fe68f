#pragma once
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>

#include "engine/image/film.h"

namespace etalon {

/// Converged pictures kept in a folder between runs, by what they are pictures of. Files are replaced at once; what is
/// damaged or not what it says counts as absent. When there is more than `most_bytes`, the files that were not used for
/// longest go. Several processes may share it.
class ReferenceCache {
 public:
    explicit ReferenceCache(std::filesystem::path folder, std::uint64_t most_bytes = std::uint64_t{512} << 20);

    /// `key` says everything that decides the picture but the number of its samples: the film tells that.
    std::optional<Film> find(const std::string& key) const;
    /// Unless a film of more samples is there. False where it could not be kept: a full disk is no failure of what it
    /// was made for.
    bool keep(const std::string& key, const Film& film) const;

 private:
    std::filesystem::path file_of(const std::string& key) const;
    void sweep() const;

    std::filesystem::path folder_;
    std::uint64_t most_bytes_;
};

}  // namespace etalon
