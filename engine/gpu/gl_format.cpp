#include "engine/gpu/gl_format.h"

#include <fmt/format.h>

#include "engine/base/error.h"

namespace etalon::gpu {

std::optional<GlFormat> find_gl_format(VkFormat format)
{
    switch (format) {
        case VK_FORMAT_R8_UNORM:
            return GlFormat{GL_R8, GL_RED, GL_UNSIGNED_BYTE, 1};
        case VK_FORMAT_R8_UINT:
            return GlFormat{GL_R8UI, GL_RED_INTEGER, GL_UNSIGNED_BYTE, 1};
        case VK_FORMAT_R8G8_UNORM:
            return GlFormat{GL_RG8, GL_RG, GL_UNSIGNED_BYTE, 2};
        case VK_FORMAT_R8G8B8A8_UNORM:
            return GlFormat{GL_RGBA8, GL_RGBA, GL_UNSIGNED_BYTE, 4};
        case VK_FORMAT_R8G8B8A8_SRGB:
            return GlFormat{GL_SRGB8_ALPHA8, GL_RGBA, GL_UNSIGNED_BYTE, 4};
        case VK_FORMAT_R16_UINT:
            return GlFormat{GL_R16UI, GL_RED_INTEGER, GL_UNSIGNED_SHORT, 1};
        case VK_FORMAT_R16_SFLOAT:
            return GlFormat{GL_R16F, GL_RED, GL_HALF_FLOAT, 1};
        case VK_FORMAT_R16G16_SFLOAT:
            return GlFormat{GL_RG16F, GL_RG, GL_HALF_FLOAT, 2};
        case VK_FORMAT_R16G16B16A16_UNORM:
            return GlFormat{GL_RGBA16, GL_RGBA, GL_UNSIGNED_SHORT, 4};
        case VK_FORMAT_R16G16B16A16_SFLOAT:
            return GlFormat{GL_RGBA16F, GL_RGBA, GL_HALF_FLOAT, 4};
        case VK_FORMAT_R32_UINT:
            return GlFormat{GL_R32UI, GL_RED_INTEGER, GL_UNSIGNED_INT, 1};
        case VK_FORMAT_R32_SFLOAT:
            return GlFormat{GL_R32F, GL_RED, GL_FLOAT, 1};
        case VK_FORMAT_R32G32_UINT:
            return GlFormat{GL_RG32UI, GL_RG_INTEGER, GL_UNSIGNED_INT, 2};
        case VK_FORMAT_R32G32_SFLOAT:
            return GlFormat{GL_RG32F, GL_RG, GL_FLOAT, 2};
        case VK_FORMAT_R32G32B32_SFLOAT:
            return GlFormat{GL_RGB32F, GL_RGB, GL_FLOAT, 3};
        case VK_FORMAT_R32G32B32A32_UINT:
            return GlFormat{GL_RGBA32UI, GL_RGBA_INTEGER, GL_UNSIGNED_INT, 4};
        case VK_FORMAT_R32G32B32A32_SFLOAT:
            return GlFormat{GL_RGBA32F, GL_RGBA, GL_FLOAT, 4};
        case VK_FORMAT_D16_UNORM:
            return GlFormat{GL_DEPTH_COMPONENT16, GL_DEPTH_COMPONENT, GL_UNSIGNED_SHORT, 1};
        case VK_FORMAT_X8_D24_UNORM_PACK32:
            return GlFormat{GL_DEPTH_COMPONENT24, GL_DEPTH_COMPONENT, GL_UNSIGNED_INT, 1};
        case VK_FORMAT_D32_SFLOAT:
            return GlFormat{GL_DEPTH_COMPONENT32F, GL_DEPTH_COMPONENT, GL_FLOAT, 1};
        default:
            return std::nullopt;
    }
}

GlFormat gl_format(VkFormat format)
{
    if (const auto found = find_gl_format(format)) return *found;
    throw Error(Blame::machine, fmt::format("the OpenGL backend does not know format {}", static_cast<int>(format)),
                "render with --backend vulkan");
}

}  // namespace etalon::gpu
