// Any file is a film, an environment, or the state of one that a path tracer goes on from, or an Error.
#include <sys/mman.h>
#include <unistd.h>

#include <cstdint>
#include <string>

#include "engine/base/error.h"
#include "engine/image/film_state.h"
#include "engine/image/io.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size);

namespace {

using namespace etalon;

// The readers take paths: a file in memory, always the same.
class MemoryFile {
 public:
    MemoryFile() : descriptor_(memfd_create("fuzz", 0)), path_("/proc/self/fd/" + std::to_string(descriptor_))
    {
        assume(descriptor_ >= 0);
    }
    const std::string& holding(const std::uint8_t* data, std::size_t size) const
    {
        assume(ftruncate(descriptor_, 0) == 0);
        assume(pwrite(descriptor_, data, size, 0) == static_cast<ssize_t>(size));
        return path_;
    }

 private:
    int descriptor_;
    std::string path_;
};

template <typename Read>
void refuse_or(const Read& read)
{
    try {
        read();
    } catch (const Error& error) {
        assume(error.blame() == Blame::input && error.what()[0] != '\0');
    }
}

}  // namespace

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size)
{
    static const MemoryFile file;
    static const Limits limits = [] {
        Limits made;
        made.image_pixels = 1 << 16;  // the same code as for 2^28, at the speed of a fuzzer
        return made;
    }();
    const std::string& path = file.holding(data, size);
    refuse_or([&] {
        const Film film = read_film(path, limits);
        assume(film.mean.size() == film.pixel_count() && film.pixel_count() <= limits.image_pixels);
        assume(film.variance.empty() || film.variance.size() == film.pixel_count());
        assume(film.aovs.depth.empty() || film.aovs.depth.size() == film.pixel_count());
        static_cast<void>(estimate_error(film));
    });
    refuse_or([&] {
        const Image image = read_image(path, limits);
        assume(image.values.size() == image.pixel_count() * std::size_t(image.channels));
    });
    refuse_or([&] { static_cast<void>(read_film_state(path)); });
    return 0;
}
