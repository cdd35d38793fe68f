#include "engine/scene/settings.h"

namespace etalon {

std::string_view name(Renderer renderer)
{
    switch (renderer) {
        case Renderer::raster:
            return "raster";
        case Renderer::path:
            return "path";
        case Renderer::reference:
            return "reference";
        case Renderer::reference_raster:
            return "reference-raster";
    }
    return {};
}

std::string_view label(Renderer renderer)
{
    switch (renderer) {
        case Renderer::raster:
            return "rasterizer";
        case Renderer::path:
            return "Vulkan path tracer";
        case Renderer::reference:
            return "reference path tracer";
        case Renderer::reference_raster:
            return "reference rasterizer";
    }
    return {};
}

std::string_view name(Sequence sequence)
{
    return sequence == Sequence::sobol ? "sobol" : "pcg";
}

}  // namespace etalon
