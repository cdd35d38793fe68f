#pragma once
#include "engine/image/film.h"
#include "engine/image/post.h"

namespace etalon::reference {

/// Applies post passes to a film as docs/equations.md states them, (IP-1) to (IP-15), in double and without thought of
/// speed: what engine/render/post.h is held against, and what post-processes the pictures of the CPU renderers. Same
/// result whatever the number of threads (0: one per core). Throws Error(input) where the chain needs AOVs that the
/// film lacks.
Film apply_post(Film film, const PostChain& chain, unsigned threads = 0);

}  // namespace etalon::reference
