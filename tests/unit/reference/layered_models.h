#pragma once
#include <string>
#include <vector>

#include "engine/reference/layers.h"

namespace etalon::test {

/// The whole tables, made once.
struct LayerTables {
    reference::ShareTable ggx{reference::kGgxShare, {reference::kGgxShare.lowest_alpha, 1}};
    reference::ShareTable sheen{reference::kSheenShare, {reference::kSheenShare.lowest_alpha, 1}};
};
inline const LayerTables& tables()
{
    static const LayerTables made;
    return made;
}

/// metallic_roughness without layers.
inline reference::LayeredBsdf glossy(const dvec3& color, double metallic, double alpha)
{
    reference::LayeredBsdf out;
    out.reflectance.color = color;
    out.reflectance.metallic = metallic;
    out.alpha = dvec2(alpha);
    out.ggx_share = &tables().ggx;
    return out;
}

struct LayeredModel {
    std::string name;
    reference::LayeredBsdf bsdf;
    /// Most of the light that it may give back: glTF takes (1 − F) of the diffuse part at the half vector of each pair
    /// of directions, which is up to a tenth too much at grazing angles; E of (SH-53) is that of one alpha.
    double bound = 1;
};

/// One of each lobe, and of what changes it.
inline std::vector<LayeredModel> layered_models()
{
    std::vector<LayeredModel> all;
    const auto add = [&](std::string name, const reference::LayeredBsdf& bsdf, double bound) {
        all.push_back({std::move(name), bsdf, bound});
    };
    const dvec3 color(0.8, 0.5, 0.2);
    reference::LayeredBsdf bsdf = glossy(color, 0.3, 0.2);
    bsdf.reflectance.f0 = {0.5, 0.2, 0.3};
    bsdf.reflectance.f90 = 0.8;
    add("specular colour", bsdf, 1.12);
    bsdf = glossy(dvec3(1), 1, 0.4);
    bsdf.alpha = {0.6, 0.15};
    add("anisotropic metal", bsdf, 1.08);
    bsdf = glossy(color, 0, 0.3);
    bsdf.reflectance.film = {.strength = 0.8, .ior = 1.6, .thickness = 380};
    add("film", bsdf, 1.12);
    bsdf = glossy(color, 0, 0.5);
    bsdf.diffuse_transmission = 0.6;
    bsdf.diffuse_transmission_color = {0.9, 0.9, 0.3};
    add("diffuse transmission", bsdf, 1.12);
    bsdf = glossy(color, 0, 0.3);
    bsdf.transmission = 0.9;
    add("thin wall", bsdf, 1.02);
    bsdf.alpha = {0.8, 0.2};
    bsdf.diffuse_transmission = 0.5;
    add("anisotropic thin wall", bsdf, 1.02);
    for (const bool inside : {false, true}) {
        const std::string side = inside ? " from inside" : " from outside";
        bsdf = glossy(dvec3(1), 0, 0.2);
        bsdf.transmission = 1;
        bsdf.body = {.ior = dvec3(1.5), .inside = inside};
        add("body" + side, bsdf, 1.02);
        bsdf.transmission = 0.7;
        bsdf.diffuse_transmission = 0.4;
        bsdf.body->ior = {1.4, 1.5, 1.6};
        bsdf.alpha = {0.4, 0.2};
        add("dispersing, anisotropic body" + side, bsdf, 1.2);  // (SH-56) knows no (η_i/η_t)²
    }
    bsdf = glossy(dvec3(1), 0, 0.2);
    bsdf.transmission = 0.8;
    bsdf.reflectance.f0 = dvec3(0);
    bsdf.body = {.ior = dvec3(1), .inside = false};
    add("body of index 1", bsdf, 1.12);
    for (const double alpha : {0.07 * 0.07, 0.3, 1.0}) {
        bsdf = glossy(color, 0, 0.6);
        bsdf.sheen_color = {0.9, 0.6, 0.8};
        bsdf.sheen_alpha = alpha;
        bsdf.sheen_share = &tables().sheen;
        add("sheen " + std::to_string(alpha), bsdf, 1.06);
    }
    bsdf = glossy(color, 0.5, 0.5);
    bsdf.coat_weight = 0.3;
    bsdf.coat_alpha = 0.15;
    add("coat", bsdf, 1.12);
    bsdf.coat_normal = normalize(dvec3(0.2, -0.1, 1));
    bsdf.sheen_color = dvec3(0.5);
    bsdf.sheen_alpha = 0.3;
    bsdf.sheen_share = &tables().sheen;
    add("tilted coat over sheen", bsdf, 1.12);
    return all;
}

}  // namespace etalon::test
