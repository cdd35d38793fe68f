#include "engine/gl/context.h"

#include <fmt/format.h>

#include <thread>

#include "engine/base/error.h"
#include "engine/gl/context_state.h"

namespace etalon::gl {
namespace {

void APIENTRY hear(GLenum, GLenum type, GLuint, GLenum, GLsizei length, const GLchar* text, const void* listener)
{
    // Mesa tells what it does (performance, marker, other) on the same line.
    if (type != GL_DEBUG_TYPE_ERROR && type != GL_DEBUG_TYPE_UNDEFINED_BEHAVIOR &&
        type != GL_DEBUG_TYPE_DEPRECATED_BEHAVIOR)
        return;
    const auto& heard = *static_cast<const std::function<void(const std::string&)>*>(listener);
    heard(std::string(text, static_cast<std::size_t>(length)));
}

std::string string_of(const Functions& gl, GLenum what)
{
    const GLubyte* text = gl.GetString(what);
    return text != nullptr ? reinterpret_cast<const char*>(text) : "unknown";
}

}  // namespace

std::string_view name(ContextKind kind)
{
    return kind == ContextKind::egl ? "EGL surfaceless" : "OSMesa";
}

Context::Context(const ContextOptions& options)
    : kind_(options.kind),
      on_message_(options.on_message),
      state_(options.kind == ContextKind::egl ? make_egl(static_cast<bool>(options.on_message))
                                              : make_osmesa(static_cast<bool>(options.on_message))),
      functions_(load_functions([this](const char* function) { return state_->find(function); })),
      vendor_(string_of(functions_, GL_VENDOR)),
      renderer_(string_of(functions_, GL_RENDERER)),
      version_(string_of(functions_, GL_VERSION))
{
    GLint major = 0, minor = 0;
    functions_.GetIntegerv(GL_MAJOR_VERSION, &major);
    functions_.GetIntegerv(GL_MINOR_VERSION, &minor);
    if (major * 10 + minor < 45)
        throw Error(Blame::machine, fmt::format("{} offers OpenGL {}; 4.5 is needed", renderer_, version_));
    if (!on_message_) return;
    functions_.Enable(GL_DEBUG_OUTPUT);
    functions_.Enable(GL_DEBUG_OUTPUT_SYNCHRONOUS);
    functions_.DebugMessageCallback(hear, &on_message_);
}

Context::~Context() = default;

bool Context::is_current() const
{
    return std::this_thread::get_id() == state_->thread;
}

}  // namespace etalon::gl
