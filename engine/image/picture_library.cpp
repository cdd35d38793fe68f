#include "engine/image/picture_library.h"

#include <dlfcn.h>
#include <fmt/format.h>

#include "engine/base/error.h"

namespace etalon::codec {
namespace {

PictureLibrary load()
{
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
