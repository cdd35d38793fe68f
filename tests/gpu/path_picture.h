#pragma once
// What tests of whole pictures share: rendering a scene of a few lines, and means with their standard errors.
// Statistical comparisons use fixed seeds and five standard errors: a false alarm in two million.
#include <cmath>
#include <cstring>

#include "engine/render/path.h"
#include "engine/render/render.h"
#include "engine/scene/builder.h"
#include "engine/scene/load.h"
#include "tests/gpu/device_test.h"

namespace etalon::test {

struct Measured {
    dvec3 mean{0};
    dvec3 error{0};  ///< standard error of the mean
};

/// Of the whole picture, or of the pixels where choose(x, y).
template <class Choose>
Measured measure(const Film& film, const Choose& choose)
{
    Measured out;
    dvec3 variance(0);
    double count = 0;
    for (int y = 0; y < film.height; ++y)
        for (int x = 0; x < film.width; ++x) {
            if (!choose(x, y)) continue;
            const auto i = std::size_t(y) * std::size_t(film.width) + std::size_t(x);
            out.mean += dvec3(film.mean[i]);
            if (!film.variance.empty()) variance += dvec3(film.variance[i]);
            ++count;
        }
    out.mean /= count;
    out.error = glm::sqrt(variance) / count;
    return out;
}
inline Measured measure(const Film& film)
{
    return measure(film, [](int, int) { return true; });
}

inline void expect_equal(const Measured& a, const Measured& b, const char* why)
{
    for (int c = 0; c < 3; ++c)
        EXPECT_NEAR(a.mean[c], b.mean[c], 5 * std::hypot(a.error[c], b.error[c]) + 2e-6 * b.mean[c])
            << why << ", channel " << c;
}

inline bool same_film(const Film& a, const Film& b)
{
    return a.mean.size() == b.mean.size() &&
           std::memcmp(a.mean.data(), b.mean.data(), a.mean.size() * sizeof(vec3)) == 0 &&
           a.variance.size() == b.variance.size() &&
           std::memcmp(a.variance.data(), b.variance.data(), a.variance.size() * sizeof(vec3)) == 0 &&
           a.alpha == b.alpha;
}

class PathPicture : public DeviceTest {
 protected:
    RenderSettings settings(std::uint64_t spp = 64)
    {
        RenderSettings out;
        out.renderer = Renderer::path;
        out.spp = spp;
        return out;
    }
    Film render(const Scene& scene, const RenderSettings& how, ivec2 size = ivec2(16))
    {
        PoseSettings pose_settings;
        pose_settings.size = size;
        const PosedScene posed = pose(scene, pose_settings);
        return render_path(device(), posed, require(posed, how), how, {});
    }
};

inline Environment constant_sky(double radiance)
{
    Environment out;
    out.radiance = dvec3(radiance);
    return out;
}

/// A floor of 20 m at y = 0, seen from straight enough above that nothing else is in the picture.
inline SceneBuilder above_floor(Index (*material)(SceneBuilder&), double scale = 1)
{
    SceneBuilder b("floor");
    b.show("floor", make_rectangle(dvec3(0), scale * dvec3(10, 0, 0), scale * dvec3(0, 0, -10)), material(b));
    b.camera("above", 20, scale * dvec3(0, 5, 2), dvec3(0));
    return b;
}
inline Index half_grey(SceneBuilder& b)
{
    return b.lambert("grey", dvec3(0.5));
}

}  // namespace etalon::test
