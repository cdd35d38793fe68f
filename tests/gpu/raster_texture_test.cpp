#include <cmath>
#include <iostream>

#include "engine/image/develop.h"
#include "engine/render/albedo.h"
#include "engine/scene/load.h"
#include "tests/gpu/raster_stage.h"

namespace etalon::test {
namespace {

using Texel = std::array<std::uint8_t, 4>;

class RasterTexture : public DeviceTest {
 protected:
    /// A textured unlit wall whose uv runs over `span` per picture width from 0, drawn at `size` pixels a side.
    template <class Texels>
    Film textured(int width, int height, Sampler sampler, Texels texels, dvec2 span, int size,
                  const dmat3& transform = dmat3(1), const RenderSettings& settings = {})
    {
        SceneBuilder scene("textured");
        Material material = unlit(dvec4(1));
        material.base_color_texture = scene.texture("texture", width, height, sampler, texels);
        material.base_color_texture.transform = transform;
        Primitive primitive = make_rectangle({0, 0, 0}, {1, 0, 0}, {0, 1, 0});
        for (vec2& uv : primitive.uv[0]) uv *= vec2(span);
        scene.show("wall", primitive, scene.material(material));
        return draw(device(), std::move(scene), settings, {size, size});
    }
};

Sampler filtered(Filter filter, Wrap wrap = Wrap::repeat)
{
    return {.wrap_u = wrap, .wrap_v = wrap, .mag = filter, .min = filter, .mip = filter, .mipmapped = false};
}

TEST_F(RasterTexture, T10_every_srgb_code_is_decoded_to_linear_light)
{
    const Film film = textured(
        16, 16, filtered(Filter::nearest),
        [](int x, int y) {
            return Texel{std::uint8_t(y * 16 + x), 0, 128, 255};
        },
        {1, 1}, 16);
    for (std::size_t code = 0; code < 256; ++code)
        EXPECT_NEAR(film.mean[code].x, linear_from_srgb(double(code) / 255), 8e-6)
            << code;  // half of 2⁻¹⁶, and rounding
}

TEST_F(RasterTexture, nearest_texels_repeat_mirror_or_clamp)
{
    const auto ramp = [](int x, int) { return Texel{0, std::uint8_t(x == 0 ? 0 : x == 1 ? 255 : 188), 0, 255}; };
    const std::array<double, 3> values{0, 1, linear_from_srgb(188.0 / 255)};
    struct Case {
        Wrap wrap;
        std::array<int, 9> texels;  // over u = -1 … 2
    };
    for (const Case& c :
         {Case{Wrap::repeat, {0, 1, 2, 0, 1, 2, 0, 1, 2}}, Case{Wrap::mirrored_repeat, {2, 1, 0, 0, 1, 2, 2, 1, 0}},
          Case{Wrap::clamp_to_edge, {0, 0, 0, 0, 1, 2, 2, 2, 2}}}) {
        dmat3 shift(1);
        shift[2] = dvec3(-1, 0, 1);
        const Film film = textured(3, 1, filtered(Filter::nearest, c.wrap), ramp, {3, 1}, 9, shift);
        for (std::size_t x = 0; x < 9; ++x)
            EXPECT_NEAR(film.mean[4 * 9 + x].y, values[static_cast<std::size_t>(c.texels[x])], 1e-5) << x;
    }
}

TEST_F(RasterTexture, T3_linear_filtering_weighs_by_distance_within_the_devices_subtexel_precision)
{
    // Texels 0 and 1 in linear light; magnified 64 times, wrapped round.
    const Film film = textured(
        2, 1, filtered(Filter::linear),
        [](int x, int) {
            return Texel{0, std::uint8_t(x * 255), 0, 255};
        },
        {1, 1}, 128);
    const double precision = std::ldexp(0.5, -int(device().limits().subtexel_bits)) + 1e-5;
    for (int x = 0; x < 128; ++x) {
        const double position = (x + 0.5) / 64 - 0.5;  // texel 0 is centred at 0, texel 1 at 1
        const double expected = position < 0 ? -position : position <= 1 ? position : 2 - position;
        EXPECT_NEAR(film.mean[static_cast<std::size_t>(64 * 128 + x)].y, expected, precision) << x;
    }
}

TEST_F(RasterTexture, T2_one_texel_a_pixel_reads_level_0_and_each_doubling_the_next)
{
    // Level 0 alternates black and white; every level below is 1/2.
    Sampler mipmapped{.mip = Filter::linear};
    const auto stripes = [](int x, int) { return Texel{std::uint8_t((x & 1) * 255), 0, 0, 255}; };
    const Film exact = textured(16, 16, mipmapped, stripes, {1, 1}, 16);
    for (std::size_t x = 0; x < 16; ++x) EXPECT_NEAR(exact.mean[x].x, double(x & 1), 1e-5);
    const Film halved = textured(16, 16, mipmapped, stripes, {2, 2}, 16);
    for (const vec3& pixel : halved.mean) EXPECT_NEAR(pixel.x, 0.5, 1e-5);
    RenderSettings level0;
    level0.mipmaps = false;
    // Two texels a pixel: bilinear between them is 1/2 as well, three texels a pixel are not.
    const Film without = textured(16, 16, mipmapped, stripes, {3, 3}, 16, dmat3(1), level0);
    EXPECT_NEAR(without.mean[0].x, 1, 1e-5);
    EXPECT_NEAR(without.mean[1].x, 0, 1e-5);
}

TEST_F(RasterTexture, T3_trilinear_is_linear_in_the_level)
{
    // Quadrants 8 texels wide: levels 1 … 3 keep them, level 4 is their mean. At the centre of a quadrant the footprint
    // of 2^(3 + f) texels blends f of the mean.
    const auto quadrants = [](int x, int y) { return Texel{std::uint8_t((x < 8) == (y < 8) ? 255 : 0), 0, 0, 255}; };
    const double step = std::exp2(-int(device().limits().mip_bits));
    for (const double fraction : {0.25, 0.5, 0.75}) {
        const double texels = std::exp2(3 + fraction);
        dmat3 center(1);
        center[2] = dvec3(0.25 - texels / 16 / 2, 0.25 - texels / 16 / 2, 1);
        const Film film = textured(16, 16, Sampler{}, quadrants, dvec2(texels / 16), 1, center);
        EXPECT_NEAR(film.mean[0].x, 1 - fraction * 0.5, 0.5 * step + 1e-3) << fraction;
    }
}

/// A checkered plane to the horizon at 64×48.
Film plane(gpu::Device& device, const RenderSettings& settings)
{
    const Scene scene = make_builtin("texture-plane");
    const PosedScene posed = pose(scene, {.size = ivec2(64, 48)});
    return render_raster(device, posed, require(posed, settings), settings, {});
}

double rms(const Film& a, const Film& b)
{
    double sum = 0;
    for (std::size_t i = 0; i < a.pixel_count(); ++i) {
        const dvec3 d = dvec3(a.mean[i]) - dvec3(b.mean[i]);
        sum += dot(d, d);
    }
    return std::sqrt(sum / double(3 * a.pixel_count()));
}

TEST_F(RasterTexture, TX_6_more_probes_bring_a_slanted_texture_nearer_to_what_supersampling_shows)
{
    RenderSettings settings;
    settings.mipmaps = false;
    settings.msaa = 1;
    settings.ssaa = 16;
    const Film truth = plane(device(), settings);
    double last = 1;
    for (const int probes : {1, 4, 16}) {
        RenderSettings few;
        few.anisotropy = probes;
        const double error = rms(plane(device(), few), truth);
        std::cout << probes << " probes: error " << error << std::endl;
        EXPECT_LT(error, probes == 16 ? last : 0.8 * last);  // few pixels of this view are slanted more than 4 : 1
        last = error;
    }
}

TEST_F(RasterTexture, a_filter_for_all_textures_replaces_their_own)
{
    // Two texels, drawn 8 times as large: blocks by nearest, ramps by the others, whatever the sampler says.
    const auto texel = [](int x, int) { return Texel{std::uint8_t(x * 255), 0, 0, 255}; };
    for (const Filter own : {Filter::nearest, Filter::linear})
        for (const TextureFilter filter : {TextureFilter::nearest, TextureFilter::bilinear, TextureFilter::trilinear}) {
            RenderSettings settings;
            settings.texture_filter = filter;
            const Film film = textured(2, 1, filtered(own), texel, {1, 1}, 16, dmat3(1), settings);
            std::size_t between = 0;
            for (std::size_t x = 0; x < 16; ++x) {
                const float value = film.mean[8 * 16 + x].x;
                between += value > 0.01f && value < 0.99f;
            }
            EXPECT_EQ(between, filter == TextureFilter::nearest ? 0u : 16u) << int(own) << ' ' << int(filter);
        }
}

TEST_F(RasterTexture, T8_odd_sizes_keep_their_mean)
{
    // 5×1: the 1×1 level is the exact mean.
    const Film film = textured(
        5, 1, Sampler{},
        [](int x, int) {
            return Texel{std::uint8_t(x == 4 ? 255 : 0), 0, 0, 255};
        },
        {64, 64}, 4);
    for (const vec3& pixel : film.mean) EXPECT_NEAR(pixel.x, 0.2, 1e-4);
}

TEST_F(RasterTexture, a_texture_transform_and_the_second_uv_set_move_what_is_read)
{
    const auto codes = [](int x, int y) { return Texel{std::uint8_t(x * 60), std::uint8_t(y * 60), 0, 255}; };
    // Rotated by a quarter turn and shifted: uv' = (v, 1 - u) has rows (0, 1, 0) and (-1, 0, 1).
    dmat3 turn(0);
    turn[0] = dvec3(0, -1, 0);
    turn[1] = dvec3(1, 0, 0);
    turn[2] = dvec3(0, 1, 1);
    const Film film = textured(4, 4, filtered(Filter::nearest), codes, {1, 1}, 4, turn);
    for (int y = 0; y < 4; ++y)
        for (int x = 0; x < 4; ++x) {
            EXPECT_NEAR(film.mean[static_cast<std::size_t>(y * 4 + x)].x, linear_from_srgb(y * 60 / 255.0), 1e-5);
            EXPECT_NEAR(film.mean[static_cast<std::size_t>(y * 4 + x)].y, linear_from_srgb((3 - x) * 60 / 255.0), 1e-5);
        }
    SceneBuilder scene("uv1");
    Material material = unlit(dvec4(1));
    material.base_color_texture = scene.texture("texture", 4, 4, filtered(Filter::nearest), codes);
    material.base_color_texture.uv_set = 1;
    Primitive primitive = make_rectangle({0, 0, 0}, {1, 0, 0}, {0, 1, 0});
    for (const vec2& uv : primitive.uv[0]) primitive.uv[1].emplace_back(uv.y, uv.x);
    scene.show("wall", primitive, scene.material(material));
    const Film swapped = draw(device(), std::move(scene), {}, {4, 4});
    for (int y = 0; y < 4; ++y)
        for (int x = 0; x < 4; ++x)
            EXPECT_NEAR(swapped.mean[static_cast<std::size_t>(y * 4 + x)].x, linear_from_srgb(y * 60 / 255.0), 1e-5);
}

TEST_F(RasterTexture, textures_of_each_use_are_read_from_their_channels)
{
    SceneBuilder scene("channels");
    Material material;
    material.emission = dvec3(2, 1, 1);
    const auto solid = [&](Texel texel) { return scene.texture("solid", 1, 1, {}, [=](int, int) { return texel; }); };
    material.base_color_texture = solid({255, 0, 0, 255});
    material.metallic_roughness_texture = solid({9, 255, 0, 9});  // roughness 1, metallic 0
    material.emissive_texture = solid({0, 255, 188, 255});
    scene.show("wall", wall(), scene.material(material));
    scene.light(directional(dvec3(1), kPi), dmat4(1));
    const vec3 found = center(draw(device(), std::move(scene)));
    const double e = ggx_albedo(1, 1);
    const double specular = 0.04 / 4 * (1 + 0.04 * (1 - e) / e);  // (SH-53)
    expect_radiance(found, dvec3(0.96 + specular, 1 + specular, linear_from_srgb(188.0 / 255) + specular), 5e-5);
}

TEST_F(RasterTexture, SH40_the_environment_is_seen_where_its_texels_lie)
{
    // 4×2 texels of one colour each; looking along +X shows the boundary of columns 0 and 1, a quarter in.
    Environment environment;
    Image map(4, 2, 3);
    for (int x = 0; x < 4; ++x)
        for (int y = 0; y < 2; ++y) {
            map.at(x, y, 0) = float(x);
            map.at(x, y, 1) = float(y);
        }
    environment.map = std::make_shared<const Image>(map);
    environment.scale = 2;
    const auto look = [&](dvec3 target, double rotation) {
        environment.rotation = rotation;
        SceneBuilder scene("sky");
        scene.environment(environment);
        scene.camera("eye", 1, {0, 0, 0}, target);
        const Scene built = std::move(scene).finish();
        const PosedScene posed = pose(built, {.size = ivec2(3, 3)});
        return render_raster(device(), posed, require(posed, {}), {}, {}).mean[4];
    };
    EXPECT_NEAR(look({1, 0, 0}, 0).x, 2 * 0.5, 1e-4);        // u = 1/4: between texels 0 and 1
    EXPECT_NEAR(look({0, 0, 1}, 0).x, 2 * 1.5, 1e-4);        // u = 1/2
    EXPECT_NEAR(look({-1, 0, 0}, 0).x, 2 * 2.5, 1e-4);       // u = 3/4
    EXPECT_NEAR(look({0, 0, -1}, 0).x, 2 * 1.5, 1e-4);       // u = 0: between texels 3 and 0
    EXPECT_NEAR(look({1, 0, -1}, 0).x, 0, 1e-4);             // u = 1/8: texel 0
    EXPECT_NEAR(look({1, 0, 0}, kPi / 2).x, 2 * 1.5, 1e-4);  // R_y(-90°) takes +X to +Z
    EXPECT_NEAR(look({1, 0, 0}, 0).y, 2 * 0.5, 1e-4);        // the horizon is between the rows
    EXPECT_NEAR(look({1, 1.0001, 0}, 0).y, 0, 1e-3);         // 45° up: the centre of the upper row
}

}  // namespace
}  // namespace etalon::test
