#include "engine/image/post_plan.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "engine/base/error.h"
#include "engine/image/develop.h"
#include "shaders/shared/post.h"

namespace etalon {
namespace {

constexpr std::size_t kMostCells = (std::size_t{128} << 20) / 16;

/// The inverse of a width: of 0 so large that only equals are alike, of Inf 0.
float inverse(double width)
{
    return float(1 / std::max(width, 1e-18));
}

/// Grows a plan, pass by pass.
class Planner {
 public:
    explicit Planner(const Film& film) : size_(film.width, film.height)
    {
        plan_.planes[std::size_t(PostPlane::picture)] = true;
        plan_.keeps_variance = !film.variance.empty();
        if (plan_.keeps_variance) use(PostPlane::variance);
    }

    void add(const PostStage& stage)
    {
        pass_ = stage.pass().name;
        switch (stage.kind) {
            case PostKind::exposure:
                add_exposure(stage);
                break;
            case PostKind::vignette:
                add_scale({.size = size_, .factor = add_table({1}), .falloff = float(stage["strength"])});
                break;
            case PostKind::gaussian:
                add_gaussian(stage["sigma"]);
                break;
            case PostKind::median:
                if (stage["radius"] > 0)
                    filter("post/median.comp", shared::PostMedian{.size = size_, .radius = int(stage["radius"])});
                break;
            case PostKind::bilateral:
                add_bilateral(stage);
                break;
            case PostKind::atrous:
                add_atrous(stage);
                break;
            case PostKind::bloom:
                add_bloom(stage);
                break;
            case PostKind::sobel:
                filter("post/sobel.comp", shared::PostSobel{.size = size_, .gain = float(stage["gain"])});
                break;
            case PostKind::outline:
                use(PostPlane::surface);
                filter("post/outline.comp", shared::PostOutline{.size = size_,
                                                                .inverse_depth = inverse(stage["depth"]),
                                                                .inverse_normal = inverse(stage["normal"]),
                                                                .strength = float(stage["strength"])});
                break;
            case PostKind::fxaa:
                filter("post/fxaa.comp", shared::PostFxaa{.size = size_,
                                                          .threshold = float(stage["threshold"]),
                                                          .least = float(stage["floor"]),
                                                          .subpixel = float(stage["subpixel"]),
                                                          .reach = int(stage["reach"])});
                break;
            case PostKind::tone:
                filter("post/tone.comp", shared::PostTone{.size = size_, .curve = unsigned(stage["curve"])});
                break;
        }
        if (stage.pass().error == PostError::lost) plan_.keeps_variance = false;
    }

    PostPlan take() { return std::move(plan_); }

 private:
    void use(PostPlane plane) { plan_.planes[std::size_t(plane)] = true; }

    unsigned add_table(std::vector<float> values)
    {
        const auto first = unsigned(plan_.table.size());
        plan_.table.insert(plan_.table.end(), values.begin(), values.end());
        return first;
    }

    template <class Push>
    PostStep& step(std::string_view shader, const Push& push)
    {
        PostStep next{.shader = shader, .push = std::vector<std::byte>(sizeof(Push)), .pass = pass_};
        std::memcpy(next.push.data(), &push, sizeof(Push));
        next.invocations[0] = unsigned(size_.x);
        next.invocations[1] = unsigned(size_.y);
        next.source = plan_.picture;
        return plan_.steps.emplace_back(std::move(next));
    }

    PostPlane other() const { return plan_.picture == PostPlane::picture ? PostPlane::second : PostPlane::picture; }

    /// From the picture to the other one, which is the picture from then on.
    template <class Push>
    PostStep& filter(std::string_view shader, const Push& push)
    {
        PostStep& next = step(shader, push);
        next.result = other();
        use(next.result);
        plan_.picture = next.result;
        return next;
    }

    PostPlane other_variance() const
    {
        return plan_.variance == PostPlane::variance ? PostPlane::variance_second : PostPlane::variance;
    }

    void add_scale(shared::PostScale push)
    {
        filter("post/scale.comp", push);
        if (!plan_.keeps_variance) return;
        push.squared = 1;
        PostStep& variance = step("post/scale.comp", push);
        variance.source = plan_.variance;
        variance.result = plan_.variance = other_variance();
        use(plan_.variance);
    }

    void add_exposure(const PostStage& stage)
    {
        const bool automatic = stage.is("ev", "auto");
        const unsigned factor = add_table({automatic ? 1.0f : float(exposure_factor(stage["ev"]))});
        if (automatic) {
            plan_.counts = true;
            const shared::PostMeter push{.size = size_, .factor = factor};
            step("post/histogram.comp", push).clears_counts = true;
            PostStep& meter = step("post/meter.comp", push);
            std::fill(std::begin(meter.invocations), std::end(meter.invocations), 1u);
            std::fill(std::begin(meter.workgroup), std::end(meter.workgroup), 1u);
        }
        add_scale({.size = size_, .factor = factor});
    }

    /// The table of a Gaussian's weights (IP-5), that of distance 0 first; the radius is one less than its size.
    static std::vector<float> gaussian_kernel(double sigma, int radius)
    {
        std::vector<double> weights;
        double sum = 0;
        for (int i = 0; i <= radius; ++i) {
            weights.push_back(std::exp(-0.5 * (i / sigma) * (i / sigma)));
            sum += (i == 0 ? 1 : 2) * weights.back();
        }
        std::vector<float> kernel;
        kernel.reserve(weights.size());
        for (const double weight : weights) kernel.push_back(float(weight / sum));
        return kernel;
    }

    void add_axis(ivec2 axis, int radius, unsigned kernel, PostPlane source, PostPlane result)
    {
        PostStep& next = step("post/gaussian.comp",
                              shared::PostGaussian{.size = size_, .step = axis, .radius = radius, .kernel = kernel});
        next.source = source;
        next.result = result;
        use(result);
    }

    void add_gaussian(double sigma)
    {
        if (sigma < kPostLeastSigma) return;
        const int radius = int(std::ceil(4 * sigma));
        const unsigned kernel = add_table(gaussian_kernel(sigma, radius));
        add_axis(ivec2(1, 0), radius, kernel, plan_.picture, other());
        add_axis(ivec2(0, 1), radius, kernel, other(), plan_.picture);
    }

    void add_bilateral(const PostStage& stage)
    {
        const double sigma_s = stage["sigma_s"], sigma_r = stage["sigma_r"];
        if (sigma_s < kPostLeastSigma || sigma_r == 0) return;
        if (stage.is("method", "grid")) {
            add_grid(sigma_s, sigma_r);
            return;
        }
        const int radius = int(std::ceil(4 * sigma_s));
        shared::PostBilateral push{
            .size = size_, .reach = ivec2(radius), .inverse_s = inverse(sigma_s), .inverse_r = inverse(sigma_r)};
        if (stage.is("method", "exact")) {
            filter("post/bilateral.comp", push);
            return;
        }
        push.reach = ivec2(radius, 0);
        filter("post/bilateral.comp", push);
        push.reach = ivec2(0, radius);
        filter("post/bilateral.comp", push);
    }

    void add_grid(double sigma_s, double sigma_r)
    {
        const double spacing = std::max(sigma_s, 1.0);
        const ivec2 cells(int((size_.x - 1) / spacing) + 2, int((size_.y - 1) / spacing) + 2);
        const std::size_t count = std::size_t(cells.x) * std::size_t(cells.y) * shared::kPostGridLevels;
        if (count > kMostCells)
            throw Error(Blame::input, "--post: the grid of this bilateral filter needs more than 128 MiB",
                        "take a larger sigma_s, a smaller picture or method=separable");
        plan_.cells = std::max(plan_.cells, count);
        // Splatting and reading are tents, of variance 1/6 each: the blur between does the rest of 1.
        const double blur = std::sqrt(2.0 / 3);
        shared::PostGrid push{.size = size_,
                              .cells = cells,
                              .spacing = float(spacing),
                              .inverse_r = inverse(sigma_r / std::sqrt(3.0)),
                              .kernel = add_table(gaussian_kernel(blur, shared::kPostGridRadius))};
        const auto over_cells = [&](PostStep& next, unsigned levels) {
            next.invocations[0] = unsigned(cells.x);
            next.invocations[1] = unsigned(cells.y);
            next.invocations[2] = levels;
        };
        over_cells(step("post/grid_splat.comp", push), 1);
        for (int axis = 0; axis < 3; ++axis) {
            push.axis = axis;
            PostStep& next = step("post/grid_blur.comp", push);
            over_cells(next, shared::kPostGridLevels);
            next.cells_swapped = axis == 1;
        }
        filter("post/grid_slice.comp", push).cells_swapped = true;
    }

    void add_atrous(const PostStage& stage)
    {
        for (const PostPlane plane :
             {PostPlane::surface, PostPlane::albedo, PostPlane::variance, PostPlane::variance_second})
            use(plane);
        const bool guided = plan_.keeps_variance;
        if (guided) {
            PostStep& next = step("post/variance.comp", shared::PostVariance{.size = size_});
            next.source = plan_.variance;
            next.result = plan_.variance = other_variance();
        }
        for (int level = 0; level < int(stage["levels"]); ++level) {
            const double sigma_c = guided ? stage["sigma_c"] : std::ldexp(stage["sigma_c"], -level);
            PostStep& next = filter("post/atrous.comp", shared::PostAtrous{.size = size_,
                                                                           .step = 1 << level,
                                                                           .guided = guided ? 1u : 0u,
                                                                           .inverse_c = inverse(sigma_c),
                                                                           .inverse_n = inverse(stage["sigma_n"]),
                                                                           .inverse_z = inverse(stage["sigma_z"]),
                                                                           .inverse_a = inverse(stage["sigma_a"])});
            next.variance_source = plan_.variance;
            next.variance_result = plan_.variance = other_variance();
        }
    }

    void add_bloom(const PostStage& stage)
    {
        if (stage["strength"] == 0) return;
        const int levels = int(stage["levels"]);
        const shared::PostBloom push{
            .size = size_, .threshold = float(stage["threshold"]), .share = float(stage["strength"] / levels)};
        const PostPlane bright = other(), blurred = PostPlane::third, between = PostPlane::fourth;
        step("post/bright.comp", push).result = bright;
        use(bright);
        for (int level = 0; level < levels; ++level) {
            const double sigma = std::min(std::ldexp(stage["sigma"], level), 1000.0);
            if (sigma < kPostLeastSigma) continue;
            const int radius = int(std::ceil(4 * sigma));
            const unsigned kernel = add_table(gaussian_kernel(sigma, radius));
            add_axis(ivec2(1, 0), radius, kernel, bright, between);
            add_axis(ivec2(0, 1), radius, kernel, between, blurred);
            PostStep& next = step("post/scatter.comp", push);
            next.source = blurred;
            next.guide = bright;
            next.result = plan_.picture;
        }
    }

    ivec2 size_;
    PostPlan plan_;
    std::string_view pass_;
};

void need_aovs(const PostChain& chain, const Film& film)
{
    if (!film.aovs.empty()) return;
    for (const PostStage& stage : chain)
        if (stage.pass().aovs)
            throw Error(Blame::input,
                        "--post: " + std::string(stage.pass().name) +
                            " reads depth, normal and albedo, "
                            "which this film does not hold",
                        "render it with --aovs");
}

}  // namespace

PostPlan plan_post(const PostChain& chain, const Film& film)
{
    assume(film.width > 0 && film.height > 0);
    need_aovs(chain, film);
    Planner planner(film);
    for (const PostStage& stage : chain) planner.add(stage);
    return planner.take();
}

std::vector<float> post_plane(const Film& film, PostPlane plane)
{
    std::vector<float> texels(4 * film.pixel_count(), 0.0f);
    const Aovs& aovs = film.aovs;
    for (std::size_t i = 0; i < film.pixel_count(); ++i) {
        float* texel = &texels[4 * i];
        const auto put = [&](const vec3& value, float last) {
            for (int c = 0; c < 3; ++c) texel[c] = value[c];
            texel[3] = last;
        };
        switch (plane) {
            case PostPlane::picture:
                put(film.mean[i], film.alpha[i]);
                break;
            case PostPlane::variance:
                if (!film.variance.empty()) put(film.variance[i], 0);
                break;
            case PostPlane::surface:
                put(aovs.normal[i], aovs.depth[i]);
                break;
            case PostPlane::albedo:
                put(aovs.albedo[i], 0);
                break;
            default:
                break;
        }
    }
    return texels;
}

Film post_film(Film film, const PostChain& chain, std::span<const float> picture, std::span<const float> variance)
{
    assume(picture.size() == 4 * film.pixel_count() && (variance.empty() || variance.size() == picture.size()));
    film.variance.resize(variance.empty() ? 0 : film.pixel_count());
    for (std::size_t i = 0; i < film.pixel_count(); ++i) {
        film.mean[i] = vec3(picture[4 * i], picture[4 * i + 1], picture[4 * i + 2]);
        film.alpha[i] = picture[4 * i + 3];
        if (!variance.empty()) film.variance[i] = vec3(variance[4 * i], variance[4 * i + 1], variance[4 * i + 2]);
    }
    film.metadata["post"] = describe(chain);
    return film;
}

}  // namespace etalon
