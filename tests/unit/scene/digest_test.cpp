#include "engine/scene/digest.h"

#include <gtest/gtest.h>

#include <set>
#include <vector>

#include "engine/scene/load.h"

namespace etalon {
namespace {

TEST(Digest, a_word_a_bit_and_the_order_count)
{
    const auto of = [](std::initializer_list<std::uint64_t> words) {
        Digest digest;
        for (const std::uint64_t word : words) digest.add(word);
        return digest.value();
    };
    const std::uint64_t top = std::uint64_t{1} << 63;
    const std::set<std::uint64_t> all{of({}),    of({0}), of({0, 0}),     of({1, 0}),   of({0, 1}),
                                      of({top}), of({1}), of({top, top}), of({top, 0}), of({0, top})};
    EXPECT_EQ(all.size(), 10u);
    Digest text, other;
    text.add(std::string_view("etalon render"));
    other.add(std::string_view("etalon rendes"));
    EXPECT_NE(text.value(), other.value());
    EXPECT_EQ(text.text().size(), 16u);
}

/// The posed scene after `change`, fingerprinted.
template <typename Change>
std::uint64_t changed(const Change& change)
{
    Scene scene = make_builtin("maps");
    PosedScene posed = pose(scene);
    change(scene, posed);
    return digest(posed).value();
}

TEST(SceneDigest, is_the_same_twice_and_changes_with_whatever_a_renderer_reads)
{
    const std::uint64_t same = changed([](Scene&, PosedScene&) {});
    EXPECT_EQ(same, changed([](Scene&, PosedScene&) {}));
    EXPECT_EQ(same, changed([](Scene& s, PosedScene& p) {
                  s.name = "other";
                  p.notes.emplace_back("a note");
                  s.materials[0].name = "other";
              }));
    const std::vector<std::uint64_t> all{
        changed([](Scene& s, PosedScene&) { s.meshes[0].primitives[0].positions[0].x += 1e-3f; }),
        changed([](Scene& s, PosedScene&) { s.meshes[0].primitives[0].indices[0] ^= 1; }),
        changed([](Scene& s, PosedScene&) { s.materials[0].roughness += 1e-9; }),
        changed([](Scene& s, PosedScene&) { s.materials[0].layers.emplace(); }),
        changed([](Scene& s, PosedScene&) { s.materials[0].layers.emplace().dispersion = 1; }),
        changed([](Scene& s, PosedScene&) { s.images[0].bytes[5] ^= 1; }),
        changed([](Scene& s, PosedScene&) { s.textures[0].sampler.mipmapped ^= true; }),
        changed([](Scene&, PosedScene& p) { p.view.world_from_camera[3].x += 1e-9; }),
        changed([](Scene&, PosedScene& p) { p.view.width += 1; }),
        changed([](Scene&, PosedScene& p) { p.view.camera.lens.emplace(); }),
        changed([](Scene&, PosedScene& p) { p.draws[0].world_from_object[0].x *= 1.5; }),
        changed([](Scene&, PosedScene& p) { p.spheres.emplace_back(); }),
        changed([](Scene&, PosedScene& p) { p.lights.emplace_back(); }),
        changed([](Scene&, PosedScene& p) { p.environment.scale += 1; }),
    };
    for (std::size_t i = 0; i < all.size(); ++i) EXPECT_NE(all[i], same) << i;
    EXPECT_EQ(std::set(all.begin(), all.end()).size(), all.size());
}

}  // namespace
}  // namespace etalon
