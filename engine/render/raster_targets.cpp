#include "engine/render/raster_targets.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <span>
#include <vector>

#include "engine/base/error.h"

namespace etalon {
namespace {

gpu::Image make_target(gpu::Device& device, ivec2 size, VkFormat format, std::uint32_t samples, const char* name)
{
    const bool depth = format != kRasterColor && format != kRasterIds;
    VkImageUsageFlags usage = depth ? VK_IMAGE_USAGE_DEPTH_STENCIL_ATTACHMENT_BIT : VK_IMAGE_USAGE_COLOR_ATTACHMENT_BIT;
    if (samples == 1 && !depth) usage |= VK_IMAGE_USAGE_SAMPLED_BIT;
    return {device,
            {.format = format,
             .width = static_cast<std::uint32_t>(size.x),
             .height = static_cast<std::uint32_t>(size.y),
             .samples = samples,
             .usage = usage,
             .name = name}};
}

gpu::Image make_storage(gpu::Device& device, uvec2 size, const char* name)
{
    return {device,
            {.format = kRasterColor,
             .width = size.x,
             .height = size.y,
             .usage = VK_IMAGE_USAGE_SAMPLED_BIT | VK_IMAGE_USAGE_STORAGE_BIT,
             .name = name}};
}

void read_aovs(gpu::Device& device, RasterTargets& targets, Aovs& aovs)
{
    const auto normal_depth = gpu::download_as<vec4>(device, targets.aovs[0]);
    const auto albedo_u = gpu::download_as<vec4>(device, targets.aovs[1]);
    const auto emission_v = gpu::download_as<vec4>(device, targets.aovs[2]);
    const auto ids = gpu::download_as<std::array<std::uint32_t, 2>>(device, targets.aovs[3]);
    for (std::size_t i = 0; i < ids.size(); ++i) {
        aovs.normal.emplace_back(normal_depth[i]);
        aovs.depth.push_back(normal_depth[i].w);
        aovs.albedo.emplace_back(albedo_u[i]);
        aovs.emission.emplace_back(emission_v[i]);
        aovs.uv.emplace_back(albedo_u[i].w, emission_v[i].w);
        aovs.object_id.push_back(ids[i][0]);
        aovs.material_id.push_back(ids[i][1]);
    }
}

}  // namespace

uvec2 size_of_levels(ivec2 picture)
{
    const auto width = static_cast<std::uint32_t>(picture.x), height = static_cast<std::uint32_t>(picture.y);
    const std::uint32_t levels = gpu::mip_count(width, height);
    std::uint32_t below = 0;  // the levels under the picture, side by side
    for (std::uint32_t level = 1; level < levels; ++level) below += std::max(1u, width >> level);
    return {std::max(width, below), height + (levels > 1 ? std::max(1u, height >> 1) : 0)};
}

RasterTargets make_targets(gpu::Device& device, const RasterTargetSpec& spec)
{
    const ivec2 drawn = spec.size * spec.per_side;
    const auto most = static_cast<int>(std::min(device.limits().image_side, 1u << 30));
    if (std::max(spec.size.x, spec.size.y) > most / spec.per_side)
        throw Error(Blame::machine,
                    fmt::format("{}x{} pixels, each drawn as {}x{}, are more than the {} a side of {}", spec.size.x,
                                spec.size.y, spec.per_side, spec.per_side, most, device.name()),
                    "render with a smaller --size or --ssaa");
    RasterTargets targets;
    if (spec.samples > 1) targets.color = make_target(device, drawn, kRasterColor, spec.samples, "colour samples");
    targets.depth = make_target(device, drawn, spec.depth, spec.samples, "depth samples");
    targets.resolved = make_target(device, drawn, kRasterColor, 1, "picture");
    if (spec.levels) targets.levels = make_storage(device, size_of_levels(drawn), "picture behind");
    if (spec.filtered) {
        targets.filtered_rows = make_storage(device, uvec2(spec.size.x, drawn.y), "filtered rows");
        targets.filtered = make_storage(device, uvec2(spec.size), "filtered picture");
    }
    if (!spec.aovs) return targets;
    for (std::size_t i = 0; i < kRasterAovTargets; ++i)
        targets.aovs[i] =
            make_target(device, spec.size, i + 1 == kRasterAovTargets ? kRasterIds : kRasterColor, 1, "AOVs");
    targets.aov_depth = make_target(device, spec.size, kRasterDepth, 1, "AOV depth");
    return targets;
}

Film read_targets(gpu::Device& device, RasterTargets& targets)
{
    gpu::Image& picture = targets.picture();
    const std::vector<vec4> pixels = gpu::download_as<vec4>(device, picture);
    Film film;
    film.width = static_cast<int>(picture.width());
    film.height = static_cast<int>(picture.height());
    film.mean.reserve(pixels.size());
    film.alpha.reserve(pixels.size());
    for (const vec4& pixel : pixels) {
        film.mean.emplace_back(pixel.x, pixel.y, pixel.z);
        film.alpha.push_back(pixel.w);
        if (!is_finite(dvec3(film.mean.back()))) ++film.nonfinite;
    }
    if (targets.has_aovs()) read_aovs(device, targets, film.aovs);
    return film;
}

gpu::Image upload_picture(gpu::Device& device, const Image& picture, const char* name)
{
    const Image& source = picture.values.empty() ? Image(1, 1, 4) : picture;
    std::vector<float> texels;
    if (source.channels != 4) {
        texels.reserve(source.pixel_count() * 4);
        for (int y = 0; y < source.height; ++y)
            for (int x = 0; x < source.width; ++x) {
                for (int c = 0; c < 3; ++c) texels.push_back(source.at(x, y, c));
                texels.push_back(1);
            }
    }
    gpu::Image image(device, {.format = kRasterColor,
                              .width = static_cast<std::uint32_t>(source.width),
                              .height = static_cast<std::uint32_t>(source.height),
                              .usage = VK_IMAGE_USAGE_SAMPLED_BIT,
                              .name = name});
    const std::array<gpu::ImagePart, 1> part{
        {{.texels = std::as_bytes(std::span<const float>(texels.empty() ? source.values : texels))}}};
    gpu::upload(device, image, part);
    return image;
}

}  // namespace etalon
