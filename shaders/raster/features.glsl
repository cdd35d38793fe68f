// What one pipeline of the rasterizer draws: set from Requirements, material and primitive (engine/render/raster_pipelines.cpp),
// so that the driver drops the rest.
#ifndef ETALON_SHADERS_RASTER_FEATURES_GLSL
#define ETALON_SHADERS_RASTER_FEATURES_GLSL

layout(constant_id = 0) const uint kModel = 0u;             // kModelMetallicRoughness …
layout(constant_id = 1) const bool kBaseColorTexture = false;
layout(constant_id = 2) const bool kMetallicRoughnessTexture = false;
layout(constant_id = 3) const bool kNormalTexture = false;
layout(constant_id = 4) const bool kOcclusionTexture = false;
layout(constant_id = 5) const bool kEmissiveTexture = false;
layout(constant_id = 6) const bool kTextureTransform = false;
layout(constant_id = 7) const bool kNormals = false;        // vertex normals; else of the face
layout(constant_id = 8) const bool kUv1 = false;            // some texture reads TEXCOORD_1
layout(constant_id = 9) const bool kVertexColors = false;
layout(constant_id = 10) const bool kAlphaMask = false;
layout(constant_id = 11) const bool kAlphaBlend = false;
layout(constant_id = 12) const bool kLit = false;           // false: points and lines without normals, and unlit
layout(constant_id = 13) const bool kPunctualLights = false;
layout(constant_id = 14) const uint kEnvironment = 0u;      // kEnvironmentNone …
layout(constant_id = 15) const bool kBlinnPhong = false;
layout(constant_id = 16) const bool kEmission = false;
layout(constant_id = 17) const bool kOrthographic = false;
layout(constant_id = 18) const uint kSamples = 1u;          // of a pixel: 1, 2, 4, 8 or 16
layout(constant_id = 19) const bool kTriangles = true;      // else points or lines
layout(constant_id = 20) const bool kCullBack = true;       // spheres; meshes are culled by the pipeline
layout(constant_id = 21) const bool kEmitters = false;       // emissive surfaces that light others (SH-39)

layout(constant_id = 22) const bool kSpecularLayer = false;  // ior, KHR_materials_specular (SH-50)
layout(constant_id = 23) const bool kClearcoat = false;
layout(constant_id = 24) const bool kSheen = false;
layout(constant_id = 25) const bool kTransmission = false;
layout(constant_id = 26) const bool kVolume = false;         // the transmitting surface bounds a body
layout(constant_id = 27) const bool kIridescence = false;
layout(constant_id = 28) const bool kAnisotropy = false;
layout(constant_id = 29) const bool kDiffuseTransmission = false;
layout(constant_id = 30) const bool kDispersion = false;
layout(constant_id = 31) const uint kLayerTextures = 0u;     // bit i: texture i of LayerRecord, in its order, is read
layout(constant_id = 32) const uint kProbes = 1u;            // most probes of an anisotropic look-up (TX-6)
layout(constant_id = 33) const uint kElement = 0u;           // kElementTriangle …
layout(constant_id = 34) const uint kDepth = 0u;             // DepthKind: 0 is reversed, the others forward (TF-7)
layout(constant_id = 35) const uint kShadows = 0u;           // kShadowsNone … (SH-43), (SH-45)
layout(constant_id = 36) const bool kGatheredLight = false;  // light by rays, not by tables (SH-44)

const uint kElementTriangle = 0u;
const uint kElementLine = 1u;   // a rectangle between its ends
const uint kElementPoint = 2u;  // a square

const uint kShadowsNone = 0u;
const uint kShadowsMap = 1u;
const uint kShadowsRay = 2u;

const uint kEnvironmentNone = 0u;
const uint kEnvironmentConstant = 1u;
const uint kEnvironmentMap = 2u;

#endif
