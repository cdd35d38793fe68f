#include <bitset>
#include <string>

#include "engine/base/error.h"
#include "engine/scene/load.h"
#include "tests/gpu/raster_stage.h"

// Requirements are honest (DESIGN §4): a bit too many changes no pixel; a bit too few changes the picture or is
// refused.
namespace etalon::test {
namespace {

class RasterRequirements : public DeviceTest {
 protected:
    Film render(const PosedScene& posed, const Requirements& required, const RenderSettings& settings)
    {
        return render_raster(device(), posed, required, settings, {});
    }
};

constexpr ivec2 kSize(48, 36);

/// Features that a rasterizer has nothing to do for.
bool is_for_path_tracers(Feature feature)
{
    return feature == Feature::thin_lens || feature == Feature::equirectangular;
}

bool same(const Film& a, const Film& b)
{
    return a.mean == b.mean && a.alpha == b.alpha && a.aovs.depth == b.aovs.depth && a.aovs.uv == b.aovs.uv;
}

std::vector<Scene> all_scenes()
{
    std::vector<Scene> scenes;
    for (const BuiltinScene& builtin : builtin_scenes()) scenes.push_back(make_builtin(builtin.name));
    return scenes;
}

std::string_view short_name(const Scene& scene)
{
    return std::string_view(scene.name).substr(scene.name.find(':') + 1);
}

RenderSettings settings_for(std::string_view builtin)
{
    RenderSettings settings;
    settings.aovs = builtin == "triangle";
    if (builtin == "blinn-phong") settings.shading = Shading::blinn_phong;
    return settings;
}

/// Second uv set, texture transform and vertex colours, which no built-in scene has together.
Scene textured_scene()
{
    SceneBuilder scene("textured");
    Material material;
    material.model = BsdfModel::unlit;
    material.base_color_texture = scene.texture("checks", 4, 4, {}, [](int x, int y) {
        return std::array<std::uint8_t, 4>{std::uint8_t(x * 60), std::uint8_t(y * 60), 0, 255};
    });
    material.base_color_texture.uv_set = 1;
    material.base_color_texture.transform[2] = dvec3(0.3, 0.1, 1);
    Primitive primitive = make_rectangle({0, 0, 0}, {1, 0, 0}, {0, 1, 0});
    primitive.uv[1] = primitive.uv[0];
    primitive.colors.assign(4, vec4(0.5f, 1, 1, 1));
    scene.show("wall", primitive, scene.material(material));
    scene.camera("eye", 45, {0, 0, 3}, {0, 0, 0});
    return std::move(scene).finish();
}

TEST_F(RasterRequirements, all_bits_set_give_the_same_pixels)
{
    for (const Scene& scene : all_scenes()) {
        const PosedScene posed = pose(scene, {.size = kSize});
        const RenderSettings settings = settings_for(short_name(scene));
        const Requirements needed = require(posed, settings);
        Requirements all = needed;
        for (std::size_t i = 0; i < kFeatureCount; ++i) all.set(static_cast<Feature>(i), "test");
        all.texture_used.assign(scene.textures.size(), true);
        all.material_used.assign(scene.materials.size(), true);
        EXPECT_TRUE(same(render(posed, needed, settings), render(posed, all, settings))) << scene.name;
    }
}

TEST_F(RasterRequirements, every_bit_is_necessary_to_some_scene)
{
    std::vector<Scene> scenes = all_scenes();
    scenes.push_back(textured_scene());
    std::bitset<kFeatureCount> met, necessary;
    for (const Scene& scene : scenes) {
        const PosedScene posed = pose(scene, {.size = kSize});
        const RenderSettings settings = settings_for(short_name(scene));
        const Requirements needed = require(posed, settings);
        met |= needed.bits;
        if ((needed.bits & ~necessary).none()) continue;
        const Film whole = render(posed, needed, settings);
        for (std::size_t i = 0; i < kFeatureCount; ++i) {
            if (!needed.bits[i] || necessary[i]) continue;
            Requirements fewer = needed;
            fewer.bits[i] = false;
            try {
                necessary[i] = !same(whole, render(posed, fewer, settings));
            } catch (const Error&) {
                necessary[i] = true;
            }
        }
    }
    for (std::size_t i = 0; i < kFeatureCount; ++i) {
        const auto feature = static_cast<Feature>(i);
        if (is_for_path_tracers(feature)) continue;
        EXPECT_TRUE(met[i]) << name(feature) << ": no scene here has it";
        EXPECT_TRUE(necessary[i]) << name(feature) << ": clearing it changes nothing";
    }
}

TEST_F(RasterRequirements, a_material_whose_model_was_not_required_is_refused)
{
    const Scene scene = make_builtin("triangle");
    const PosedScene posed = pose(scene, {.size = kSize});
    const Requirements nothing{.bits = std::bitset<kFeatureCount>().set(static_cast<std::size_t>(Feature::triangles)),
                               .cause = {},
                               .texture_used = std::vector<bool>(scene.textures.size()),
                               .material_used = std::vector<bool>(scene.materials.size())};
    EXPECT_THROW(render(posed, nothing, {}), Error);
}

TEST_F(RasterRequirements, sample_counts_that_are_no_power_of_two_are_refused)
{
    const Scene scene = make_builtin("triangle");
    const PosedScene posed = pose(scene, {.size = kSize});
    RenderSettings settings;
    settings.msaa = 3;
    EXPECT_THROW(render(posed, require(posed, settings), settings), Error);
}

}  // namespace
}  // namespace etalon::test
