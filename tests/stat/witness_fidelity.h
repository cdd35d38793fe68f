#pragma once
#include <filesystem>
#include <string>
#include <vector>

#include "engine/gpu/device.h"
#include "engine/image/film.h"
#include "engine/image/image.h"
#include "engine/scene/pose.h"
#include "engine/scene/settings.h"

namespace etalon::fidelity {

/// A row of scenarios.json: a model, how it is seen, and which engines' pictures there are.
struct Scenario {
    std::string name;
    std::filesystem::path model;
    std::filesystem::path environment;
    ivec2 size{0};  ///< at which the engines drew; their pictures were scaled to 512 wide afterwards
    Orbit orbit;
    bool show_environment = false;  ///< then the pictures have no silhouette
    std::filesystem::path folder;
    std::vector<std::string> engines;
};

/// All scenarios; empty when the shared folder is not there. Models that the shared assets lack are left out.
std::vector<Scenario> scenarios();

/// Display-referred RGBA in [0, 1] of one engine (512 pixels wide).
Image engine_picture(const Scenario& scenario, const std::string& engine);

/// Ours by the renderer of `settings` at `size`, ACES at exposure 0. Rasterizers draw at the scenario's size first, as
/// the engines did: their few samples a pixel make a coarse edge; path tracers average over the pixel anyway.
Image our_picture(gpu::Device& device, const Scenario& scenario, ivec2 size, RenderSettings settings);

/// Pixels covered by both (alpha above ½) over pixels covered by either.
double silhouette_overlap(const Image& a, const Image& b);
/// RMS difference of premultiplied sRGB codes over pixels where either alpha is above 0, in dB: what the project that
/// made the pictures measures.
double rms_db(const Image& a, const Image& b);

}  // namespace etalon::fidelity
