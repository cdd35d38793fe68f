#pragma once
#include <cstdint>
#include <optional>
#include <vector>

#include "engine/reference/camera.h"
#include "engine/reference/environment.h"
#include "engine/reference/light.h"
#include "engine/reference/raster_layers.h"
#include "engine/reference/surface.h"
#include "engine/scene/settings.h"

namespace etalon::reference {

/// What is shaded: one surface at one pixel's centre. (SH-30)
struct Fragment {
    const Material* material = nullptr;
    Attributes attributes;     ///< with the footprint of the pixel
    dvec3 position{0};         ///< world
    dvec3 ng{0};               ///< geometric normal as the file means it; 0 for points and lines
    std::uint32_t object = 0;  ///< draw, or draws.size() + sphere: it does not light itself (SH-39)
    dvec2 film{0};             ///< the pixel's centre
    double scale = 1;          ///< metres in the world per metre in the mesh (SH-65)
    bool front = true;
    bool is_lit = true;  ///< false: points and lines without normals show base colour and emission alone
};

struct Shaded {
    dvec3 radiance{0};
    double alpha = 1;  ///< 1 unless the material blends
};

/// A whole emissive object seen as one point. (SH-39)
struct RasterEmitter {
    dvec3 radiance{0};
    double area = 0;       ///< m²
    dvec3 area_normal{0};  ///< Σ area · normal; 0 for spheres
    dvec3 center{0};       ///< weighted by area
    std::uint32_t object = 0;
    bool two_sided = false;
};
/// The 16 of greatest power.
std::vector<RasterEmitter> raster_emitters(const World& world);
/// What it sends to `p`, before any cosine at p.
Incident incident(const RasterEmitter& emitter, const dvec3& p);

/// The rasterizer's light and materials: docs/shading.md §4.
class RasterShader {
 public:
    RasterShader(const World& world, const RenderSettings& settings);

    /// Nothing where MASK discards the fragment. `behind`: what transmitting surfaces show; null before it is known.
    std::optional<Shaded> shade(const Fragment& fragment, const PictureBehind* behind) const;
    /// Drawn after what it shows (SH-65).
    bool transmits(const Material& material) const;
    /// Behind everything: the environment, the colour, or nothing (alpha 0).
    Shaded background(const dvec2& film) const;
    const CameraRays& camera() const { return camera_; }

 private:
    dvec3 towards_viewer(const dvec3& position) const;
    bool has_layers(const Material& material) const;
    RasterSurroundings surroundings(const PictureBehind* behind) const;
    dvec3 shade_plain(const Fragment& fragment, const MaterialPoint& point, const RasterSurface::Place& place) const;
    /// Part of a punctual light that arrives, by a ray: what shadow maps approximate (SH-43).
    double lit_share(const Fragment& fragment, const PosedLight& light, const Incident& in) const;
    /// Σ lights f · irradiance, `scatter` being f n·wi.
    template <class Scatter>
    dvec3 lights(const Fragment& fragment, Scatter&& scatter) const;

    const World* world_;
    CameraRays camera_;
    EnvironmentTables environment_;
    RasterShares shares_;
    std::vector<RasterEmitter> emitters_;
    bool blinn_phong_;
    bool shadows_;
    Background background_;
    dvec3 background_color_;
};

/// How a material reflects in a rasterizer. (SH-31), (SH-37)
struct RasterMaterial {
    dvec3 diffuse{0};  ///< c_diff
    dvec3 f0{0};
    double roughness = 1;  ///< perceptual
    double alpha = 1;      ///< GGX
    bool has_specular = true;
    bool is_mirror = false;  ///< reflects the environment alone
};
RasterMaterial raster_material(const Material& material, const MaterialPoint& point);

/// (TX-7) Perceptual roughness with what the normals add that a texel of length `size` is the mean of; `minified`: the
/// level, at most 1.
double roughness_with_spread(double roughness, double size, double scale, double minified);

/// f(wo, wi) n·wi with n·wo clamped to `n_o`; 0 unless n·wi > 0. (SH-31), or (SH-38).
dvec3 reflect_pbr(const RasterMaterial& m, const dvec3& n, const dvec3& wo, const dvec3& wi, double n_o);
dvec3 reflect_blinn_phong(const RasterMaterial& m, const dvec3& n, const dvec3& wo, const dvec3& wi);

/// (SH-38) exponent of a GGX alpha, 0 … 10⁶.
double blinn_phong_exponent(double alpha);
/// (SH-38) normalized lobe (p + 2)(p + 4)/(8π(2^(−p/2) + p)) (n·h)^p from d = |n − h|.
double blinn_phong_lobe(double exponent, double distance);

}  // namespace etalon::reference
