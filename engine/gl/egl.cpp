#include <EGL/egl.h>
#include <EGL/eglext.h>
#include <fmt/format.h>

#include <string_view>

#include "engine/base/error.h"
#include "engine/gl/context_state.h"

namespace etalon::gl {
namespace {

/// The functions of libEGL that a context without a surface needs.
struct Egl {
    Library library{"libEGL.so.1", "libegl1 libegl-mesa0"};
    PFNEGLGETPROCADDRESSPROC get_proc_address = nullptr;
    PFNEGLQUERYSTRINGPROC query_string = nullptr;
    PFNEGLGETPLATFORMDISPLAYPROC get_platform_display = nullptr;
    PFNEGLINITIALIZEPROC initialize = nullptr;
    PFNEGLTERMINATEPROC terminate = nullptr;
    PFNEGLBINDAPIPROC bind_api = nullptr;
    PFNEGLCREATECONTEXTPROC create_context = nullptr;
    PFNEGLDESTROYCONTEXTPROC destroy_context = nullptr;
    PFNEGLMAKECURRENTPROC make_current = nullptr;
    PFNEGLGETERRORPROC get_error = nullptr;

    Egl()
    {
        library.get(get_proc_address, "eglGetProcAddress");
        library.get(query_string, "eglQueryString");
        library.get(get_platform_display, "eglGetPlatformDisplay");
        library.get(initialize, "eglInitialize");
        library.get(terminate, "eglTerminate");
        library.get(bind_api, "eglBindAPI");
        library.get(create_context, "eglCreateContext");
        library.get(destroy_context, "eglDestroyContext");
        library.get(make_current, "eglMakeCurrent");
        library.get(get_error, "eglGetError");
    }

    [[noreturn]] void fail(const char* call) const
    {
        throw Error(Blame::machine, fmt::format("{} failed (EGL error {:#06x})", call, get_error()),
                    "install an OpenGL 4.5 driver; on Debian: apt install libegl-mesa0 libgl1-mesa-dri");
    }
};

bool lists(const char* extensions, std::string_view wanted)
{
    const std::string all = fmt::format(" {} ", extensions != nullptr ? extensions : "");
    return all.find(fmt::format(" {} ", wanted)) != std::string::npos;
}

class EglState : public ContextState {
 public:
    explicit EglState(bool debug)
    {
        try {
            create(debug);
        } catch (...) {
            release();
            throw;
        }
    }
    ~EglState() override { release(); }

    void* find(const char* function) const override { return reinterpret_cast<void*>(egl_.get_proc_address(function)); }

 private:
    void create(bool debug)
    {
        if (!lists(egl_.query_string(EGL_NO_DISPLAY, EGL_EXTENSIONS), "EGL_MESA_platform_surfaceless"))
            throw Error(Blame::machine, "this machine's EGL has no surfaceless platform",
                        "on Debian: apt install libegl-mesa0");
        display_ = egl_.get_platform_display(EGL_PLATFORM_SURFACELESS_MESA, nullptr, nullptr);
        if (display_ == EGL_NO_DISPLAY) egl_.fail("eglGetPlatformDisplay");
        if (egl_.initialize(display_, nullptr, nullptr) == EGL_FALSE) egl_.fail("eglInitialize");
        initialized_ = true;
        if (!lists(egl_.query_string(display_, EGL_EXTENSIONS), "EGL_KHR_surfaceless_context"))
            throw Error(Blame::machine, "this machine's EGL has no context without a surface");
        if (egl_.bind_api(EGL_OPENGL_API) == EGL_FALSE) egl_.fail("eglBindAPI");
        const EGLint attributes[] = {EGL_CONTEXT_MAJOR_VERSION,
                                     4,
                                     EGL_CONTEXT_MINOR_VERSION,
                                     5,
                                     EGL_CONTEXT_OPENGL_PROFILE_MASK,
                                     EGL_CONTEXT_OPENGL_CORE_PROFILE_BIT,
                                     EGL_CONTEXT_OPENGL_DEBUG,
                                     debug ? EGL_TRUE : EGL_FALSE,
                                     EGL_NONE};
        context_ = egl_.create_context(display_, EGL_NO_CONFIG_KHR, EGL_NO_CONTEXT, attributes);
        if (context_ == EGL_NO_CONTEXT) egl_.fail("eglCreateContext of OpenGL 4.5");
        if (egl_.make_current(display_, EGL_NO_SURFACE, EGL_NO_SURFACE, context_) == EGL_FALSE)
            egl_.fail("eglMakeCurrent");
    }

    void release()
    {
        if (context_ != EGL_NO_CONTEXT) {
            egl_.make_current(display_, EGL_NO_SURFACE, EGL_NO_SURFACE, EGL_NO_CONTEXT);
            egl_.destroy_context(display_, context_);
        }
        if (initialized_) egl_.terminate(display_);
    }

    Egl egl_;
    EGLDisplay display_ = EGL_NO_DISPLAY;
    EGLContext context_ = EGL_NO_CONTEXT;
    bool initialized_ = false;
};

}  // namespace

std::unique_ptr<ContextState> make_egl(bool debug)
{
    return std::make_unique<EglState>(debug);
}

}  // namespace etalon::gl
