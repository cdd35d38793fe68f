#pragma once
#include <cstddef>
#include <cstring>
#include <span>
#include <string_view>
#include <vector>

#include "engine/image/film.h"
#include "engine/image/post.h"

namespace etalon {

/// Pictures that post passes work on, RGBA float32, all of the film's size.
enum class PostPlane {
    picture,  ///< premultiplied radiance and alpha; holds the film's at the start
    second,   ///< as picture; undefined at the start, as the next two
    third,
    fourth,
    variance,  ///< of the mean, three channels
    variance_second,
    surface,  ///< world space normal and depth
    albedo,
};
inline constexpr std::size_t kPostPlanes = 8;

/// One dispatch. Bindings of set 0: 0 source, 1 result, 2 guide, 3 the albedo, 4 the table, 5 the counts, 6 and 7 the
/// cells, 8 and 9 the variance that is read and written. Storage images all, but 4 to 7, which are storage buffers.
/// Each step sees what the one before it wrote.
struct PostStep {
    std::string_view shader;      ///< below shaders/: "post/sobel.comp"
    std::vector<std::byte> push;  ///< a struct of shaders/shared/post.h
    PostPlane source = PostPlane::picture;
    PostPlane result = PostPlane::second;
    PostPlane guide = PostPlane::surface;
    PostPlane variance_source = PostPlane::variance;
    PostPlane variance_result = PostPlane::variance_second;
    bool cells_swapped = false;  ///< 6 is the second buffer of cells and 7 the first
    bool clears_counts = false;  ///< before it runs
    unsigned invocations[3] = {1, 1, 1};
    unsigned workgroup[3] = {8, 8, 1};
    std::string_view pass;  ///< that it belongs to
};

/// What a device is to do for a chain of passes, whatever the device: steps, and what they read besides the film.
struct PostPlan {
    std::vector<PostStep> steps;
    std::vector<float> table;                  ///< kernels and factors; steps may write it
    std::size_t cells = 0;                     ///< of four floats, in each of two buffers
    bool counts = false;                       ///< kPostBins uints
    bool planes[kPostPlanes] = {};             ///< which exist
    PostPlane picture = PostPlane::picture;    ///< where the result is
    PostPlane variance = PostPlane::variance;  ///< where its variance is, if `keeps_variance`
    bool keeps_variance = false;
};

/// Plans `chain` for `film`. Throws Error(input) where the chain needs AOVs that the film lacks, or a bilateral grid of
/// more than 128 MiB.
PostPlan plan_post(const PostChain& chain, const Film& film);

/// What the planes hold at the start: four floats a pixel.
std::vector<float> post_plane(const Film& film, PostPlane plane);
/// The film with the picture and variance that the plan's planes hold at the end (`variance` empty where it is not
/// kept), and what was done to it in its metadata ("post").
Film post_film(Film film, const PostChain& chain, std::span<const float> picture, std::span<const float> variance);

}  // namespace etalon
