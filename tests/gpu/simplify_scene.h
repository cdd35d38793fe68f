#pragma once
#include <array>
#include <functional>
#include <vector>

#include "engine/scene/builder.h"
#include "engine/scene/simplify.h"

namespace etalon::test {

/// A wall of tiles, each of a material of which simplify() takes something, beside one that nothing is taken of.
/// `removable`: how many places of materials those are.
struct SimplifiableScene {
    Scene scene;
    std::size_t removable = 0;
    std::vector<std::string> tiles;  ///< what each shows
};

class SimplifiableWall {
 public:
    SimplifiableWall() : build_("simplifiable")
    {
        own_materials();
        layers();
        Environment sky;
        sky.radiance = dvec3(0.3, 0.4, 0.5);
        build_.environment(sky);
        Light lamp;
        lamp.intensity = 40;
        build_.light(lamp, translation({1, 2, 4}));
        build_.camera("eye", 40, dvec3(0.4, 0.3, 5.5), dvec3(0));
    }
    SimplifiableScene finish() &&
    {
        out_.scene = std::move(build_).finish();
        return std::move(out_);
    }

 private:
    using Texel = std::array<std::uint8_t, 4>;

    /// Channels of 256 differ from texel to texel.
    TextureUse texture(std::array<int, 4> channels)
    {
        return build_.texture("t", 4, 4, {}, [&](int x, int y) {
            Texel texel;
            for (std::size_t c = 0; c < 4; ++c)
                texel[c] = static_cast<std::uint8_t>(channels[c] == 256 ? 40 + 13 * (4 * y + x) : channels[c]);
            return texel;
        });
    }

    void tile(const char* what, std::size_t removable, const std::function<void(Material&)>& change)
    {
        constexpr int kColumns = 6;
        const int i = static_cast<int>(out_.tiles.size());
        Material material;
        material.name = what;
        material.base_color = dvec4(0.8, 0.5, 0.3, 1);
        material.metallic = 0.3;
        material.roughness = 0.4;
        material.double_sided = i % 2 == 0;
        change(material);
        const dvec3 at(-1.5 + 0.6 * (i % kColumns), 1.0 - 0.6 * (i / kColumns), 0);
        // Some are seen from behind.
        const dvec3 right = i % 4 == 0 ? dvec3(-0.28, 0, 0.05) : dvec3(0.28, 0, 0.05);
        Primitive quad = make_rectangle(at, right, dvec3(0, 0.28, 0.1));
        quad.colors.assign(4, vec4(1));
        build_.show(what, quad, build_.material(material));
        out_.tiles.emplace_back(what);
        out_.removable += removable;
    }

    void own_materials()
    {
        tile("nothing", 0, [&](Material& m) { m.base_color_texture = texture({256, 256, 256, 255}); });
        tile("another constant", 0, [&](Material& m) { m.base_color_texture = texture({200, 90, 255, 255}); });
        tile("white base", 1, [&](Material& m) { m.base_color_texture = texture({255, 255, 255, 256}); });
        tile("black base", 1, [&](Material& m) { m.base_color_texture = texture({0, 0, 0, 256}); });
        tile("masked by 1", 1, [&](Material& m) {
            m.alpha_mode = AlphaMode::mask;
            m.base_color_texture = texture({255, 0, 255, 255});
        });
        tile("metal by channel", 1, [&](Material& m) { m.metallic_roughness_texture = texture({256, 255, 0, 256}); });
        tile("metal by 0", 1, [&](Material& m) {
            m.metallic = m.roughness = 0;
            m.metallic_roughness_texture = texture({256, 256, 256, 256});
        });
        tile("white emission", 0, [&](Material& m) {
            m.emission = dvec3(2, 1, 0.5);
            m.emissive_texture = texture({255, 255, 255, 256});
        });
        tile("black emission", 1, [&](Material& m) {
            m.emission = dvec3(2, 1, 0.5);
            m.emissive_texture = texture({0, 0, 0, 256});
        });
        tile("no occlusion", 0, [&](Material& m) { m.occlusion_texture = texture({255, 256, 256, 256}); });
        tile("blended by 1", 1, [&](Material& m) {
            m.alpha_mode = AlphaMode::blend;
            m.base_color_texture = texture({255, 255, 0, 255});
        });
    }

    void layers()
    {
        const auto layered = [&](const char* what, std::size_t count,
                                 const std::function<void(MaterialLayers&)>& change) {
            tile(what, count, [&](Material& m) { change(m.layers.emplace()); });
        };
        layered("no coat", 0, [&](MaterialLayers& l) {
            l.clearcoat = 1;
            l.clearcoat_texture = texture({0, 256, 256, 256});
        });
        layered("whole coat", 2, [&](MaterialLayers& l) {
            l.clearcoat = 0.7;
            l.clearcoat_roughness = 0.3;
            l.clearcoat_texture = texture({255, 256, 256, 256});
            l.clearcoat_roughness_texture = texture({256, 255, 256, 256});
        });
        layered("no sheen", 0, [&](MaterialLayers& l) {
            l.sheen_color = dvec3(0.5);
            l.sheen_roughness = 0.5;
            l.sheen_color_texture = texture({0, 0, 0, 256});
        });
        layered("whole sheen", 2, [&](MaterialLayers& l) {
            l.sheen_color = dvec3(0.5, 0.6, 0.7);
            l.sheen_roughness = 0.5;
            l.sheen_color_texture = texture({255, 255, 255, 256});
            l.sheen_roughness_texture = texture({256, 256, 256, 255});
        });
        layered("no film", 0, [&](MaterialLayers& l) {
            l.iridescence = 1;
            l.iridescence_texture = texture({0, 256, 256, 256});
        });
        layered("no highlight", 2, [&](MaterialLayers& l) {
            l.specular = 0.8;
            l.specular_texture = texture({256, 256, 256, 0});
            l.specular_color_texture = texture({255, 255, 0, 256});
        });
        layered("transmission", 0, [&](MaterialLayers& l) {
            l.transmission = 0.8;
            l.transmission_texture = texture({255, 256, 256, 256});
        });
        layered("light through", 0, [&](MaterialLayers& l) {
            l.diffuse_transmission = 0.8;
            l.diffuse_transmission_texture = texture({256, 256, 256, 255});
            l.diffuse_transmission_color_texture = texture({255, 255, 0, 256});
        });
    }

    SceneBuilder build_;
    SimplifiableScene out_;
};

inline SimplifiableScene simplifiable_scene()
{
    return SimplifiableWall().finish();
}

}  // namespace etalon::test
