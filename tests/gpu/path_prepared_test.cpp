// Scenes that stay on the device between pictures: the same bits as pictures made from nothing.
#include "engine/render/prepared.h"

#include "engine/render/render.h"
#include "tests/gpu/path_picture.h"

namespace etalon::test {
namespace {

class Prepared : public DeviceTest {
 protected:
    Prepared() : scene_(make_builtin("texture-plane")), posed_(pose(scene_, {.size = ivec2(24, 16)})) {}

    Film from_nothing(const RenderSettings& settings)
    {
        const Requirements required = require(posed_, settings);
        return settings.renderer == Renderer::path ? render_path(device(), posed_, required, settings, {})
                                                   : render_raster(device(), posed_, required, settings, {});
    }

    const Scene scene_;
    const PosedScene posed_;
};

TEST_F(Prepared, pictures_are_those_made_from_nothing_whatever_was_drawn_before)
{
    RenderSettings path{.renderer = Renderer::path, .spp = 3, .seed = 5};
    RenderSettings more = path, other = path, shallow = path;
    more.spp = 9;
    other.seed = (std::uint64_t{1} << 40) + 6;
    shallow.max_depth = 2;
    const RenderSettings raster{};
    RenderSettings single = raster;
    single.msaa = 1;
    std::vector<Film> expected;
    const std::vector<RenderSettings> all = {path, more, raster, other, single, shallow, path, raster};
    for (const RenderSettings& settings : all) expected.push_back(from_nothing(settings));

    PreparedScene prepared(device(), posed_, 8);
    for (std::size_t i = 0; i < all.size(); ++i) {
        const Film film = prepared.draw(all[i], {});
        EXPECT_EQ(film.mean, expected[i].mean) << i;
        EXPECT_EQ(film.variance, expected[i].variance) << i;
        EXPECT_EQ(film.samples, expected[i].samples) << i;
    }
    EXPECT_EQ(prepared.size(), 4u) << "samples and seeds need nothing of their own";
}

TEST_F(Prepared, those_unused_for_longest_go)
{
    PreparedScene prepared(device(), posed_, 1);
    const RenderSettings raster{};
    const Film first = prepared.draw(raster, {});
    prepared.draw({.renderer = Renderer::path, .spp = 1}, {});
    EXPECT_EQ(prepared.size(), 1u);
    EXPECT_EQ(prepared.draw(raster, {}).mean, first.mean);
}

}  // namespace
}  // namespace etalon::test
