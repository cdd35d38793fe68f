// What the path tracer's host side and its kernels agree on: binding numbers, specialization constants, buffer layouts.
#ifndef ETALON_SHADERS_SHARED_PATH_H
#define ETALON_SHADERS_SHARED_PATH_H
#include "shaders/shared/types.h"
ETALON_SHARED_BEGIN

// Bindings of set 0. Everything read by kernels is a storage texel buffer of rgba32ui (texels_8: r32ui), floats as
// bits.
ETALON_CONSTANT uint kBindFrame = 0u;       // uniform PathFrame
ETALON_CONSTANT uint kBindNodes = 1u;       // BvhNode: 4 texels, one a child
ETALON_CONSTANT uint kBindPrimitives = 2u;  // 3 texels: (p0, flags) (p1, light density) (p2, object); see below
ETALON_CONSTANT uint kBindAttributes =
    3u;                                    // per primitive: normals, uvs, tangents, colours, 3 texels each, if required
ETALON_CONSTANT uint kBindMaterials = 4u;  // MaterialRecord in 16 texels each, then LayerRecord in 36
ETALON_CONSTANT uint kBindTextures = 5u;   // (first texel, width | height << 16, flags, 0)
ETALON_CONSTANT uint kBindTexels8 = 6u;    // RGBA, 8 bits each
ETALON_CONSTANT uint kBindTexelsWide = 7u;   // RGBA, floats
ETALON_CONSTANT uint kBindLights = 8u;       // LightRecord in 4 texels
ETALON_CONSTANT uint kBindEmitters = 9u;     // alias table: (threshold, other entry's primitive, own primitive, 0)
ETALON_CONSTANT uint kBindSkyCells = 10u;    // alias table: (threshold, other cell, own density, other's density)
ETALON_CONSTANT uint kBindSkyMap = 11u;      // RGB of the environment, floats
ETALON_CONSTANT uint kBindPathsIn = 12u;     // path queue, read: 3 texels a path
ETALON_CONSTANT uint kBindHits = 13u;        // read: the primitive that each path met, r32ui
ETALON_CONSTANT uint kBindShadows = 14u;     // shadow queue, read: 3 texels a ray
ETALON_CONSTANT uint kBindRadianceIn = 15u;  // per slot, read
ETALON_CONSTANT uint kBindPathsOut = 16u;    // the same, written
ETALON_CONSTANT uint kBindHitsOut = 17u;
ETALON_CONSTANT uint kBindShadowsOut = 18u;
ETALON_CONSTANT uint kBindRadiance = 19u;
ETALON_CONSTANT uint kBindCounters = 20u;
ETALON_CONSTANT uint kBindDispatches = 21u;  // workgroup counts, 3 uints a row
ETALON_CONSTANT uint kBindRetries = 22u;     // indices of rays for the exact kernel
ETALON_CONSTANT uint kBindMean = 23u;        // per pixel, replicate after replicate: mean rgb, alpha
ETALON_CONSTANT uint kBindM2 = 24u;          // likewise: sums of squared deviations, (nonfinite | truncated << 16)
ETALON_CONSTANT uint kBindAovs = 25u;        // 4 vec4 a pixel
ETALON_CONSTANT uint kBindAlbedo = 26u;      // tables of shaders/shared/albedo.h
ETALON_CONSTANT uint kBindPixels = 30u;      // of a picture of chosen pixels: which of the view's they are, r32ui

// Specialization constants.
ETALON_CONSTANT uint kSpecTriangles = 0u;
ETALON_CONSTANT uint kSpecSpheres = 1u;
ETALON_CONSTANT uint kSpecNormals = 2u;
ETALON_CONSTANT uint kSpecUv = 3u;
ETALON_CONSTANT uint kSpecTangents = 4u;
ETALON_CONSTANT uint kSpecColors = 5u;
ETALON_CONSTANT uint kSpecBaseColorTexture = 6u;
ETALON_CONSTANT uint kSpecMetallicRoughnessTexture = 7u;
ETALON_CONSTANT uint kSpecNormalTexture = 8u;
ETALON_CONSTANT uint kSpecEmissiveTexture = 9u;
ETALON_CONSTANT uint kSpecTextureTransform = 10u;
ETALON_CONSTANT uint kSpecWideTexels = 11u;
ETALON_CONSTANT uint kSpecAlpha = 12u;  // some surface is masked or blended
ETALON_CONSTANT uint kSpecMetallicRoughness = 13u;
ETALON_CONSTANT uint kSpecUnlit = 14u;
ETALON_CONSTANT uint kSpecLambert = 15u;
ETALON_CONSTANT uint kSpecMirror = 16u;
ETALON_CONSTANT uint kSpecRoughConductor = 17u;
ETALON_CONSTANT uint kSpecDielectric = 18u;
ETALON_CONSTANT uint kSpecRoughDielectric = 19u;
ETALON_CONSTANT uint kSpecEmission = 20u;  // some surface emits
ETALON_CONSTANT uint kSpecPunctual = 21u;
ETALON_CONSTANT uint kSpecSky = 22u;     // the environment is not black
ETALON_CONSTANT uint kSpecSkyMap = 23u;  // it is a map
ETALON_CONSTANT uint kSpecThinLens = 24u;
ETALON_CONSTANT uint kSpecOrthographic = 25u;
ETALON_CONSTANT uint kSpecShadow = 26u;      // trace kernels: shadow rays, not path segments
ETALON_CONSTANT uint kSpecBlendSolid = 27u;  // trace kernels, for AOVs: BLEND counts as a surface
ETALON_CONSTANT uint kSpecRetry = 28u;       // exact trace kernel and generate: what the retry list names, not all
ETALON_CONSTANT uint kSpecStack = 29u;       // entries of the traversal's stack
ETALON_CONSTANT uint kSpecRaysPerLane = 30u;
ETALON_CONSTANT uint kSpecSubgroupLog2 = 31u;
ETALON_CONSTANT uint kSpecFewAtNodes = 32u;  // persistent trace kernel: its loops end when this few lanes are in them
ETALON_CONSTANT uint kSpecFewAtLeaves = 33u;
ETALON_CONSTANT uint kSpecRefill = 34u;  // lanes that must be free before new rays are taken

ETALON_CONSTANT uint kSpecSpecularGlossiness = 35u;
ETALON_CONSTANT uint kSpecSpecular = 36u;
ETALON_CONSTANT uint kSpecClearcoat = 37u;
ETALON_CONSTANT uint kSpecSheen = 38u;
ETALON_CONSTANT uint kSpecTransmission = 39u;
ETALON_CONSTANT uint kSpecVolume = 40u;
ETALON_CONSTANT uint kSpecIridescence = 41u;
ETALON_CONSTANT uint kSpecAnisotropy = 42u;
ETALON_CONSTANT uint kSpecDispersion = 43u;
ETALON_CONSTANT uint kSpecDiffuseTransmission = 44u;
ETALON_CONSTANT uint kSpecLayerTextures = 45u;
ETALON_CONSTANT uint kSpecEquirectangular = 46u;
ETALON_CONSTANT uint kSpecSobol = 47u;         // random numbers of MC-8
ETALON_CONSTANT uint kSpecGlassShadows = 48u;  // shadow rays pass smooth glass (SH-70)
ETALON_CONSTANT uint kSpecChosenPixels = 49u;  // pixels are those of kBindPixels, not a band of rows

ETALON_CONSTANT uint kSpecTurn = 50u;  // fused kernel: lanes at surfaces that are worth a turn of shading

ETALON_CONSTANT uint kSpecLightTree = 60u;  // emitters are chosen by a tree, else by an alias table

ETALON_CONSTANT uint kPathWorkgroup = 64u;

// Bits of a primitive's flags; the low 24 are its material.
ETALON_CONSTANT uint kPrimitiveMaterial = 0x00ffffffu;
ETALON_CONSTANT uint kPrimitiveCulled = 1u << 24u;     // seen and hit from the front alone
ETALON_CONSTANT uint kPrimitiveAlpha = 1u << 25u;      // masked or blended
ETALON_CONSTANT uint kPrimitiveSphere = 1u << 26u;     // p0 = centre, p1.x = radius
ETALON_CONSTANT uint kPrimitiveEmitsBack = 1u << 27u;  // emits to both sides
ETALON_CONSTANT uint kPrimitiveGlass = 1u << 28u;      // smooth glass (SH-70)
ETALON_CONSTANT uint kNoPrimitive = 0xffffffffu;
ETALON_CONSTANT uint kLostPrimitive = 0xfffffffeu;  // as a hit: the traversal gave the ray up

// Bits of a texture's flags.
ETALON_CONSTANT uint kTextureWrapU = 3u;  // 0 repeat, 1 mirrored, 2 clamp
ETALON_CONSTANT uint kTextureWrapVShift = 2u;
ETALON_CONSTANT uint kTextureNearest = 16u;
ETALON_CONSTANT uint kTextureWide = 32u;

// Counters of one iteration: uints from kCountersPerIteration * iteration.
ETALON_CONSTANT uint kCountPaths = 0u;    // entries of the path queue that this iteration traces
ETALON_CONSTANT uint kCountShadows = 1u;  // shadow rays that its shading asked for
ETALON_CONSTANT uint kCountRetriedPaths = 2u;
ETALON_CONSTANT uint kCountRetriedShadows = 3u;
ETALON_CONSTANT uint kCountLeftOver = 4u;  // of iteration 0: slots in kBindRetries that the fused kernel has left
ETALON_CONSTANT uint kCountersPerIteration = 5u;

// Rows of kBindDispatches.
ETALON_CONSTANT uint kDispatchTracePaths = 0u;
ETALON_CONSTANT uint kDispatchShade = 1u;
ETALON_CONSTANT uint kDispatchTraceShadows = 2u;
ETALON_CONSTANT uint kDispatchRetryPaths = 3u;
ETALON_CONSTANT uint kDispatchRetryShadows = 4u;
ETALON_CONSTANT uint kDispatchRows = 5u;

ETALON_CONSTANT uint kBackgroundEnvironment = 0u;
ETALON_CONSTANT uint kBackgroundTransparent = 1u;
ETALON_CONSTANT uint kBackgroundColour = 2u;

// What does not change during a picture. Positions are relative to an origin near the camera, in world axes.
struct PathFrame {
    vec3 eye;  // the camera's position
    float focus_distance;
    vec3 right;    // camera axes, world
    float film_x;  // half extent of the film along right: tangent of the half angle, or metres if orthographic
    vec3 up;
    float film_y;
    vec3 forward;
    float lens_radius;  // metres
    uint width;
    uint height;
    uint seed;
    vec3 grid_base;  // BvhGrid
    uint max_depth;
    vec3 grid_scale;
    uint roulette;    // 1: Russian roulette
    vec3 bounds_min;  // of the scene
    uint emitter_count;
    vec3 bounds_max;
    uint light_count;
    vec3 sky;             // radiance of a constant environment; factor of a map
    uint strategy_count;  // kinds of light that next-event estimation chooses among
    vec3 background;      // seen by camera rays that leave, for kBackgroundColour
    uint background_mode;
    float sky_cos;  // of the environment's rotation
    float sky_sin;
    uint sky_width;  // texels of the map
    uint sky_height;
    uint cells_x;  // cells of its alias table; 0: black
    uint cells_y;
    uint lens_blades;  // corners of the aperture; under 3: a disk
};

// What changes from dispatch to dispatch.
struct PathPush {
    uint first_slot;    // of this wave: slots are sample * pixel_count + pixel
    uint slot_count;    // of this wave
    uint pixel_count;   // of the band
    uint first_pixel;   // of the band in the picture
    uint first_sample;  // of slot 0
    uint sample_count;  // samples a pixel in this pass
    uint iteration;     // 0: camera rays; segment number less one
    uint done;          // samples of this block that the film holds already
};

ETALON_SHARED_END
#ifdef __cplusplus
static_assert(sizeof(etalon::shared::PathPush) == 32);
#endif
#endif
