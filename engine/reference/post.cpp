#include "engine/reference/post.h"

#include <algorithm>
#include <cmath>

#include "engine/base/error.h"
#include "engine/base/parallel.h"
#include "engine/image/develop.h"
#include "engine/reference/post_parts.h"

namespace etalon::reference {
namespace {

PostPicture picture_of(const Film& film, unsigned threads)
{
    PostPicture picture{.width = film.width,
                        .height = film.height,
                        .pixels = {},
                        .variance = {film.variance.begin(), film.variance.end()},
                        .aovs = &film.aovs,
                        .threads = threads};
    picture.pixels.reserve(film.pixel_count());
    for (std::size_t i = 0; i < film.pixel_count(); ++i)
        picture.pixels.emplace_back(dvec3(film.mean[i]), double(film.alpha[i]));
    return picture;
}

void put_back(const PostPicture& picture, Film& film)
{
    for (std::size_t i = 0; i < film.pixel_count(); ++i) {
        film.mean[i] = vec3(dvec3(picture.pixels[i]));
        film.alpha[i] = float(picture.pixels[i].w);
    }
    film.variance.assign(picture.variance.begin(), picture.variance.end());
}

/// Multiplies the light at each pixel, and its variance by the square. Values that are not finite stay so by
/// themselves.
void scale(PostPicture& picture, const std::function<double(int x, int y)>& factor)
{
    for (int y = 0; y < picture.height; ++y)
        for (int x = 0; x < picture.width; ++x) {
            const double f = factor(x, y);
            dvec4& pixel = picture.own(x, y);
            pixel = dvec4(dvec3(pixel) * f, pixel.w);
            if (!picture.variance.empty()) picture.variance[picture.index(x, y)] *= f * f;
        }
}

/// (IP-3)
double exposure_of(const PostPicture& picture, const PostStage& stage)
{
    if (!stage.is("ev", "auto")) return exposure_factor(stage["ev"]);
    Film film{.width = picture.width, .height = picture.height};
    film.mean.resize(film.pixel_count());
    film.alpha.resize(film.pixel_count());
    put_back(picture, film);
    return exposure_factor(automatic_exposure(film));
}

/// (IP-4)
double vignette_at(const PostPicture& picture, double strength, int x, int y)
{
    const double w = picture.width, h = picture.height;
    const double dx = 2 * x + 1 - w, dy = 2 * y + 1 - h;
    const double tangent2 = strength * (dx * dx + dy * dy) / (w * w + h * h);
    const double cosine2 = 1 / (1 + tangent2);
    return cosine2 * cosine2;
}

/// (IP-15)
void tone(PostPicture& picture, Tone curve)
{
    replace_each(picture, [&](const PostPicture& from, int x, int y) {
        const dvec4& pixel = from.at(x, y);
        const double coverage = pixel.w > 0 ? std::min(pixel.w, 1.0) : 1;
        const dvec3 exposed = glm::clamp(dvec3(pixel) / coverage, dvec3(0), dvec3(1e37));
        return dvec4(coverage * glm::clamp(apply_tone(curve, exposed), dvec3(0), dvec3(1)), pixel.w);
    });
}

void apply(PostPicture& picture, const PostStage& stage)
{
    switch (stage.kind) {
        case PostKind::exposure: {
            const double factor = exposure_of(picture, stage);
            return scale(picture, [&](int, int) { return factor; });
        }
        case PostKind::vignette:
            return scale(picture, [&](int x, int y) { return vignette_at(picture, stage["strength"], x, y); });
        case PostKind::gaussian:
            return gaussian(picture, stage["sigma"]);
        case PostKind::median:
            return median(picture, int(stage["radius"]));
        case PostKind::bilateral:
            return bilateral(picture, stage);
        case PostKind::atrous:
            return atrous(picture, stage);
        case PostKind::bloom:
            return bloom(picture, stage);
        case PostKind::sobel:
            return sobel(picture, stage["gain"]);
        case PostKind::outline:
            return outline(picture, stage);
        case PostKind::fxaa:
            return fxaa(picture, stage);
        case PostKind::tone:
            return tone(picture, Tone(int(stage["curve"])));
    }
}

}  // namespace

std::size_t PostPicture::nearest(int x, int y) const
{
    return index(std::clamp(x, 0, width - 1), std::clamp(y, 0, height - 1));
}

bool is_finite(const dvec4& pixel)
{
    return etalon::is_finite(dvec3(pixel)) && std::isfinite(pixel.w);
}

double luminance(const dvec4& pixel)
{
    return 0.2126 * pixel.x + 0.7152 * pixel.y + 0.0722 * pixel.z;
}

void replace_each(PostPicture& picture, const PixelRule& value)
{
    const PostPicture from = picture;
    parallel_for(
        std::size_t(picture.height),
        [&](std::size_t row) {
            const int y = int(row);
            for (int x = 0; x < picture.width; ++x)
                if (is_finite(from.at(x, y))) picture.own(x, y) = value(from, x, y);
        },
        picture.threads);
}

Film apply_post(Film film, const PostChain& chain, unsigned threads)
{
    assume(film.width > 0 && film.height > 0);
    if (needs_aovs(chain) && film.aovs.empty())
        throw Error(Blame::input, "--post: a pass reads depth, normal and albedo, which this film does not hold",
                    "render it with --aovs");
    PostPicture picture = picture_of(film, threads);
    for (const PostStage& stage : chain) {
        apply(picture, stage);
        if (stage.pass().error == PostError::lost) picture.variance.clear();
    }
    put_back(picture, film);
    film.metadata["post"] = describe(chain);
    return film;
}

}  // namespace etalon::reference
