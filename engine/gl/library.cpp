#include <dlfcn.h>
#include <fmt/format.h>

#include "engine/base/error.h"
#include "engine/gl/context_state.h"

namespace etalon::gl {

Library::Library(const char* file, const char* package)
    : file_(file), handle_(dlopen(file, RTLD_NOW | RTLD_LOCAL | RTLD_NODELETE))
{
    if (handle_ == nullptr)
        throw Error(Blame::machine, fmt::format("this machine has no {}", file),
                    fmt::format("on Debian: apt install {}", package));
}

void* Library::address(const char* name) const
{
    void* found = dlsym(handle_, name);
    if (found == nullptr) throw Error(Blame::machine, fmt::format("{} lacks {}", file_, name));
    return found;
}

}  // namespace etalon::gl
