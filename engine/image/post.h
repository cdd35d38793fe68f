#pragma once
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace etalon {

// Post passes: what is done to a film between rendering and display. This is the one table of them: parsing, help,
// manual and docs/post.md derive from it. Equations (IP-1) to (IP-14) in docs/equations.md. The passes run on a device
// (engine/render/post.h) and, in double, on the CPU (engine/reference/post.h).

enum class PostKind { exposure, vignette, gaussian, median, bilateral, atrous, bloom, sobel, outline, fxaa, tone };

/// One parameter of a pass: a number in a range, or one of a few words.
struct PostParameter {
    std::string_view name;
    double standard = 0;  ///< for words: the place of the standard one
    double least = 0;
    double most = 0;                               ///< Inf: "inf" may be given
    bool whole = false;                            ///< an integer
    std::span<const std::string_view> words = {};  ///< the words; for a number: words that may stand for it
    std::string_view unit;
    std::string_view what;  ///< one line of help
};

/// What a pass leaves of Film::variance.
enum class PostError {
    scaled,  ///< pointwise and linear: the variance is scaled along, and the estimate stays one
    lost,    ///< the picture is no longer an estimate of radiance: its error is not measured
};

struct PostPass {
    PostKind kind = PostKind::exposure;
    std::string_view name;
    std::string_view what;  ///< one line of help
    std::span<const PostParameter> parameters;
    PostError error = PostError::lost;
    bool aovs = false;  ///< reads Film::aovs
};

std::span<const PostPass> post_passes();
const PostPass& post_pass(PostKind kind);

/// A pass with a value for each of its parameters, in their order.
struct PostStage {
    PostKind kind = PostKind::exposure;
    std::vector<double> values;

    const PostPass& pass() const { return post_pass(kind); }
    /// Of the parameter of that name, which must exist.
    double operator[](std::string_view parameter) const;
    /// True where the parameter is this word of its own.
    bool is(std::string_view parameter, std::string_view word) const;
};

using PostChain = std::vector<PostStage>;

/// Reads "sobel,bilateral:sigma_s=3,sigma_r=0.1": passes in the order in which they are applied, each with parameters
/// after a colon. Throws Error(input) that names the pass or parameter, its range, and the nearest name to a misspelt
/// one.
PostChain parse_post(std::string_view text);
/// The chain as text, every parameter written out; parses to the same chain.
std::string describe(const PostChain& chain);

/// A Gaussian narrower than this has no taps beside its centre: such a pass changes nothing (I4). Pixels.
inline constexpr double kPostLeastSigma = 0.1;

/// Whether a pass of the chain reads AOVs.
bool needs_aovs(const PostChain& chain);

/// "0 to 30 pixels", "-100 to 100 EV or auto", "exact, separable or grid".
std::string range_of(const PostParameter& parameter);
/// A value as it is written on the command line: "3", "inf", "auto", "grid".
std::string value_text(const PostParameter& parameter, double value);

}  // namespace etalon
