#pragma once
#include <array>
#include <filesystem>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "engine/image/image.h"
#include "engine/math/types.h"

namespace etalon {

/// Index into one of Scene's vectors; kNone where there is nothing.
using Index = std::uint32_t;
inline constexpr Index kNone = 0xffffffffu;

enum class Topology { points, lines, triangles };

/// What one morph target adds, in mesh space, where its weight is 1. Each list is empty (nothing) or has one entry per
/// position of the primitive, all finite.
struct MorphTarget {
    std::vector<vec3> positions;
    std::vector<vec3> normals;
    std::vector<vec3> tangents;  ///< to xyz
};

/// How far a joint of the skin moves a vertex.
struct Influence {
    std::uint32_t joint = 0;  ///< index into Skin::joints
    float weight = 0;         ///< finite, >= 0; a vertex's need not add up to 1
};

/// One draw's geometry in mesh space, metres. Strips, fans and loops have been unrolled into `indices`.
/// Every attribute is empty or has one entry per position, all finite.
struct Primitive {
    Topology topology = Topology::triangles;
    std::vector<vec3> positions;
    std::vector<vec3> normals;   ///< unit; computed flat when the file has none (has_normals false);
                                 ///< empty for points and lines without them, which are drawn unlit
    std::vector<vec4> tangents;  ///< xyz unit, w = ±1 the bitangent's sign; filled where a normal map needs them
    std::array<std::vector<vec2>, 2> uv;  ///< TEXCOORD_0, TEXCOORD_1; v = 0 is the top row of the texture
    std::vector<vec4> colors;             ///< COLOR_0, linear; multiplies base colour and alpha
    std::vector<std::uint32_t> indices;   ///< 1, 2 or 3 an element; every value < positions.size()
    Index material = 0;                   ///< always a valid index: a default material is appended where needed
    bool has_normals = false;             ///< the file gave normals; else they are the geometric ones of flat faces
    std::optional<int> tangents_from_uv;  ///< the uv set that they were computed from; nothing: the file gave them
    std::vector<MorphTarget> targets;
    std::vector<Influence> influences;  ///< influences_per_vertex for each position, in its order; empty: no skin
    std::size_t influences_per_vertex = 0;
    bool is_deformable() const { return !targets.empty() || !influences.empty(); }
};

struct Mesh {
    std::string name;
    std::vector<Primitive> primitives;
    std::vector<double> weights;  ///< of the morph targets, where neither node nor animation says otherwise
};

/// Bones. Joint i takes a vertex from mesh space into the world by world_from_node(joints[i]) · inverse_bind[i]; where
/// the mesh's own node is does not matter (glTF 2.0 §3.7.3.3).
struct Skin {
    std::string name;
    std::vector<Index> joints;        ///< nodes
    std::vector<dmat4> inverse_bind;  ///< one per joint, affine; possibly singular
};

enum class Wrap { repeat, mirrored_repeat, clamp_to_edge };
enum class Filter { nearest, linear };

/// glTF sampler. Without mipmaps level 0 alone is used.
struct Sampler {
    Wrap wrap_u = Wrap::repeat;
    Wrap wrap_v = Wrap::repeat;
    Filter mag = Filter::linear;
    Filter min = Filter::linear;
    Filter mip = Filter::linear;
    bool mipmapped = true;
};

/// Texels as the file coded them, and how they are to be read.
struct Texture {
    std::string name;
    Index image = kNone;  ///< into Scene::images
    Sampler sampler;
};

/// A texture as a material uses it. uv' = transform * (u, v, 1) (KHR_texture_transform; identity otherwise).
struct TextureUse {
    Index texture = kNone;
    int uv_set = 0;
    dmat3 transform{1};
    bool present() const { return texture != kNone; }
};

/// Which BSDF: glTF's metallic-roughness model (with its layers), KHR_materials_pbrSpecularGlossiness, or one of
/// extras.etalon.bsdf. docs/shading.md §2.
enum class BsdfModel {
    metallic_roughness,
    unlit,
    lambert,
    mirror,
    rough_conductor,
    dielectric,
    rough_dielectric,
    specular_glossiness
};
enum class AlphaMode { opaque, mask, blend };

/// What glTF's extensions add to metallic_roughness and specular_glossiness; the standard values change nothing.
/// Textures multiply their factors; the channel read is named. docs/shading.md §2b.
struct MaterialLayers {
    double ior = 1.5;       ///< KHR_materials_ior; 0 means infinite: F0 = 1
    double dispersion = 0;  ///< KHR_materials_dispersion, 20 / Abbe number

    double specular = 1;  ///< KHR_materials_specular
    dvec3 specular_color{1};
    TextureUse specular_texture;        ///< A
    TextureUse specular_color_texture;  ///< sRGB

    double clearcoat = 0;  ///< KHR_materials_clearcoat
    double clearcoat_roughness = 0;
    double clearcoat_normal_scale = 1;
    TextureUse clearcoat_texture;            ///< R
    TextureUse clearcoat_roughness_texture;  ///< G
    TextureUse clearcoat_normal_texture;     ///< tangent space; without it the coat has no normal map

    dvec3 sheen_color{0};  ///< KHR_materials_sheen
    double sheen_roughness = 0;
    TextureUse sheen_color_texture;      ///< sRGB
    TextureUse sheen_roughness_texture;  ///< A

    double transmission = 0;          ///< KHR_materials_transmission
    TextureUse transmission_texture;  ///< R

    double thickness = 0;  ///< KHR_materials_volume, metres in mesh space; 0: thin-walled
    double attenuation_distance = std::numeric_limits<double>::infinity();  ///< metres in the world
    dvec3 attenuation_color{1};
    TextureUse thickness_texture;  ///< G; read by rasterizers alone

    double iridescence = 0;  ///< KHR_materials_iridescence
    double iridescence_ior = 1.3;
    double iridescence_thickness_min = 100;  ///< nanometres
    double iridescence_thickness_max = 400;
    TextureUse iridescence_texture;            ///< R
    TextureUse iridescence_thickness_texture;  ///< G: from min to max; absent: max

    double anisotropy = 0;           ///< KHR_materials_anisotropy, strength
    double anisotropy_rotation = 0;  ///< radians, counter-clockwise from the tangent
    TextureUse anisotropy_texture;   ///< RG direction (2 texel - 1), B strength

    double diffuse_transmission = 0;  ///< KHR_materials_diffuse_transmission
    dvec3 diffuse_transmission_color{1};
    TextureUse diffuse_transmission_texture;        ///< A
    TextureUse diffuse_transmission_color_texture;  ///< sRGB

    /// Light enters a body, is refracted and absorbed: back faces are seen as its way out (SH-6).
    bool volumetric() const { return transmission > 0 && thickness > 0; }
};

struct Material {
    std::string name;
    BsdfModel model = BsdfModel::metallic_roughness;
    dvec4 base_color{1};  ///< linear factor and alpha; the reflectance of lambert and mirror
    double metallic = 1;
    double roughness = 1;  ///< perceptual
    dvec3 emission{0};     ///< radiance, nit: factor × KHR_materials_emissive_strength
    dvec3 eta{1.5};        ///< rough_conductor: per channel; dielectrics: ior in x
    dvec3 k{0};            ///< rough_conductor: extinction per channel; specular_glossiness: the specular factor
    double ggx_alpha = 0;  ///< rough_conductor, rough_dielectric
    double normal_scale = 1;
    double occlusion_strength = 1;
    AlphaMode alpha_mode = AlphaMode::opaque;
    double alpha_cutoff = 0.5;
    bool double_sided = false;
    bool emits_front_only = false;          ///< extras.etalon.emission "front": also where double_sided
    TextureUse base_color_texture;          ///< sRGB colour, linear alpha
    TextureUse metallic_roughness_texture;  ///< linear; G roughness, B metallic. specular_glossiness: sRGB specular,
                                            ///< A glossiness
    TextureUse normal_texture;              ///< linear, tangent space
    TextureUse occlusion_texture;           ///< linear, R
    TextureUse emissive_texture;            ///< sRGB
    std::optional<MaterialLayers> layers;   ///< nothing: no extension of §2b changes this material
};

enum class LightType { point, spot, directional };

/// KHR_lights_punctual. Radiometric or photometric alike: the film's unit follows (docs/equations.md).
struct Light {
    std::string name;
    LightType type = LightType::point;
    dvec3 color{1};
    double intensity = 1;         ///< candela (point, spot), lux (directional)
    double range = 0;             ///< metres; 0: unlimited
    double inner_cone = 0;        ///< radians
    double outer_cone = kPi / 4;  ///< radians
};

struct ThinLens {
    double aperture_radius = 0;  ///< metres, to the corners of a polygon
    double focus_distance = 1;   ///< metres along the axis
    int blades = 0;              ///< corners of a regular polygonal aperture, the first at +X; under 3: a disk
};

struct Camera {
    std::string name;
    bool orthographic = false;
    bool equirectangular = false;  ///< sees all directions (docs of View); path tracers alone, no lens
    double yfov = kPi / 4;         ///< full vertical angle, radians
    std::optional<double> aspect;  ///< of the file; the picture's own aspect is used for rendering
    double xmag = 1, ymag = 1;     ///< half extents of an orthographic view, metres
    double znear = 0.01;           ///< metres; used by rasterizers alone
    std::optional<ThinLens> lens;
};

/// extras.etalon shape of a node: an exact sphere about the node's origin.
struct SphereShape {
    double radius = 1;
    Index material = 0;
};

/// Translation · rotation · scale. The rotation need not be unit.
struct Trs {
    dvec3 translation{0};
    dquat rotation{1, 0, 0, 0};
    dvec3 scale{1};
};

struct Node {
    std::string name;
    dmat4 parent_from_node{1};
    std::optional<Trs> trs;  ///< what parent_from_node is made of; nothing where the file gave a matrix
    std::vector<Index> children;
    Index mesh = kNone;
    Index skin = kNone;           ///< of its mesh
    std::vector<double> weights;  ///< of its mesh's morph targets; empty: the mesh's own
    Index camera = kNone;
    Index light = kNone;
    std::optional<SphereShape> sphere;
    std::vector<dmat4> instances;  ///< EXT_mesh_gpu_instancing, node from instance; empty: one, the identity
    bool visible = true;           ///< KHR_node_visibility; false hides the whole subtree
};

/// Light from infinitely far. For world direction d: d' = R_y(-rotation) d, u = fract(atan2(d'.x, -d'.z) / 2π),
/// v = acos(d'.y) / π, value = scale × (map ? bilinear(map, u wraps, v clamps) : radiance). docs/shading.md §5.
struct Environment {
    dvec3 radiance{0};                 ///< nit, where there is no map
    std::shared_ptr<const Image> map;  ///< equirectangular linear radiance, 3 channels; null: constant
    double rotation = 0;               ///< radians about +Y
    double scale = 1;
    bool is_black() const { return map ? scale == 0 : radiance == dvec3(0) || scale == 0; }
};

/// extras.etalon of a glTF scene: what its author fixed about the picture.
struct FilmHints {
    std::optional<ivec2> size;
    std::optional<int> max_depth;
};

struct SceneRoot {
    std::string name;
    std::vector<Index> nodes;
    std::optional<Environment> environment;  ///< nothing: the file says none
    FilmHints hints;
};

enum class Interpolation { step, linear, cubic };

/// A curve through keys (glTF 2.0 §3.11 and appendix C).
struct AnimationSampler {
    Interpolation interpolation = Interpolation::linear;
    std::size_t width = 0;       ///< numbers of a value: 3 of a translation, one per target of weights
    std::vector<double> times;   ///< seconds, finite, never falling; at least one
    std::vector<double> values;  ///< width numbers a key, finite; cubic: 3 width (in-tangent, value, out-tangent)
};

/// A property that follows a sampler. `property` is a row of animated_properties() (engine/scene/animation.h), which
/// says what `object` is an index of.
struct AnimationChannel {
    Index sampler = 0;
    Index property = 0;
    Index object = 0;
};

struct Animation {
    std::string name;  ///< "animation 3" where the file gives none
    std::vector<AnimationSampler> samplers;
    std::vector<AnimationChannel> channels;  ///< no two with the same property and object
    double duration = 0;                     ///< of the last key, seconds
};

/// A statement about the asset as a whole: "dc:creator", "Khronos".
struct Metadata {
    std::string name;
    std::string value;
};

/// A glTF asset as a plain value; knows neither devices nor files nor time.
struct Scene {
    std::string name;  ///< file name without folder, or "builtin:…"
    std::vector<Mesh> meshes;
    std::vector<Material> materials;
    std::vector<Texture> textures;
    std::vector<Texels> images;
    std::vector<Camera> cameras;
    std::vector<Light> lights;
    std::vector<Skin> skins;
    std::vector<Node> nodes;       ///< a forest: every child has one parent, no cycle
    std::vector<SceneRoot> roots;  ///< glTF's scenes; at least one
    Index default_root = 0;
    std::vector<Animation> animations;
    std::vector<std::string> warnings;  ///< what was ignored or mended, one line each, with its JSON pointer
    std::vector<std::string>
        broken_rules;                   ///< rules of glTF that the file breaks without harm to the picture; likewise
    std::vector<std::string> variants;  ///< names of KHR_materials_variants; LoadOptions::variant chooses
    std::vector<Metadata> metadata;     ///< what KHR_xmp_json_ld says of the asset
};

}  // namespace etalon
