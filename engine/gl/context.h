#pragma once
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "engine/gl/functions.h"

namespace etalon::gl {

/// Ways to a context without a window, in the order in which they are tried.
enum class ContextKind {
    egl,     ///< EGL's surfaceless platform (libEGL.so.1): GPUs and Mesa's llvmpipe
    osmesa,  ///< Mesa's renderer into memory (libOSMesa.so.8): where there is no EGL
};
inline constexpr ContextKind kContextKinds[] = {ContextKind::egl, ContextKind::osmesa};
std::string_view name(ContextKind kind);  ///< "EGL surfaceless", "OSMesa"

struct ContextOptions {
    ContextKind kind = ContextKind::egl;
    /// Makes a debug context; what OpenGL says of errors and undefined behaviour is heard here.
    std::function<void(const std::string&)> on_message;
};

struct ContextState;

/// An OpenGL 4.5 core context, current on the thread that made it until it is destroyed there; a thread has one at a
/// time. The driver's libraries are opened when it is made, so that a program needs none of them to start.
class Context {
 public:
    /// Throws Error(machine) that says which step failed where the library, the platform, or OpenGL 4.5 is missing.
    explicit Context(const ContextOptions& options);
    Context(Context&&) = delete;
    Context& operator=(Context&&) = delete;
    ~Context();

    const Functions& functions() const { return functions_; }
    ContextKind kind() const { return kind_; }
    const std::string& vendor() const { return vendor_; }
    const std::string& renderer() const { return renderer_; }  ///< "llvmpipe (LLVM 15.0.6, 256 bits)"
    const std::string& version() const { return version_; }    ///< "4.5 (Core Profile) Mesa 22.3.6"
    /// True where the calling thread may use it.
    bool is_current() const;

 private:
    ContextKind kind_;
    std::function<void(const std::string&)> on_message_;
    std::unique_ptr<ContextState> state_;
    Functions functions_;
    std::string vendor_, renderer_, version_;
};

}  // namespace etalon::gl
