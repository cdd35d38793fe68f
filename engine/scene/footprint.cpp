#include "engine/scene/footprint.h"

#include <fmt/format.h>

#include <array>

#include "engine/base/error.h"

namespace etalon {
namespace {

/// What one renderer holds, measured on lavapipe 22.3.6 by peak resident size: pictures of 512^2 against 1536^2, grids
/// of 245,000 against 980,000 triangles, one against four textures of 2048^2.
struct Costs {
    double program;         ///< bytes
    double pixel;           ///< bytes
    double sample;          ///< bytes for each of a pixel's samples of the rasterizer
    double geometry;        ///< bytes for a byte of the scene's attributes and indices
    double drawn_triangle;  ///< bytes for each time a triangle is shown
    double texel;           ///< bytes for a texel of 8 bits a channel
};
constexpr double kMiB = 1 << 20;
constexpr Costs kRaster{220 * kMiB, 20, 24, 3.6, 0, 20};
constexpr Costs kPath{210 * kMiB, 396, 0, 1, 136, 12};
constexpr Costs kRays{68 * kMiB, 180, 0, 1, 136, 12};  ///< what they add to the rasterizer's
constexpr Costs kReference{134 * kMiB, 304, 0, 1, 316, 8};
constexpr Costs kReferenceRaster{134 * kMiB, 39, 0, 1, 468, 16};
constexpr double kAovs = 200;  ///< bytes a pixel, with the EXR that is made of them

const Costs& costs_without_rays(Renderer renderer)
{
    switch (renderer) {
        case Renderer::raster:
            return kRaster;
        case Renderer::path:
            return kPath;
        case Renderer::reference:
            return kReference;
        case Renderer::reference_raster:
            break;
    }
    return kReferenceRaster;
}

Costs costs(const RenderSettings& settings)
{
    Costs sum = costs_without_rays(settings.renderer);
    const bool rays = settings.ambient_rays > 0 || settings.shadows == Shadows::ray;
    if (settings.renderer != Renderer::raster || !rays) return sum;
    sum.program += kRays.program;
    sum.pixel += kRays.pixel;
    sum.geometry += kRays.geometry;
    sum.drawn_triangle += kRays.drawn_triangle;
    sum.texel += kRays.texel;
    return sum;
}

/// No prediction is so large that it must not be compared.
std::uint64_t whole(double bytes)
{
    return bytes < 1e18 ? static_cast<std::uint64_t>(bytes) : std::uint64_t{1'000'000'000'000'000'000};
}

double bytes_of(const Primitive& p)
{
    const auto bytes = [](const auto& values) { return double(values.size() * sizeof(values[0])); };
    return bytes(p.positions) + bytes(p.normals) + bytes(p.tangents) + bytes(p.uv[0]) + bytes(p.uv[1]) +
           bytes(p.colors) + bytes(p.indices);
}

}  // namespace

std::uint64_t Footprint::total() const
{
    return program + geometry + textures + picture;
}

Footprint predict(ivec2 size, const RenderSettings& settings)
{
    const Costs cost = costs(settings);
    const double each = cost.pixel + cost.sample * settings.msaa + (settings.aovs ? kAovs : 0);
    const bool rasterizes = settings.renderer == Renderer::raster || settings.renderer == Renderer::reference_raster;
    const double drawn = rasterizes ? double(settings.ssaa) * settings.ssaa : 1;  // of a pixel
    return {.program = whole(cost.program), .picture = whole(each * drawn * double(size.x) * double(size.y))};
}

Footprint predict(const PosedScene& posed, const RenderSettings& settings)
{
    const Costs cost = costs(settings);
    double bytes = double(posed.draws.size()) * sizeof(Draw);
    for (const Mesh& mesh : posed.scene->meshes)
        for (const Primitive& primitive : mesh.primitives) bytes += cost.geometry * bytes_of(primitive);
    for (const Primitive& primitive : posed.deformed) bytes += cost.geometry * bytes_of(primitive);
    for (const Draw& draw : posed.draws)
        bytes += cost.drawn_triangle * double(posed.primitive(draw).indices.size()) / 3;
    double texels = 0;
    for (const Texels& image : posed.scene->images)
        texels += cost.texel * (image.is_8_bit ? 1 : 4) * double(image.width) * double(image.height);
    Footprint footprint = predict(ivec2(posed.view.width, posed.view.height), settings);
    footprint.geometry = whole(bytes);
    footprint.textures = whole(texels);
    return footprint;
}

std::string describe(const Footprint& footprint)
{
    return fmt::format("program {}, geometry {}, textures {}, picture {}", describe_bytes(footprint.program),
                       describe_bytes(footprint.geometry), describe_bytes(footprint.textures),
                       describe_bytes(footprint.picture));
}

void check_memory(const Footprint& footprint, std::uint64_t memory)
{
    if (footprint.total() <= memory) return;
    throw Error(Blame::machine,
                fmt::format("this needs about {} of memory ({}); it may have {}", describe_bytes(footprint.total()),
                            describe(footprint), describe_bytes(memory)),
                "a smaller --size or scene needs less (`render --degrade` makes both smaller); --memory N allows more "
                "where there "
                "is more");
}

std::string describe_bytes(std::uint64_t bytes)
{
    constexpr std::array kUnits = {"bytes", "KiB", "MiB", "GiB", "TiB", "PiB", "EiB"};
    double value = static_cast<double>(bytes);
    std::size_t unit = 0;
    for (; value >= 1024 && unit + 1 < kUnits.size(); ++unit) value /= 1024;
    return unit == 0 ? fmt::format("{} bytes", bytes) : fmt::format("{:.1f} {}", value, kUnits[unit]);
}

}  // namespace etalon
