// Post passes on the device against the same in double: every pass within a stated bound, at every end of its
// parameters, and on pictures of every nastiness.
#include <cmath>

#include "engine/image/post.h"
#include "engine/reference/post.h"
#include "engine/render/post.h"
#include "tests/agree/post_pictures.h"
#include "tests/gpu/device_test.h"
#include "tests/support/ulp.h"

namespace etalon::test {
namespace {

using Post = DeviceTest;

constexpr double kU = 1.0 / (1 << 24);

bool finite(const vec3& c, float alpha)
{
    return is_finite(dvec3(c)) && std::isfinite(alpha);
}

/// The largest difference of two films in units of u times the brightest value of the film that they were made from.
double disagreement(const Film& from, const Film& a, const Film& b)
{
    double most = 1, worst = 0;  // alpha goes to 1
    for (const vec3& c : from.mean)
        for (int i = 0; i < 3; ++i)
            if (std::isfinite(c[i])) most = std::max(most, double(std::abs(c[i])));
    for (std::size_t i = 0; i < a.pixel_count(); ++i) {
        EXPECT_EQ(finite(a.mean[i], a.alpha[i]), finite(b.mean[i], b.alpha[i])) << "pixel " << i;
        if (!finite(a.mean[i], a.alpha[i]) || !finite(b.mean[i], b.alpha[i])) continue;
        for (int c = 0; c < 3; ++c) worst = std::max(worst, std::abs(double(a.mean[i][c]) - double(b.mean[i][c])));
        worst = std::max(worst, std::abs(double(a.alpha[i]) - double(b.alpha[i])));
    }
    return worst / (kU * most);
}

/// What both make of a film with one chain.
struct Pair {
    Film device;
    Film reference;
};
Pair both(gpu::Device& device, const Film& film, const std::string& chain)
{
    const PostChain parsed = parse_post(chain);
    return {apply_post(device, film, parsed), reference::apply_post(film, parsed)};
}

struct Case {
    const char* chain;
    double bound;  ///< in u times the brightest value
    const char* why;
};

// n taps; x an exponent's size. Weights by exp err by (6 + 10 x) u of themselves, and Σ w x / Σ w <= ln n.
const Case kCases[] = {
    {"exposure:ev=3", 0, "a power of two is exact"},
    {"exposure:ev=-0.7", 4, "the factor's rounding and the product's"},
    {"vignette:strength=1", 20, "four operations for the radius, a division and a square"},
    {"gaussian:sigma=0.5", 64, "two axes of compensated sums, weights rounded"},
    {"gaussian:sigma=7", 64, "however many taps"},
    {"median:radius=1", 0, "chosen, not computed"},
    {"median:radius=3", 0, "chosen, not computed"},
    {"bilateral:sigma_s=1.5,sigma_r=0.3", 4 * 6 + 10 * 5.2 + 20, "4 r + 10 ln n + 20 with r = 6, n = 169"},
    {"bilateral:sigma_s=3,sigma_r=inf", 4 * 12 + 10 * 6.5 + 20, "r = 12, n = 625"},
    {"atrous:levels=1", 2 * (6 + 20 * 3.3) + 20, "as bilateral with n = 25, and exponents of twice the operations"},
    {"bloom:strength=0.2,sigma=1,levels=3", 40, "a share of three Gaussians"},
    {"bloom:strength=1,sigma=2,threshold=1", 100, "and of what is above a threshold"},
    {"sobel", 16, "luminance 3, three sums, a length"},
    {"sobel:gain=10", 160, "ten times that"},
    {"outline", 16 / 0.5 + 12 / 0.1, "sums of unit normals and relative inverse depths, over their widths"},
    {"fxaa", 1000, "differences of lumas over a contrast of at least 0.03"},
    {"tone:curve=clamp", 4, "division by alpha, and back"},
    {"tone:curve=reinhard", 16, "one division more"},
    {"tone:curve=neutral", 24, "two divisions"},
    {"tone:curve=aces", 64, "two matrices whose rows sum to 1 with signs"},
    {"tone:curve=agx", 1024, "log2 within 2^-21, a polynomial whose terms sum to 95, a power"},
};

TEST_F(Post, every_pass_equals_the_double_one_within_its_bound)
{
    const Film film = post_film_of(61, 43);
    for (const auto& [chain, bound, why] : kCases) {
        const Pair pair = both(device(), film, chain);
        const double worst = disagreement(film, pair.device, pair.reference);
        RecordProperty(chain, std::to_string(worst));
        EXPECT_LE(worst, bound) << chain << ": " << why;
    }
}

TEST_F(Post, passes_of_several_steps_stay_near_the_double_ones)
{
    // Rounding of one step moves the weights of the next by 1/sigma_r, and a tent of the grid by 1/sigma_r too.
    const Case cases[] = {
        {"bilateral:sigma_s=3,sigma_r=0.3,method=separable", 100, "measured; its rows set the weights of its columns"},
        {"bilateral:sigma_s=3,sigma_r=0.3,method=grid", 100, "measured"},
        {"atrous:levels=5", 100, "measured; a pixel of little variance has narrow weights"},
        {"exposure:ev=1,gaussian:sigma=2,atrous:levels=4,sigma_c=1", 100, "measured; unguided: its variance is lost"},
        {"exposure:ev=auto", 100, "measured; exp2 of the device, the histogram's counts are integers"},
    };
    const Film film = post_film_of(61, 43);
    for (const auto& [chain, bound, why] : cases) {
        const Pair pair = both(device(), film, chain);
        const double worst = disagreement(film, pair.device, pair.reference);
        RecordProperty(chain, std::to_string(worst));
        EXPECT_LE(worst, bound) << chain << ": " << why;
    }
}

TEST_F(Post, every_pass_holds_at_both_ends_of_every_parameter_on_hostile_pictures)
{
    for (const ivec2 size : {ivec2(17, 9), ivec2(1, 1), ivec2(1, 6)}) {
        const Film film = hostile_post_film(size.x, size.y);
        for (const PostPass& pass : post_passes())
            for (const PostParameter& parameter : pass.parameters)
                for (const bool least : {true, false}) {
                    if (size.x == 1 && least) continue;  // once is enough
                    const bool enumerated = parameter.least == parameter.most;
                    const double value = least        ? parameter.least
                                         : enumerated ? double(parameter.words.size() - 1)
                                                      : parameter.most;
                    const std::string chain =
                        std::string(pass.name) + ":" + std::string(parameter.name) + "=" + value_text(parameter, value);
                    SCOPED_TRACE(chain + " of " + std::to_string(size.x) + "x" + std::to_string(size.y));
                    const Pair pair = both(device(), film, chain);
                    for (std::size_t i = 0; i < film.pixel_count(); ++i) {
                        const bool was = finite(film.mean[i], film.alpha[i]);
                        EXPECT_EQ(finite(pair.device.mean[i], pair.device.alpha[i]), was) << "pixel " << i;
                        EXPECT_EQ(finite(pair.reference.mean[i], pair.reference.alpha[i]), was) << "pixel " << i;
                    }
                }
    }
}

/// Both implementations, for what must hold of either.
template <class Check>
void of_both(gpu::Device& device, const Film& film, const std::string& chain, Check check)
{
    const Pair pair = both(device, film, chain);
    {
        SCOPED_TRACE(chain + " on the device");
        check(pair.device);
    }
    SCOPED_TRACE(chain + " in double");
    check(pair.reference);
}

TEST_F(Post, I1_I2_I3_I4_a_constant_picture_stays_what_it_is)
{
    Film film = post_film_of(23, 11);
    std::fill(film.mean.begin(), film.mean.end(), vec3(0.1f, 0.7f, 0.3f));
    std::fill(film.alpha.begin(), film.alpha.end(), 0.3f);
    for (const char* chain : {"gaussian:sigma=3", "median", "bilateral", "bilateral:method=separable", "fxaa",
                              "atrous:levels=3", "bloom:strength=1"})
        of_both(device(), film, chain, [&](const Film& out) {
            for (std::size_t i = 0; i < film.pixel_count(); ++i)
                for (int c = 0; c < 3; ++c) ASSERT_THAT(out.mean[i][c], WithinUlp(film.mean[i][c], 1)) << i;
        });
    of_both(device(), film, "sobel", [&](const Film& out) {
        for (const vec3& c : out.mean) ASSERT_EQ(c, vec3(0));
    });
}

TEST_F(Post, I1_I4_limits_are_exact)
{
    const Film film = post_film_of(23, 11);
    for (const char* chain :
         {"gaussian:sigma=0", "gaussian:sigma=0.09", "bilateral:sigma_s=0", "bilateral:sigma_r=0", "median:radius=0",
          "atrous:levels=0", "bloom:strength=0", "outline:strength=0", "exposure:ev=0", "vignette:strength=0"})
        of_both(device(), film, chain, [&](const Film& out) {
            EXPECT_EQ(out.mean, film.mean);
            EXPECT_EQ(out.alpha, film.alpha);
        });
    const Pair bilateral = both(device(), film, "bilateral:sigma_s=2,sigma_r=inf");
    const Pair gaussian = both(device(), film, "gaussian:sigma=2");
    EXPECT_LE(disagreement(film, bilateral.device, gaussian.device), 128) << "an infinite range is the Gaussian";
    EXPECT_LE(disagreement(film, bilateral.reference, gaussian.reference), 2);
}

TEST_F(Post, I2_a_transposed_picture_has_the_same_gradients_bit_for_bit)
{
    const Film film = post_film_of(24, 13);
    Film turned{.width = 13, .height = 24};
    turned.alpha.assign(film.pixel_count(), 1);
    for (std::size_t x = 0; x < 24; ++x)
        for (std::size_t y = 0; y < 13; ++y) turned.mean.push_back(film.mean[y * 24 + x]);
    const Film straight = apply_post(device(), film, parse_post("sobel"));
    const Film across = apply_post(device(), turned, parse_post("sobel"));
    for (std::size_t x = 0; x < 24; ++x)
        for (std::size_t y = 0; y < 13; ++y) ASSERT_EQ(across.mean[x * 13 + y], straight.mean[y * 24 + x]);
}

TEST_F(Post, I10_twice_the_light_is_one_step_less_of_exposure)
{
    const Film film = post_film_of(23, 11);
    Film bright = film;
    for (vec3& c : bright.mean) c *= 1024.0f;
    const Film a = apply_post(device(), film, parse_post("exposure:ev=auto"));
    const Film b = apply_post(device(), bright, parse_post("exposure:ev=auto"));
    for (std::size_t i = 0; i < film.pixel_count(); ++i)
        for (int c = 0; c < 3; ++c) ASSERT_NEAR(b.mean[i][c], a.mean[i][c], 1e-5 * a.mean[i][c]);
    Film black = film;
    std::fill(black.mean.begin(), black.mean.end(), vec3(0));
    EXPECT_EQ(apply_post(device(), black, parse_post("exposure:ev=auto")).mean, black.mean);
}

TEST_F(Post, bloom_keeps_the_energy_of_what_lies_away_from_the_border)
{
    Film film = post_film_of(64, 48);
    std::fill(film.mean.begin(), film.mean.end(), vec3(0));
    film.mean[24 * 64 + 32] = vec3(100, 50, 25);
    of_both(device(), film, "bloom:strength=0.5,sigma=1,levels=2", [](const Film& out) {
        dvec3 sum(0);
        for (const vec3& c : out.mean) sum += dvec3(c);
        EXPECT_NEAR(sum.x, 100, 1e-4);
        EXPECT_NEAR(sum.z, 25, 1e-4);
        EXPECT_LT(out.mean[24 * 64 + 32].x, 100 * 0.6);
    });
}

TEST_F(Post, a_variance_is_scaled_by_what_is_pointwise_and_linear_and_lost_by_the_rest)
{
    const Film film = post_film_of(16, 8);
    of_both(device(), film, "exposure:ev=2", [&](const Film& out) {
        ASSERT_EQ(out.variance.size(), film.variance.size());
        for (std::size_t i = 0; i < film.variance.size(); ++i) EXPECT_EQ(out.variance[i], 16.0f * film.variance[i]);
        EXPECT_NEAR(estimate_error(out)->relative, estimate_error(film)->relative, 1e-12);
    });
    const Pair vignette = both(device(), film, "vignette,exposure:ev=-1");
    for (std::size_t i = 0; i < film.variance.size(); ++i)
        for (int c = 0; c < 3; ++c)
            EXPECT_THAT(vignette.device.variance[i][c], WithinUlp(vignette.reference.variance[i][c], 50));
    for (const PostPass& pass : post_passes())
        if (pass.error == PostError::lost)
            of_both(device(), film, std::string(pass.name),
                    [](const Film& out) { EXPECT_FALSE(estimate_error(out).has_value()); });
}

TEST_F(Post, a_chain_is_its_passes_one_after_another)
{
    const Film film = post_film_of(30, 20);
    const Film chained = apply_post(device(), film, parse_post("bilateral:sigma_s=1,median,bloom,sobel,fxaa,vignette"));
    Film stepwise = film;
    for (const char* pass : {"bilateral:sigma_s=1", "median", "bloom", "sobel", "fxaa", "vignette"})
        stepwise = apply_post(device(), std::move(stepwise), parse_post(pass));
    EXPECT_EQ(chained.mean, stepwise.mean);
    EXPECT_EQ(chained.alpha, stepwise.alpha);
}

TEST_F(Post, a_pass_that_reads_aovs_says_so_where_there_are_none)
{
    Film film = post_film_of(4, 4);
    film.aovs = {};
    for (const char* chain : {"outline", "atrous"}) {
        EXPECT_THROW(apply_post(device(), film, parse_post(chain)), Error);
        EXPECT_THROW(reference::apply_post(film, parse_post(chain)), Error);
    }
}

}  // namespace
}  // namespace etalon::test
