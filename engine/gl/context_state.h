#pragma once
// Inside engine/gl only: what a platform does for a context.
#include <memory>
#include <thread>

namespace etalon::gl {

/// A platform's context, current on `thread`; its destructor ends both.
struct ContextState {
    ContextState() = default;
    ContextState(const ContextState&) = delete;
    ContextState& operator=(const ContextState&) = delete;
    virtual ~ContextState() = default;

    /// The address of a function of OpenGL; null where there is none.
    virtual void* find(const char* function) const = 0;

    std::thread::id thread = std::this_thread::get_id();
};

/// Throw Error(machine) where there is no such platform.
std::unique_ptr<ContextState> make_egl(bool debug);
std::unique_ptr<ContextState> make_osmesa(bool debug);

/// A shared library; stays in memory once opened, because drivers leave threads and thread-local data behind.
class Library {
 public:
    /// Throws Error(machine) that names `package` when there is no such file.
    Library(const char* file, const char* package);

    /// A function of the library. Throws Error(machine) when it is missing.
    template <class F>
    void get(F& function, const char* name) const
    {
        function = reinterpret_cast<F>(address(name));
    }

 private:
    void* address(const char* name) const;

    const char* file_;
    void* handle_ = nullptr;
};

}  // namespace etalon::gl
