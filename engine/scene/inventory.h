#pragma once
#include <cstdint>
#include <string>
#include <vector>

#include "engine/scene/scene.h"

namespace etalon {

/// What is in a scene, for people and machines to read: `etalon info SCENE`.
struct Inventory {
    struct RootRow {
        std::string name;
        std::size_t nodes = 0;  ///< reached from it
        bool is_default = false;
    };
    struct CameraRow {
        std::string name;  ///< the camera's own, else that of the first node that has it
        bool orthographic = false;
        double yfov = 0;  ///< degrees; perspective
        double ymag = 0;  ///< metres; orthographic
        bool has_lens = false;
    };
    struct LightRow {
        std::string name;
        std::string type;      ///< "point", "spot", "directional"
        double intensity = 0;  ///< candela or lux
    };
    struct MaterialRow {
        std::string name;
        std::string model;  ///< "metallic-roughness", "unlit", …
        std::string alpha;  ///< "opaque", "mask", "blend"
        int textures = 0;
        bool emits = false;
        bool double_sided = false;
        std::vector<std::string> layers;  ///< "clearcoat", "volume", …: those of its extensions that show
    };
    struct ImageRow {
        std::string name;  ///< of the first texture that uses it
        int width = 0;
        int height = 0;
        int bits = 8;
    };

    std::vector<RootRow> roots;
    std::vector<CameraRow> cameras;
    std::vector<LightRow> lights;
    std::vector<MaterialRow> materials;
    std::vector<ImageRow> images;
    struct AnimationRow {
        std::string name;
        double duration = 0;  ///< seconds
        std::size_t channels = 0;
        std::size_t keys = 0;  ///< of all its samplers
    };
    struct SkinRow {
        std::string name;
        std::size_t joints = 0;
    };

    std::vector<std::string> variants;
    std::vector<Metadata> metadata;  ///< of KHR_xmp_json_ld
    std::vector<AnimationRow> animations;
    std::vector<SkinRow> skins;
    std::size_t morph_targets = 0;  ///< of all primitives
    std::vector<std::string> warnings;
    std::vector<std::string> broken_rules;

    std::size_t nodes = 0;
    std::size_t meshes = 0;
    std::size_t primitives = 0;
    std::size_t vertices = 0;
    std::size_t triangles = 0;  ///< stored once, however often they are instanced
    std::size_t lines = 0;
    std::size_t points = 0;
    std::size_t spheres = 0;
    std::size_t instances = 0;  ///< of EXT_mesh_gpu_instancing

    /// Bytes. Geometry: every attribute once (48 bytes a vertex with normals, tangents and uv; 4 an index);
    /// textures: RGBA8 or RGBA32F with a full chain of mip levels (4/3). What a renderer needs: footprint.h.
    std::uint64_t geometry_bytes = 0;
    std::uint64_t texture_bytes = 0;
};

Inventory describe(const Scene& scene);

}  // namespace etalon
