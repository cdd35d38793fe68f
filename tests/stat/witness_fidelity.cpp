#include "witness_fidelity.h"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "engine/base/files.h"
#include "engine/image/develop.h"
#include "engine/image/io.h"
#include "engine/image/mips.h"
#include "engine/reference/reference.h"
#include "engine/render/render.h"
#include "engine/scene/load.h"
#include "tests/support/files.h"

namespace etalon::fidelity {
namespace {

std::optional<std::filesystem::path> model_of(const std::string& asset)
{
    const auto folder = test::find_shared("assets/khronos/" + asset);
    if (!folder) return std::nullopt;
    for (const auto& entry : std::filesystem::directory_iterator(*folder))
        if (entry.path().extension() == ".gltf" || entry.path().extension() == ".glb") return entry.path();
    return std::nullopt;
}

/// Area averages of premultiplied codes: what scaling a picture with transparency means.
Image scaled(Image picture, ivec2 size)
{
    const auto scale_colour = [](Image& image, bool divide) {
        for (std::size_t i = 0; i < image.pixel_count(); ++i) {
            const float alpha = image.values[4 * i + 3];
            for (std::size_t c = 0; c < 3; ++c) image.values[4 * i + c] *= divide ? (alpha > 0 ? 1 / alpha : 0) : alpha;
        }
    };
    scale_colour(picture, false);
    Image small = shrink(picture, size.x, size.y);
    scale_colour(small, true);
    return small;
}

Orbit orbit_of(const nlohmann::json& row)
{
    const auto& target = row["target"];
    const auto& orbit = row["orbit"];
    // A radius of 0 stands in the target and looks along the orbit's direction: an orbit this small does the same.
    constexpr double kStanding = 1e-7;
    return {.azimuth = orbit["theta_deg"],
            .elevation = 90 - double(orbit["phi_deg"]),
            .distance = std::max(double(orbit["radius"]), kStanding),
            .target = dvec3(target[0], target[1], target[2]),
            .yfov = row["vertical_fov_deg"]};
}

}  // namespace

std::vector<Scenario> scenarios()
{
    std::vector<Scenario> all;
    const auto folder = test::find_shared("fidelity");
    if (!folder) return all;
    const std::vector<std::byte> text = read_file(*folder / "scenarios.json");
    for (const nlohmann::json& row : nlohmann::json::parse(text.begin(), text.end())) {
        const auto model = model_of(row["asset"]);
        if (!model) continue;
        all.push_back({.name = row["name"],
                       .model = *model,
                       .environment = *folder / "environments" / std::string(row["environment"]),
                       .size = ivec2(row["size"][0], row["size"][1]),
                       .orbit = orbit_of(row),
                       .show_environment = row["show_environment"],
                       .folder = *folder / std::string(row["name"]),
                       .engines = row["pictures"]});
    }
    return all;
}

Image engine_picture(const Scenario& scenario, const std::string& engine)
{
    const std::filesystem::path path = scenario.folder / (engine + ".webp");
    const Texels texels = decode_texels(read_file(path), path.string());
    Image image(texels.width, texels.height, 4);
    for (std::size_t i = 0; i < image.values.size(); ++i)
        image.values[i] = texels.is_8_bit ? float(texels.bytes[i]) / 255.0f : texels.wide[i];
    return image;
}

Image our_picture(gpu::Device& device, const Scenario& scenario, ivec2 size, RenderSettings settings)
{
    const bool rasterizes = settings.renderer == Renderer::raster || settings.renderer == Renderer::reference_raster;
    const Scene scene = load_scene(scenario.model.string());
    Environment environment;
    environment.map = std::make_shared<Image>(read_image(scenario.environment));
    // Their u is atan2(z, x)/2π + ½, a quarter turn on from ours.
    const PosedScene posed = pose(scene, {.orbit = scenario.orbit,
                                          .size = rasterizes ? scenario.size : size,
                                          .environment = environment,
                                          .environment_rotation = 90});
    settings.background = scenario.show_environment ? Background::environment : Background::transparent;
    const Requirements required = require(posed, settings);
    const Film film = settings.renderer == Renderer::raster      ? render_raster(device, posed, required, settings, {})
                      : settings.renderer == Renderer::reference ? reference::render_path(posed, required, settings, {})
                      : settings.renderer == Renderer::path      ? render_path(device, posed, required, settings, {})
                                                            : reference::render_raster(posed, required, settings, {});
    return scaled(develop(film, {.tone = Tone::aces}), size);
}

double silhouette_overlap(const Image& a, const Image& b)
{
    std::size_t both = 0;
    std::size_t either = 0;
    for (std::size_t i = 0; i < a.pixel_count(); ++i) {
        const bool in_a = a.values[4 * i + 3] > 0.5f;
        const bool in_b = b.values[4 * i + 3] > 0.5f;
        both += in_a && in_b;
        either += in_a || in_b;
    }
    return either == 0 ? 1 : double(both) / double(either);
}

double rms_db(const Image& a, const Image& b)
{
    double sum = 0;
    std::size_t count = 0;
    for (std::size_t i = 0; i < a.pixel_count(); ++i) {
        const double alpha_a = a.values[4 * i + 3];
        const double alpha_b = b.values[4 * i + 3];
        if (alpha_a == 0 && alpha_b == 0) continue;
        ++count;
        for (std::size_t c = 0; c < 3; ++c) {
            const double difference = alpha_a * a.values[4 * i + c] - alpha_b * b.values[4 * i + c];
            sum += difference * difference;
        }
    }
    return count == 0 ? NAN : 10 * std::log10(sum / (3 * double(count)) + 1e-12);
}

}  // namespace etalon::fidelity
