#pragma once
#include <optional>

#include "engine/render/environment.h"
#include "engine/scene/pose.h"
#include "engine/scene/settings.h"
#include "shaders/shared/raster.h"

namespace etalon {

/// Projection: reversed, infinite (TF-4); orthographic with far behind the bounds, relative to the camera (TF-5); or
/// forward (TF-7).
struct RasterProjection {
    dmat4 clip_from_camera{1};
    double near = 0;  ///< metres
    double far = 0;   ///< metres; unless infinite
    dvec2 film_half{1};
};
RasterProjection project(const View& view, const dvec3& bounds_min, const dvec3& bounds_max,
                         DepthKind depth = DepthKind::reversed_32);

/// What a frame of `posed` seen by `view` tells its shaders; `tables` null where there is no environment map;
/// `background`: the colour behind everything where that is not the environment;
/// `point_and_line`: their widths in pixels of `view`.
shared::RasterFrame make_frame(const PosedScene& posed, const View& view, const EnvironmentTables* tables,
                               std::uint32_t light_count, std::uint32_t emitter_count, const dvec3& background,
                               vec2 point_and_line, DepthKind depth);

/// world_from_object relative to the eye (TF-2), and the normal matrix scaled so that nothing under- or overflows.
void place(const dmat4& world_from_object, const dvec3& eye, shared::RasterDraw& draw);
/// True where world_from_object mirrors: the winding on the screen is turned (SH-1).
bool is_mirrored(const dmat4& world_from_object);

/// Pixels [x, x + width) × [y, y + height) that hold the whole of a sphere; nothing where it is out of view.
struct PixelBox {
    int x = 0, y = 0;
    std::uint32_t width = 0, height = 0;
};
std::optional<PixelBox> pixels_of(const PosedSphere& sphere, const View& view, double near);

}  // namespace etalon
