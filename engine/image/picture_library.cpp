#include "engine/image/picture_library.h"

#include <dlfcn.h>
#include <fmt/format.h>
#include <sys/mman.h>

#include "engine/base/error.h"

namespace etalon::codec {
namespace {

/// The module maps 376 MB, and one of its libraries starts threads as it is loaded: where it cannot, it ends the
/// process.
constexpr std::size_t kAddressSpace = std::size_t{448} << 20;

void require_address_space()
{
    void* const probe = mmap(nullptr, kAddressSpace, PROT_NONE, MAP_PRIVATE | MAP_ANONYMOUS | MAP_NORESERVE, -1, 0);
    if (probe == MAP_FAILED)
        throw Error(Blame::machine,
                    fmt::format("pictures cannot be read or written: their libraries need {} MB of address space",
                                kAddressSpace / 1'000'000),
                    "raise the limit (ulimit -v)");
    munmap(probe, kAddressSpace);
}

PictureLibrary load()
{
    require_address_space();
    // Found by the program's own run path. Never closed: its libraries do not survive that.
    void* module = dlopen("libetalon_pictures.so", RTLD_LAZY | RTLD_LOCAL);
    void* const entry = module ? dlsym(module, "etalon_picture_library") : nullptr;
    if (!entry)
        throw Error(Blame::machine, fmt::format("pictures cannot be read or written: {}", dlerror()),
                    "install Etalon whole: libetalon_pictures.so belongs into the lib folder beside the program's");
    return *reinterpret_cast<decltype(&etalon_picture_library)>(entry)();
}

}  // namespace

const PictureLibrary& picture_library()
{
    static const PictureLibrary library = load();
    return library;
}

}  // namespace etalon::codec
