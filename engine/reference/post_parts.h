#pragma once
// The parts of engine/reference/post.h that have a file of their own.
#include <functional>
#include <vector>

#include "engine/image/film.h"
#include "engine/image/post.h"
#include "engine/math/types.h"

namespace etalon::reference {

/// What passes work on, in double: premultiplied radiance and alpha.
struct PostPicture {
    int width = 0;
    int height = 0;
    std::vector<dvec4> pixels;
    std::vector<dvec3> variance;  ///< of the mean; empty: none, or no longer known
    const Aovs* aovs = nullptr;   ///< those of the film
    unsigned threads = 0;

    std::size_t index(int x, int y) const { return std::size_t(y) * std::size_t(width) + std::size_t(x); }
    /// The place of the nearest pixel of the picture (IP-1).
    std::size_t nearest(int x, int y) const;
    const dvec4& at(int x, int y) const { return pixels[nearest(x, y)]; }
    dvec4& own(int x, int y) { return pixels[index(x, y)]; }
};

bool is_finite(const dvec4& pixel);
/// (IP-2)
double luminance(const dvec4& pixel);

/// What `value(x, y)` says, of every pixel that is finite; the others stay (IP-1).
using PixelRule = std::function<dvec4(const PostPicture& from, int x, int y)>;
void replace_each(PostPicture& picture, const PixelRule& value);

void gaussian(PostPicture& picture, double sigma);                          ///< (IP-5)
void median(PostPicture& picture, int radius);                              ///< (IP-6)
void bilateral(PostPicture& picture, const PostStage& stage);               ///< (IP-7), (IP-8), (IP-9)
void bilateral_grid(PostPicture& picture, double sigma_s, double sigma_r);  ///< (IP-9)
void atrous(PostPicture& picture, const PostStage& stage);                  ///< (IP-10)
void bloom(PostPicture& picture, const PostStage& stage);                   ///< (IP-11)
void sobel(PostPicture& picture, double gain);                              ///< (IP-12)
void outline(PostPicture& picture, const PostStage& stage);                 ///< (IP-13)
void fxaa(PostPicture& picture, const PostStage& stage);                    ///< (IP-14)

}  // namespace etalon::reference
