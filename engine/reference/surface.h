#pragma once
#include <cstdint>
#include <vector>

#include "engine/reference/bsdf.h"
#include "engine/reference/layers.h"
#include "engine/reference/layers_lobes.h"
#include "engine/reference/scene_index.h"
#include "engine/reference/texture.h"
#include "engine/scene/pose.h"

namespace etalon::reference {

/// A posed scene made ready to be met by rays. `posed` and its scene must outlive it.
struct World {
    /// `textures_used` as Requirements has it; `mipmaps`: textures get their coarser levels.
    World(const PosedScene& posed, const std::vector<bool>& textures_used, bool mipmaps);

    const Material& material(const Shape& shape) const { return posed->materials()[shape.material]; }

    /// How a draw's attributes turn into world space.
    struct Frame {
        dmat3 world_from_object{1};
        dmat3 normal_from_object{1};  ///< cofactor matrix of the above, turned where it mirrors (TF-1, promise G28)
        double handedness = 1;        ///< -1 where it mirrors: turns the bitangent (promise G27)
    };

    const PosedScene* posed;
    SceneIndex index;
    TextureSet textures;
    ShareTable ggx_share;             ///< for the roughnesses that occur; empty where nothing asks, and for rasterizers
    ShareTable sheen_share;           ///< likewise
    std::vector<Frame> frames;        ///< of each draw
    std::vector<bool> always_opaque;  ///< per material: stops every ray, whatever its side
};

/// Vertex attributes at a point of a triangle, line or point: a0 + b1 (a1 - a0) + b2 (a2 - a0) each (TR-4).
struct Attributes {
    dvec3 normal{0};   ///< world; 0: the file gives none, the geometric one holds
    dvec4 tangent{0};  ///< world, w = the bitangent's sign; 0: none
    dvec4 color{1};
    TexturePoint at;
};

/// `vertices`: the element's three entries of `indices` (repeat the last for lines and points).
Attributes interpolate(const Primitive& primitive, const World::Frame& frame,
                       const std::array<std::uint32_t, 3>& vertices, double b1, double b2);

/// A material's numbers at one point: factors times textures times vertex colour. (SH-5)
struct MaterialPoint {
    dvec3 color{1};
    double alpha = 1;  ///< 1 for opaque materials
    double metallic = 0;
    double roughness = 1;
    double occlusion = 1;  ///< (SH-36)
    dvec3 specular{0};     ///< specular_glossiness: F0
    dvec3 emission{0};     ///< (SH-21), before the side is known; base colour of unlit (SH-15)
};
MaterialPoint evaluate(const Material& material, const TextureSet& textures, const Attributes& attributes);

/// (SH-2) The interpolated normal under the normal map `map`; `ng` where there is nothing better.
dvec3 mapped_normal(const TextureUse& map, double scale, const TextureSet& textures, const Attributes& attributes,
                    const dvec3& ng);
/// (SH-2) The shading normal, unit, on the geometric one's side as the file means it. `ng` where there is nothing
/// better.
dvec3 shading_normal(const Material& material, const TextureSet& textures, const Attributes& attributes,
                     const dvec3& ng);

/// Everything known where a ray meets a surface.
struct Surface {
    dvec3 position{0};
    dvec3 error{0};     ///< the true position lies within ± this (RT-6)
    dvec3 ng{0};        ///< geometric normal, unit, on the viewer's side
    dvec3 n{0};         ///< shading normal, unit, turned with ng (SH-3)
    bool front = true;  ///< the viewer is on the side that ng of the file points to
    dvec3 emission{0};  ///< towards the viewer
    MaterialPoint point;
    Attributes attributes;
    ShadingFrame frame{dvec3(0, 0, 1)};  ///< that of the BSDF, about n
    Bsdf bsdf;
    std::optional<LayeredBsdf> layered;  ///< where there is one, it holds in place of bsdf
    bool is_black = false;               ///< scatters nothing
    std::uint32_t object = 0;
    Index material = 0;
};

/// A material that LayeredBsdf describes.
bool is_layered(const Material& material);
/// (SH-58), (SH-63) A material that encloses a medium: both its sides are met.
bool is_body(const Material& material);

/// The surface at `hit`, seen against `direction` (unit).
Surface surface_at(const World& world, const Ray& ray, const Hit& hit);

/// (SH-21) What the surface at `hit` emits against the ray; as Surface::emission, for less work.
dvec3 emission_at(const World& world, const Ray& ray, const Hit& hit);

/// What of a ray stops at `hit`: 1 opaque, 0 passes, between for BLEND. (SH-6)
/// `cull_all`: also single-sided exact models let their back through, as rasterizers do (SH-32).
double opacity(const World& world, const Ray& ray, const Hit& hit, bool cull_all = false);

/// Models that extras.etalon.bsdf names; glTF's own are metallic_roughness, specular_glossiness and unlit.
bool is_exact_model(BsdfModel model);
bool is_dielectric(BsdfModel model);

/// (SH-14) … (SH-19) of a material at a point; `front` tells a dielectric's sides apart.
Bsdf bsdf_of(const Material& material, const MaterialPoint& point, bool front);

}  // namespace etalon::reference
