// fidelity_table RENDERER SPP FOLDER [NAME…]: draws the scenarios of the shared fidelity pictures (all, or those
// named), writes NAME.png into FOLDER, and prints one Markdown row a scene: silhouette overlap and RMS in dB, ours to
// each engine, the medians among the path tracers and of the rasterizers to them, and the rasterizer among the engines
// that is nearest to them. The last line counts the scenes where ours is nearer than that, of those where the path
// tracers agree to better than -20 dB. Of the rasterizer SPP are the paths of --ambient-rays,
// 0 for none; with them lights cast shadows by rays.
#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <map>
#include <optional>

#include "engine/base/error.h"
#include "engine/image/io.h"
#include "witness_fidelity.h"

namespace {

using namespace etalon;

const std::vector<std::string> kPathTracers{"blender-cycles", "vray", "stellar", "three-gpu-pathtracer", "dspbr-pt"};

double median(std::vector<double> values)
{
    if (values.empty()) return std::nan("");
    std::sort(values.begin(), values.end());
    return (values[(values.size() - 1) / 2] + values[values.size() / 2]) / 2;
}

bool is_path_tracer(const std::string& engine)
{
    return std::find(kPathTracers.begin(), kPathTracers.end(), engine) != kPathTracers.end();
}

/// Whether ours is nearer to the path tracers than any rasterizer among the engines; nothing where the path tracers do
/// not agree.
std::optional<bool> print_row(gpu::Device& device, const fidelity::Scenario& scenario, const RenderSettings& settings,
                              const std::filesystem::path& folder)
{
    std::map<std::string, Image> pictures;
    for (const std::string& engine : scenario.engines) pictures[engine] = fidelity::engine_picture(scenario, engine);
    const ivec2 size(pictures.begin()->second.width, pictures.begin()->second.height);
    std::erase_if(pictures, [&](const auto& item) { return ivec2(item.second.width, item.second.height) != size; });

    const auto start = std::chrono::steady_clock::now();
    const Image ours = fidelity::our_picture(device, scenario, size, settings);
    const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    write_png(ours, {}, folder / (scenario.name + ".png"));

    std::string overlap;
    std::vector<double> to_path, among_path, to_raster, raster_to_path;
    double best = 0;
    double nearest = 1e9;
    std::string nearest_engine = "-";
    for (const auto& [engine, picture] : pictures) {
        const double here = fidelity::silhouette_overlap(ours, picture);
        best = std::max(best, here);
        char cell[80];
        std::snprintf(cell, sizeof cell, "%s %.4f %.1f; ", engine.c_str(), here, fidelity::rms_db(ours, picture));
        overlap += cell;
        (is_path_tracer(engine) ? to_path : to_raster).push_back(fidelity::rms_db(ours, picture));
        std::vector<double> of_engine;
        for (const auto& [other, other_picture] : pictures) {
            if (is_path_tracer(engine) && is_path_tracer(other) && engine < other)
                among_path.push_back(fidelity::rms_db(picture, other_picture));
            if (!is_path_tracer(engine) && is_path_tracer(other))
                of_engine.push_back(fidelity::rms_db(picture, other_picture));
        }
        raster_to_path.insert(raster_to_path.end(), of_engine.begin(), of_engine.end());
        if (!of_engine.empty() && median(of_engine) < nearest) {
            nearest = median(of_engine);
            nearest_engine = engine;
        }
    }
    std::printf("| %s | %s | %.1f | %.1f | %.1f | %.1f | %.1f %s | %.1f s | %s |\n", scenario.name.c_str(),
                scenario.show_environment ? "–" : std::to_string(best).substr(0, 6).c_str(), median(to_path),
                median(among_path), median(to_raster), median(raster_to_path), nearest, nearest_engine.c_str(), seconds,
                overlap.c_str());
    std::fflush(stdout);
    if (!(median(among_path) < -20)) return std::nullopt;
    return median(to_path) < nearest;
}

}  // namespace

int main(int count, char** arguments)
{
    if (count < 4) {
        std::fprintf(stderr, "usage: fidelity_table raster|path|reference|reference-raster SPP FOLDER [NAME...]\n");
        return 2;
    }
    const std::map<std::string, Renderer> renderers{{"raster", Renderer::raster},
                                                    {"path", Renderer::path},
                                                    {"reference", Renderer::reference},
                                                    {"reference-raster", Renderer::reference_raster}};
    const auto chosen = renderers.find(arguments[1]);
    if (chosen == renderers.end()) return 2;
    const std::filesystem::path folder = arguments[3];
    std::filesystem::create_directories(folder);
    const std::vector<std::string> names(arguments + 4, arguments + count);
    const std::uint64_t samples = std::strtoull(arguments[2], nullptr, 10);
    RenderSettings settings{.renderer = chosen->second, .spp = std::max<std::uint64_t>(samples, 1), .seed = 1};
    if (chosen->second == Renderer::raster && samples > 0) {
        settings.ambient_rays = static_cast<int>(std::min<std::uint64_t>(samples, 4096));
        settings.shadows = Shadows::ray;
    }
    gpu::Device device;
    std::printf(
        "| scene | best silhouette overlap | ours to path tracers, dB | among path tracers | ours to rasterizers | "
        "rasterizers to path tracers | "
        "nearest of them | time | each: overlap, dB |\n|---|--:|--:|--:|--:|--:|---|--:|---|\n");
    int agreed = 0, won = 0;
    for (const fidelity::Scenario& scenario : fidelity::scenarios()) {
        if (!names.empty() && std::find(names.begin(), names.end(), scenario.name) == names.end()) continue;
        try {
            const std::optional<bool> nearer = print_row(device, scenario, settings, folder);
            agreed += nearer.has_value();
            won += nearer.value_or(false);
        } catch (const Error& error) {
            std::printf("| %s | %s |\n", scenario.name.c_str(), error.what());
        }
    }
    std::printf("nearer than every other rasterizer in %d of %d scenes\n", won, agreed);
    return 0;
}
