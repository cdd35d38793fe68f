#include "engine/measure/diff.h"

#include <algorithm>
#include <cmath>

#include "engine/base/error.h"
#include "engine/image/io.h"

namespace etalon {
namespace {

Film film_of(const Image& image)
{
    Film film;
    film.width = image.width;
    film.height = image.height;
    for (std::size_t i = 0; i < image.pixel_count(); ++i) {
        const float* pixel = &image.values[i * std::size_t(image.channels)];
        const float alpha = image.channels == 4 ? pixel[3] : 1.0f;
        film.mean.push_back(alpha *
                            vec3(pixel[0], pixel[1], pixel[2]));  // a film is premultiplied, these files are not
        film.alpha.push_back(alpha);
    }
    return film;
}

bool equal_within(const Film& a, const Film& b, double rounding)
{
    const auto near = [&](double x, double y) {
        return x == y || std::abs(x - y) <= rounding * std::max(std::abs(x), std::abs(y));
    };
    for (std::size_t i = 0; i < a.mean.size(); ++i)
        for (int c = 0; c < 3; ++c)
            if (!near(a.mean[i][c], b.mean[i][c])) return false;
    for (std::size_t i = 0; i < std::min(a.alpha.size(), b.alpha.size()); ++i)
        if (!near(a.alpha[i], b.alpha[i])) return false;
    return true;
}

}  // namespace

Film load_film(const std::filesystem::path& path)
{
    std::string extension = path.extension().string();
    std::transform(extension.begin(), extension.end(), extension.begin(),
                   [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
    return extension == ".exr" ? read_film(path) : film_of(read_image(path));
}

FileDiff diff_files(const std::filesystem::path& a, const std::filesystem::path& b, const CompareSettings& settings)
{
    FileDiff diff{.a = load_film(a), .b = load_film(b), .comparison = {}};
    try {
        diff.comparison = compare(diff.a, diff.b, settings);
    } catch (Error& error) {
        error.at(b.string()).at(a.string());
        throw;
    }
    if (diff.comparison.verdict == Verdict::not_tested) {
        const bool equal = equal_within(diff.a, diff.b, settings.rounding);
        diff.comparison.verdict = equal ? Verdict::indistinguishable : Verdict::different;
        diff.comparison.reasons.push_back(equal ? "error not measured: every value is equal within rounding"
                                                : "error not measured: the values differ by more than rounding");
    }
    return diff;
}

}  // namespace etalon
