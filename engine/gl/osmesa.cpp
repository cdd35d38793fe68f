#include <array>

#include "engine/base/error.h"
#include "engine/gl/context_state.h"
#include "engine/gl/functions.h"

namespace etalon::gl {
namespace {

// From the interface of OSMesa 11.2 and later (GL/osmesa.h), which newer Mesa no longer ships.
constexpr int kFormat = 0x22;
constexpr int kProfile = 0x33;
constexpr int kCoreProfile = 0x34;
constexpr int kMajorVersion = 0x36;
constexpr int kMinorVersion = 0x37;
using OsmesaContext = struct OsmesaContextRecord*;

struct Osmesa {
    Library library{"libOSMesa.so.8", "libosmesa6"};
    OsmesaContext (*create)(const int* attributes, OsmesaContext shared) = nullptr;
    void (*destroy)(OsmesaContext context) = nullptr;
    GLboolean (*make_current)(OsmesaContext context, void* pixels, GLenum type, GLsizei width,
                              GLsizei height) = nullptr;
    void* (*get_proc_address)(const char* function) = nullptr;

    Osmesa()
    {
        library.get(create, "OSMesaCreateContextAttribs");
        library.get(destroy, "OSMesaDestroyContext");
        library.get(make_current, "OSMesaMakeCurrent");
        library.get(get_proc_address, "OSMesaGetProcAddress");
    }
};

class OsmesaState : public ContextState {
 public:
    OsmesaState()
    {
        const int attributes[] = {kFormat, GL_RGBA, kProfile, kCoreProfile, kMajorVersion, 4, kMinorVersion, 5, 0};
        context_ = osmesa_.create(attributes, nullptr);
        if (context_ == nullptr) throw Error(Blame::machine, "OSMesa has no OpenGL 4.5 core context");
        // It wants a window of its own, which is never drawn to.
        if (osmesa_.make_current(context_, window_.data(), GL_UNSIGNED_BYTE, 1, 1) == GL_TRUE) return;
        osmesa_.destroy(context_);
        throw Error(Blame::machine, "OSMesaMakeCurrent failed");
    }
    ~OsmesaState() override
    {
        osmesa_.make_current(nullptr, nullptr, 0, 0, 0);
        osmesa_.destroy(context_);
    }

    void* find(const char* function) const override { return osmesa_.get_proc_address(function); }

 private:
    Osmesa osmesa_;
    OsmesaContext context_ = nullptr;
    std::array<GLubyte, 4> window_{};
};

}  // namespace

std::unique_ptr<ContextState> make_osmesa(bool)
{
    return std::make_unique<OsmesaState>();  // every context of OSMesa can be listened to
}

}  // namespace etalon::gl
