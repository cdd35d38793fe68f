#pragma once
#include <string>
#include <vector>

#include "engine/image/film.h"

namespace etalon {

/// Rows first_row … end_row - 1 of pictures `width` pixels wide. Empty AOVs stay empty.
Aovs rows_of(const Aovs& aovs, int first_row, int end_row, int width);

/// Which rows of which picture a film has. It is kept in the film's metadata, "shard…", with a checksum over all of it.
struct ShardPlace {
    unsigned number = 1;  ///< from 1
    unsigned count = 1;
    int first_row = 0;
    int picture_height = 0;
    std::string scene;  ///< fingerprint of what is rendered
};
/// Makes `film` a shard: nothing but its metadata changes, and nothing of it may change afterwards.
void mark_shard(Film& film, const ShardPlace& place);

struct NamedFilm {
    std::string name;  ///< in errors: its file
    Film film;
};
/// The picture that the shards were parts of, in any order: the same bits, and the same metadata but for "error", as if
/// it had been rendered as one. Error(input) naming the file or the number: no shard, damaged since it was written, of
/// another picture (settings, scene, samples, program, device), given twice, or missing.
Film merge_shards(std::vector<NamedFilm> shards);

}  // namespace etalon
