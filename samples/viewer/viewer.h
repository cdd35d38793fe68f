#pragma once
#include <atomic>
#include <filesystem>
#include <optional>

#include "engine/gpu/device.h"
#include "engine/image/develop.h"
#include "engine/scene/pose.h"
#include "engine/scene/settings.h"

namespace etalon {

/// What a window opens with.
struct ViewOptions {
    PoseSettings pose;      ///< first view; its size is the window's (1280x720 when absent)
    RenderSettings render;  ///< `renderer` raster or path is what is shown first
    DevelopSettings develop;
    gpu::DeviceOptions device;
    std::optional<std::uint64_t> frames;      ///< close after so many pictures
    std::filesystem::path screenshot;         ///< where the last picture goes when the window closes; empty: nowhere
    const std::atomic<bool>* stop = nullptr;  ///< closes the window when set
};

/// The keys and mouse moves of the window, one a line, as `?` prints them.
const char* view_help();

/// Shows the scene in a window until it is closed. Throws Error(machine) when there is no display or no device that can
/// present, Error(input) when the first renderer is neither raster nor path.
void view(const Scene& scene, const ViewOptions& options);

}  // namespace etalon
