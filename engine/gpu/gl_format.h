#pragma once
// Inside engine/gpu only: formats by OpenGL's names.
#include <vulkan/vulkan_core.h>

#include <optional>

#include "engine/gl/functions.h"

namespace etalon::gpu {

struct GlFormat {
    GLenum internal = 0;
    GLenum format = 0;  ///< of transfers
    GLenum type = 0;
    int components = 0;

    bool is_unsigned() const
    {
        return format == GL_RED_INTEGER || format == GL_RG_INTEGER || format == GL_RGBA_INTEGER;
    }
    bool is_depth() const { return format == GL_DEPTH_COMPONENT; }
};

/// Nothing for a format that this backend does not know.
std::optional<GlFormat> find_gl_format(VkFormat format);
/// Throws Error(machine) for those.
GlFormat gl_format(VkFormat format);

}  // namespace etalon::gpu
