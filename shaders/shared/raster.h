// What a frame and a draw of the rasterizer tell its shaders, one definition for C++ and GLSL (scalar layout).
// Positions are camera-relative world space, metres (TF-2).
#ifndef ETALON_SHADERS_SHARED_RASTER_H
#define ETALON_SHADERS_SHARED_RASTER_H
#include "shaders/shared/types.h"
ETALON_SHARED_BEGIN

struct RasterFrame {
    mat4 clip_from_world;
    mat3 world_from_camera;     // rotation alone
    vec3 environment_radiance;  // of a constant environment, scaled
    vec2 environment_turn;      // cos, sin of the environment's rotation about +Y
    float environment_scale;
    vec2 film_half;     // half extents of the view at unit distance (perspective) or in metres (orthographic)
    vec2 size;          // of the picture, pixels
    vec2 depth_range;   // near, and far of an orthographic or forward view, metres
    uvec2 mirror_size;  // of table 0 in the environment's atlas, texels
    uint light_count;
    uint emitter_count;
    vec4 background;   // behind everything, where the environment is not drawn there
    float point_size;  // drawn pixels
    float line_width;
};

// Bits of EmitterRecord::flags.
ETALON_CONSTANT uint kEmitterFlat = 1u;  // seen by the projection of its area vector, else by a quarter of its area
ETALON_CONSTANT uint kEmitterTwoSided = 2u;

/// An emissive draw or sphere as others see it (SH-39).
struct EmitterRecord {
    vec3 radiance;     // nit
    float area;        // square metres
    vec3 center;       // camera-relative world
    uint object_id;    // as RasterDraw's
    vec3 area_vector;  // sum of area times ng, world, square metres
    uint flags;
};

/// What one shadow map sees (SH-43). Light i has six in a row: a point light one each way of the axes, the others their
/// first.
struct RasterShadow {
    mat3 light_from_world;  // rotation
    vec3 eye;               // camera-relative world
    float half_extent;      // of the map, at unit distance or, of a directional light, in metres
    vec2 depth_range;       // near, and far of a directional light, metres
    uint kind;              // kShadowNone …
    uint side;              // texels
    uint first;             // of its depths, rows from the top
};
ETALON_CONSTANT uint kShadowNone = 0u;
ETALON_CONSTANT uint kShadowCone = 1u;
ETALON_CONSTANT uint kShadowParallel = 2u;
ETALON_CONSTANT uint kShadowCube = 3u;

/// One draw of a mesh: push constants.
struct RasterDraw {
    vec4 object_rows[3];  // rows of camera-relative world from object
    mat3 normal_matrix;   // sign(det M) cofactor(M) (SH-2)
    float handedness;     // sign(det M): a mirror turns bitangents over
    float scale;          // |det M|^(1/3): metres in the world per metre of thickness (SH-65)
    uint material;        // index of its MaterialRecord
    uint object_id;       // AOV
    uint first_face;      // of this primitive among the face normals
};

/// One exact sphere: push constants.
struct RasterSphere {
    vec3 center;
    float radius;
    uint material;
    uint object_id;
    float scale;  // as RasterDraw's
};

/// One level of the picture behind transmitting surfaces: push constants of shrink.comp.
struct RasterShrink {
    uvec2 size;  // of the picture, pixels
    uint level;
};

/// One axis of reconstruction (AA-2): push constants of filter.comp.
struct RasterReconstruction {
    uvec2 size;     // of what is written, pixels
    int first;      // of the drawn pixels that a pixel weighs, relative to its own first
    uint taps;      // how many they are
    uint per_side;  // drawn pixels along a side of a pixel
    uint vertical;  // 0: along rows
};

ETALON_SHARED_END
#ifdef __cplusplus
static_assert(sizeof(etalon::shared::RasterFrame) == 64 + 36 + 12 + 8 + 4 + 8 + 8 + 8 + 8 + 8 + 16 + 8);
static_assert(sizeof(etalon::shared::EmitterRecord) == 48);
static_assert(sizeof(etalon::shared::RasterDraw) == 48 + 36 + 20);
static_assert(sizeof(etalon::shared::RasterSphere) == 28);
#endif
#endif
