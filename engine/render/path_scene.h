#pragma once
#include "engine/base/progress.h"
#include "engine/gpu/buffer.h"
#include "engine/render/path_features.h"
#include "engine/render/path_geometry.h"
#include "shaders/shared/path.h"

namespace etalon {

/// Bytes on the device and the texels by which kernels read them.
struct PathBuffer {
    gpu::Buffer buffer;
    gpu::TexelView view;
};

/// A posed scene on the device, for the kernels of shaders/path. Layouts: shaders/shared/path.h.
struct PathScene {
    PathFeatures features;
    bool light_tree = false;    ///< emitters are chosen by a tree
    dvec3 origin{0};            ///< world: what positions on the device are relative to
    shared::PathFrame frame{};  ///< the scene's part of it; the view's is filled by set_view
    int stack_need = 0;         ///< of the BVH
    std::size_t primitives = 0;
    std::size_t nodes = 0;

    PathBuffer node_list, primitive_list, attributes, materials;
    PathBuffer textures, texels_8, texels_wide;
    PathBuffer lights, emitters, sky_cells, sky_map, albedo;
};

PathScene make_path_scene(gpu::Device& device, const PosedScene& posed, const Requirements& required,
                          const RenderSettings& settings, const Progress& progress);

/// The 32 bits that the kernels' random numbers know of a seed.
inline shared::uint path_seed(std::uint64_t seed)
{
    return static_cast<shared::uint>(seed ^ seed >> 32);
}

/// The camera's part of the frame (engine/scene/pose.h).
void set_view(shared::PathFrame& frame, const View& view, const dvec3& origin);

}  // namespace etalon
