#pragma once
#include <span>
#include <vector>

#include "engine/scene/pose.h"
#include "shaders/shared/material.h"

namespace etalon {

/// The point that everything on a device is relative to: the camera's position, world, metres (TF-2).
dvec3 eye_of(const View& view);

/// The device's form of a material: factors rounded to float, flags derived from model, alpha mode and sides (SH-6).
/// TextureSlot::texture is the index into Scene::textures.
shared::MaterialRecord pack(const Material& material);

/// The device's form of a punctual light relative to `eye` (SH-22).
shared::LightRecord pack(const PosedLight& light, const dvec3& eye);

/// One record per material of a scene (PosedScene::materials), in their order, so that Scene indices stay valid on the
/// device.
std::vector<shared::MaterialRecord> pack_materials(std::span<const Material> materials);

/// The layers of those materials that have any, in the order that MaterialRecord::layers counts.
std::vector<shared::LayerRecord> pack_layers(std::span<const Material> materials);

/// One record per posed light that gives any light: zero intensity or zero colour is left out.
std::vector<shared::LightRecord> pack_lights(const PosedScene& posed);

}  // namespace etalon
