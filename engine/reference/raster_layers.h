#pragma once
#include <optional>

#include "engine/reference/camera.h"
#include "engine/reference/environment.h"
#include "engine/reference/layers_point.h"
#include "engine/reference/raster_behind.h"
#include "engine/reference/raster_share.h"

namespace etalon::reference {

/// What a rasterizer's layered surfaces read besides themselves.
struct RasterSurroundings {
    const EnvironmentTables* environment = nullptr;
    const RasterShares* shares = nullptr;
    const CameraRays* camera = nullptr;
    ivec2 size{0};                          ///< of the picture
    double film_height = 1;                 ///< half the view's height at unit distance; 1 for orthographic views
    const PictureBehind* behind = nullptr;  ///< null where nothing transmits
};

/// A point of a metallic_roughness or specular_glossiness surface as a rasterizer's viewer sees it (SH-65). World
/// space.
class RasterSurface {
 public:
    struct Place {
        dvec3 position{0};
        dvec3 n{0};        ///< shading normal on the drawn side
        dvec3 n_front{0};  ///< the same before (SH-3) turns it
        dvec3 ng{0};       ///< on the drawn side
        dvec3 ng_file{0};
        dvec3 wo{0};
        dvec2 film{0};     ///< the pixel's centre
        double scale = 1;  ///< metres in the world per metre in the mesh
        bool front = true;
    };
    RasterSurface(const Material& material, const MaterialPoint& point, const Attributes& attributes,
                  const TextureSet& textures, const Place& place, const RasterSurroundings& around);

    /// f |n·wi| of light from `wi`, unit, on whatever side.
    dvec3 scatter(const dvec3& wi) const;
    /// Of the environment, and of what is seen through the surface.
    dvec3 surroundings() const;
    /// What is left of the surface's own emission (SH-62).
    double emission_share() const { return 1 - coat_weight_; }

 private:
    void set_coat(const MaterialLayers& layers, const TextureSet& textures, const Attributes& attributes);
    dvec3 reflected(const dvec3& wi, double n_i) const;
    dvec3 transmitted(const dvec3& wi, double n_i) const;
    double microfacets(const dvec3& h, const dvec3& wi) const;
    double sheen_given(double n_i) const;
    double below_sheen(double given) const;
    dvec3 reflected_direction() const;
    dvec3 environment() const;
    dvec3 behind() const;
    dvec3 seen_through(double ior) const;

    const RasterSurroundings* around_;
    Place place_;
    BaseReflectance reflectance_;
    LayerPoint layers_;
    double roughness_ = 1;
    double occlusion_ = 1;
    double n_o_ = 1;     // n·wo, clamped (SH-32)
    dvec2 alpha_{1};     // α_t, α_b
    dvec3 t_{0}, b_{0};  // t', b'
    dvec3 compensation_{1};
    dvec3 head_on_{0};  // F(1)
    double sheen_seen_ = 0;
    double coat_weight_ = 0;
    double coat_roughness_ = 0;
    dvec3 coat_normal_{0};
    double coat_o_ = 1;
    std::optional<dvec3> body_ior_;  // none: thin-walled
    dvec3 absorbed_{1};
};

}  // namespace etalon::reference
