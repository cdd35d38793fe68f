#pragma once
#include <array>
#include <map>
#include <utility>
#include <vector>

#include "engine/scene/scene.h"
#include "engine/scene/settings.h"

namespace etalon::reference {

/// How a texel's colour is coded; alpha is linear always. (TX-5) normal: a unit vector, for rasterizers (TX-7).
enum class Coding { linear, srgb, normal };

/// Where a texture is read: the vertex uv sets, and how they change to the next pixel in x and y (zero: level 0).
struct TexturePoint {
    std::array<dvec2, 2> uv{};
    std::array<dvec2, 2> uv_dx{};
    std::array<dvec2, 2> uv_dy{};
    bool has_footprint = false;  ///< false: level 0 with the magnification filter, as path tracers read (SH-5)
};

/// An image in linear light with its box-filtered levels; each half the size of the one above, rounded down, at
/// least 1. Level 0 is decoded as it is read.
class MipChain {
 public:
    MipChain(const Texels& texels, Coding coding, bool all_levels);
    int levels() const { return 1 + static_cast<int>(coarser_.size()); }
    ivec2 size(int level) const;
    dvec4 texel(int level, int x, int y) const;  ///< x, y inside the level

 private:
    struct Level {
        ivec2 size{0};
        std::vector<dvec4> texels;
    };
    const Texels* texels_;
    Coding coding_;
    std::vector<Level> coarser_;
};

/// One row or column of `count` values averaged into `target` values, each the exact mean of the stretch that it
/// covers: for odd counts the polyphase weights of (TX-4), promise T8; for any counts (SH-41).
struct BoxWeights {
    struct Tap {
        int index;
        double weight;
    };
    std::vector<std::vector<Tap>> taps;  ///< of each target; weights add up to 1
};
BoxWeights box_weights(int count, int target);

/// Index of the texel that coordinate `i` (any integer) means in a row of `size` texels. Promise T5.
int wrap_texel(long long i, int size, Wrap wrap);

/// (TX-1), (TX-2) without the clamp from above: log2 of the longer side of the footprint, in texels; 0 where that is
/// below one texel or zero. Not finite: the coarsest level (promise T1).
double mip_level(const dvec2& texels_dx, const dvec2& texels_dy, int levels);

/// Where an anisotropic look-up reads (TX-6): `count` times along `axis`, the longer side of the footprint.
struct Probes {
    int count = 1;
    dvec2 axis{0};  ///< texels
};
Probes probes_along(const dvec2& texels_dx, const dvec2& texels_dy, int most);

/// A mip chain at `uv` (texture coordinates), at a level as mip_level gives it; 0 and below magnifies. (TX-2), (TX-3).
dvec4 sample_mips(const MipChain& mips, const Sampler& sampler, const dvec2& uv, double level);

/// Every texture that a scene's materials use, decoded once.
class TextureSet {
 public:
    /// `used`: per Scene::textures (empty: all). `mipmaps`: build the levels below 0, for rasterizers.
    TextureSet(const Scene& scene, const std::vector<bool>& used, bool mipmaps);
    TextureSet(const TextureSet&) = delete;
    TextureSet& operator=(const TextureSet&) = delete;

    /// How rasterizers read from now on: by another filter than the samplers', with up to so many probes (TX-6).
    void read_by(TextureFilter filter, int most_probes);

    /// The texture of `use` at `at`; (1, 1, 1, 1) where there is none.
    dvec4 sample(const TextureUse& use, Coding coding, const TexturePoint& at) const;
    /// The level at which that would be read without probes (TX-2); 0 where there is no texture or no footprint.
    double level(const TextureUse& use, Coding coding, const TexturePoint& at) const;

 private:
    const Scene* scene_;
    TextureFilter filter_ = TextureFilter::file;
    int most_probes_ = 1;
    std::map<std::pair<Index, Coding>, MipChain> chains_;  // by image
    std::vector<std::array<const MipChain*, 3>> by_texture_;
};

}  // namespace etalon::reference
