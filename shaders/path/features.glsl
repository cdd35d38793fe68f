// Specialization constants: what the scene requires (engine/scene/requirements.h). All on by default, so that a kernel
// compiled alone is complete.
#ifndef ETALON_PATH_FEATURES_GLSL
#define ETALON_PATH_FEATURES_GLSL
#include "shaders/shared/path.h"

layout(constant_id = kSpecTriangles) const bool kTriangles = true;
layout(constant_id = kSpecSpheres) const bool kSpheres = true;
layout(constant_id = kSpecNormals) const bool kNormals = true;
layout(constant_id = kSpecUv) const bool kUv = true;
layout(constant_id = kSpecTangents) const bool kTangents = true;
layout(constant_id = kSpecColors) const bool kColors = true;
layout(constant_id = kSpecBaseColorTexture) const bool kBaseColorTexture = true;
layout(constant_id = kSpecMetallicRoughnessTexture) const bool kMetallicRoughnessTexture = true;
layout(constant_id = kSpecNormalTexture) const bool kNormalTexture = true;
layout(constant_id = kSpecEmissiveTexture) const bool kEmissiveTexture = true;
layout(constant_id = kSpecTextureTransform) const bool kTextureTransform = true;
layout(constant_id = kSpecWideTexels) const bool kWideTexels = true;
layout(constant_id = kSpecAlpha) const bool kAlpha = true;
layout(constant_id = kSpecMetallicRoughness) const bool kMetallicRoughness = true;
layout(constant_id = kSpecUnlit) const bool kUnlit = true;
layout(constant_id = kSpecLambert) const bool kLambert = true;
layout(constant_id = kSpecMirror) const bool kMirror = true;
layout(constant_id = kSpecRoughConductor) const bool kRoughConductor = true;
layout(constant_id = kSpecDielectric) const bool kDielectric = true;
layout(constant_id = kSpecRoughDielectric) const bool kRoughDielectric = true;
layout(constant_id = kSpecEmission) const bool kEmission = true;
layout(constant_id = kSpecPunctual) const bool kPunctual = true;
layout(constant_id = kSpecSky) const bool kSky = true;
layout(constant_id = kSpecSkyMap) const bool kSkyMap = true;
layout(constant_id = kSpecThinLens) const bool kThinLens = true;
layout(constant_id = kSpecOrthographic) const bool kOrthographic = true;
layout(constant_id = kSpecEquirectangular) const bool kEquirectangular = true;
layout(constant_id = kSpecSobol) const bool kSobol = false;
layout(constant_id = kSpecGlassShadows) const bool kGlassShadows = false;
layout(constant_id = kSpecChosenPixels) const bool kChosenPixels = false;
layout(constant_id = kSpecSpecularGlossiness) const bool kSpecularGlossiness = true;
layout(constant_id = kSpecSpecular) const bool kSpecular = true;
layout(constant_id = kSpecClearcoat) const bool kClearcoat = true;
layout(constant_id = kSpecSheen) const bool kSheen = true;
layout(constant_id = kSpecTransmission) const bool kTransmission = true;
layout(constant_id = kSpecVolume) const bool kVolume = true;
layout(constant_id = kSpecIridescence) const bool kIridescence = true;
layout(constant_id = kSpecAnisotropy) const bool kAnisotropy = true;
layout(constant_id = kSpecDispersion) const bool kDispersion = true;
layout(constant_id = kSpecDiffuseTransmission) const bool kDiffuseTransmission = true;
layout(constant_id = kSpecLayerTextures) const bool kLayerTextures = true;
const bool kAnyLayer = kSpecular || kClearcoat || kSheen || kTransmission || kIridescence || kAnisotropy || kDiffuseTransmission;

layout(constant_id = kSpecLightTree) const bool kLightTree = true;
layout(constant_id = kSpecSubgroupLog2) const uint kSubgroupLog2 = 3u;

#endif
