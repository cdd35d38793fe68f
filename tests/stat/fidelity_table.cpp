// fidelity_table RENDERER SPP FOLDER [NAME…]: draws the scenarios of the shared fidelity pictures (all, or those
// named), writes NAME.png into FOLDER, and prints one Markdown row a scene: silhouette overlap and RMS in dB, ours to
// each engine, and the median among the path tracers themselves.
#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <map>

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
    return values[values.size() / 2];
}

bool is_path_tracer(const std::string& engine)
{
    return std::find(kPathTracers.begin(), kPathTracers.end(), engine) != kPathTracers.end();
}

void print_row(gpu::Device& device, const fidelity::Scenario& scenario, const RenderSettings& settings,
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
    for (const auto& [engine, picture] : pictures) {
        const double here = fidelity::silhouette_overlap(ours, picture);
        best = std::max(best, here);
        char cell[80];
        std::snprintf(cell, sizeof cell, "%s %.4f %.1f; ", engine.c_str(), here, fidelity::rms_db(ours, picture));
        overlap += cell;
        (is_path_tracer(engine) ? to_path : to_raster).push_back(fidelity::rms_db(ours, picture));
        for (const auto& [other, other_picture] : pictures) {
            if (is_path_tracer(engine) && is_path_tracer(other) && engine < other)
                among_path.push_back(fidelity::rms_db(picture, other_picture));
            if (!is_path_tracer(engine) && is_path_tracer(other))
                raster_to_path.push_back(fidelity::rms_db(picture, other_picture));
        }
    }
    std::printf("| %s | %s | %.1f | %.1f | %.1f | %.1f | %.1f s | %s |\n", scenario.name.c_str(),
                scenario.show_environment ? "–" : std::to_string(best).substr(0, 6).c_str(), median(to_path),
                median(among_path), median(to_raster), median(raster_to_path), seconds, overlap.c_str());
    std::fflush(stdout);
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
    RenderSettings settings{.renderer = chosen->second, .spp = std::strtoull(arguments[2], nullptr, 10), .seed = 1};
    gpu::Device device;
    std::printf(
        "| scene | best silhouette overlap | ours to path tracers, dB | among path tracers | ours to rasterizers | "
        "rasterizers to path tracers | "
        "time | each: overlap, dB |\n|---|--:|--:|--:|--:|--:|--:|---|\n");
    for (const fidelity::Scenario& scenario : fidelity::scenarios()) {
        if (!names.empty() && std::find(names.begin(), names.end(), scenario.name) == names.end()) continue;
        try {
            print_row(device, scenario, settings, folder);
        } catch (const Error& error) {
            std::printf("| %s | %s |\n", scenario.name.c_str(), error.what());
        }
    }
    return 0;
}
