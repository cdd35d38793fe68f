#include "engine/scene/glass.h"

namespace etalon {

bool is_smooth_thin_glass(const Material& m)
{
    if (m.model != BsdfModel::metallic_roughness || !m.layers || m.alpha_mode != AlphaMode::opaque) return false;
    const MaterialLayers& l = *m.layers;
    const bool textured =
        l.transmission_texture.present() || l.specular_texture.present() || l.specular_color_texture.present();
    const bool bare =
        l.clearcoat == 0 && l.iridescence == 0 && l.diffuse_transmission == 0 && l.sheen_color == dvec3(0);
    // At this roughness GGX's alpha is at its least (SH-14).
    const bool smooth = m.roughness * m.roughness <= 1e-3;
    return bare && smooth && !textured && l.transmission == 1 && l.thickness == 0 && m.metallic == 0 &&
           m.emission == dvec3(0);
}

}  // namespace etalon
