#pragma once
#include <utility>

#include "engine/gl/functions.h"

namespace etalon::gl {

/// An object of OpenGL that is deleted with its owner. Movable, not copyable; its context must outlive it and be
/// current when it goes.
template <void (*Delete)(const Functions&, GLuint)>
class Handle {
 public:
    Handle() = default;
    Handle(const Functions& functions, GLuint name) : name_(name), functions_(&functions) {}
    Handle(Handle&& other) noexcept
        : name_(std::exchange(other.name_, 0)), functions_(std::exchange(other.functions_, nullptr))
    {}
    Handle& operator=(Handle&& other) noexcept
    {
        std::swap(name_, other.name_);
        std::swap(functions_, other.functions_);
        return *this;
    }
    Handle(const Handle&) = delete;
    Handle& operator=(const Handle&) = delete;
    ~Handle()
    {
        if (name_ != 0) Delete(*functions_, name_);
    }

    GLuint get() const { return name_; }
    explicit operator bool() const { return name_ != 0; }

 private:
    GLuint name_ = 0;
    const Functions* functions_ = nullptr;
};

inline void delete_buffer(const Functions& gl, GLuint name)
{
    gl.DeleteBuffers(1, &name);
}
inline void delete_framebuffer(const Functions& gl, GLuint name)
{
    gl.DeleteFramebuffers(1, &name);
}
inline void delete_program(const Functions& gl, GLuint name)
{
    gl.DeleteProgram(name);
}
inline void delete_query(const Functions& gl, GLuint name)
{
    gl.DeleteQueries(1, &name);
}
inline void delete_sampler(const Functions& gl, GLuint name)
{
    gl.DeleteSamplers(1, &name);
}
inline void delete_shader(const Functions& gl, GLuint name)
{
    gl.DeleteShader(name);
}
inline void delete_texture(const Functions& gl, GLuint name)
{
    gl.DeleteTextures(1, &name);
}
inline void delete_vertex_array(const Functions& gl, GLuint name)
{
    gl.DeleteVertexArrays(1, &name);
}

using Buffer = Handle<delete_buffer>;
using Framebuffer = Handle<delete_framebuffer>;
using Program = Handle<delete_program>;
using Query = Handle<delete_query>;
using Sampler = Handle<delete_sampler>;
using Shader = Handle<delete_shader>;
using Texture = Handle<delete_texture>;
using VertexArray = Handle<delete_vertex_array>;

}  // namespace etalon::gl
