#include "engine/gl/functions.h"

#include <fmt/format.h>

#include "engine/base/error.h"

namespace etalon::gl {
namespace {

const char* name_of(GLenum error)
{
    switch (error) {
        case GL_INVALID_ENUM:
            return "GL_INVALID_ENUM";
        case GL_INVALID_VALUE:
            return "GL_INVALID_VALUE";
        case GL_INVALID_OPERATION:
            return "GL_INVALID_OPERATION";
        case GL_INVALID_FRAMEBUFFER_OPERATION:
            return "GL_INVALID_FRAMEBUFFER_OPERATION";
        case GL_OUT_OF_MEMORY:
            return "GL_OUT_OF_MEMORY";
        default:
            return "an unknown error";
    }
}

}  // namespace

Functions load_functions(const std::function<void*(const char*)>& find)
{
    Functions functions;
    const auto get = [&]<class F>(F& function, const char* name) {
        function = reinterpret_cast<F>(find(name));
        if (function == nullptr)
            throw Error(Blame::machine, fmt::format("the OpenGL driver lacks {}, which is part of OpenGL 4.5", name));
    };
#define ETALON_GL_LOAD(name, type) get(functions.name, "gl" #name);
    ETALON_GL_FUNCTIONS(ETALON_GL_LOAD)
#undef ETALON_GL_LOAD
    return functions;
}

void check(const Functions& gl, const char* call)
{
    const GLenum error = gl.GetError();
    if (error == GL_NO_ERROR) return;
    throw Error(Blame::machine, fmt::format("{}: {}", call, name_of(error)),
                error == GL_OUT_OF_MEMORY ? "render a smaller picture or scene" : "");
}

}  // namespace etalon::gl
