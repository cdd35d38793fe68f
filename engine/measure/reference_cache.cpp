#include "engine/measure/reference_cache.h"

#include <algorithm>
#include <vector>

#include "engine/base/digest.h"
#include "engine/base/error.h"
#include "engine/base/files.h"
#include "engine/image/io.h"

namespace etalon {
namespace {

namespace fs = std::filesystem;

/// In the film's metadata: files are named by a digest, which may be that of two keys.
constexpr const char* kKey = "cache.key";

}  // namespace

ReferenceCache::ReferenceCache(fs::path folder, std::uint64_t most_bytes)
    : folder_(std::move(folder)), most_bytes_(most_bytes)
{}

fs::path ReferenceCache::file_of(const std::string& key) const
{
    Digest digest;
    digest.add(key);
    return folder_ / (digest.text() + ".exr");
}

std::optional<Film> ReferenceCache::find(const std::string& key) const
{
    const fs::path path = file_of(key);
    std::error_code none;
    if (!fs::is_regular_file(path, none)) return std::nullopt;
    try {
        Film film = read_film(path);
        const auto said = film.metadata.find(kKey);
        if (said == film.metadata.end() || said->second != key) return std::nullopt;
        film.metadata.erase(said);
        fs::last_write_time(path, fs::file_time_type::clock::now(), none);  // used: not the next to go
        return film;
    } catch (const Error&) {
        return std::nullopt;
    }
}

bool ReferenceCache::keep(const std::string& key, const Film& film) const
{
    try {
        if (const std::optional<Film> there = find(key); there && there->samples >= film.samples) return true;
        make_folder(folder_);
        Film kept = film;
        kept.metadata[kKey] = key;
        write_film(kept, file_of(key));
        sweep();
        return true;
    } catch (const Error&) {
        return false;
    }
}

void ReferenceCache::sweep() const
{
    struct Kept {
        fs::path path;
        std::uint64_t bytes = 0;
        fs::file_time_type used;
    };
    std::vector<Kept> all;
    std::error_code none;
    std::uint64_t total = 0;
    for (fs::directory_iterator it(folder_, none), end; !none && it != end; it.increment(none)) {
        if (it->path().extension() != ".exr" || !it->is_regular_file(none)) continue;
        all.push_back({it->path(), it->file_size(none), it->last_write_time(none)});
        total += all.back().bytes;
    }
    std::sort(all.begin(), all.end(), [](const Kept& a, const Kept& b) { return a.used < b.used; });
    for (std::size_t i = 0; i + 1 < all.size() && total > most_bytes_; ++i) {
        if (fs::remove(all[i].path, none)) total -= all[i].bytes;
    }
}

}  // namespace etalon
