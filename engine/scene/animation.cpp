#include "engine/scene/animation.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>

#include "engine/base/error.h"

namespace etalon {

namespace {

// sin x / x, to an ulp or two for any x.
double sine_ratio(double x)
{
    // The first term left out is x⁴/120.
    return std::abs(x) < 1e-4 ? 1 - x * x / 6 : std::sin(x) / x;
}

// Of a quaternion that a file holds; 0 is no rotation (G31).
dquat unit(const dquat& q)
{
    const double largest = std::max({std::abs(q.w), std::abs(q.x), std::abs(q.y), std::abs(q.z)});
    return largest > 0 ? glm::normalize(q * (1 / largest)) : dquat(1, 0, 0, 0);
}

dquat quaternion(std::span<const double> v)
{
    return dquat(v[3], v[0], v[1], v[2]);
}

std::vector<double> numbers(const dquat& q)
{
    return {q.x, q.y, q.z, q.w};
}

double norm(const dquat& q)
{
    return std::sqrt(glm::dot(q, q));
}

// The keys around a time.
struct Place {
    std::size_t key = 0;  // the last at or before it
    double u = 0;         // how far to the next, [0, 1)
    double seconds = 0;   // between them; 0: no interpolation
};

Place place_of(const std::vector<double>& times, double time)
{
    assume(!times.empty());
    const auto after = std::upper_bound(times.begin(), times.end(), time);
    if (after == times.begin()) return {};
    const auto key = static_cast<std::size_t>(after - times.begin()) - 1;
    if (after == times.end()) return {.key = key};
    const double seconds = *after - times[key];
    return {.key = key, .u = (time - times[key]) / seconds, .seconds = seconds};
}

// glTF 2.0 appendix C.5; tangents are per second.
std::vector<double> hermite(const AnimationSampler& sampler, const Place& at)
{
    const std::size_t width = sampler.width;
    const double* from = &sampler.values[3 * width * at.key];
    const double u = at.u;
    const double u2 = u * u;
    const double u3 = u2 * u;
    std::vector<double> out(width);
    for (std::size_t i = 0; i < width; ++i) {
        const double v0 = from[width + i];
        if (at.seconds == 0) {
            out[i] = v0;
            continue;
        }
        const double out_tangent = from[2 * width + i];
        const double in_tangent = from[3 * width + i];
        const double v1 = from[4 * width + i];
        // h00 = 1 - h01, so that a constant curve stays constant to the bit.
        out[i] = v0 + (3 * u2 - 2 * u3) * (v1 - v0) +
                 at.seconds * ((u3 - 2 * u2 + u) * out_tangent + (u3 - u2) * in_tangent);
    }
    return out;
}

}  // namespace

dquat slerp(const dquat& a, const dquat& b, double u)
{
    const dquat near = glm::dot(a, b) < 0 ? -b : b;
    const double angle = 2 * std::atan2(norm(a - near), norm(a + near));  // 0 … π/2
    const double all = sine_ratio(angle);
    return a * ((1 - u) * sine_ratio((1 - u) * angle) / all) + near * (u * sine_ratio(u * angle) / all);
}

std::vector<double> sample(const AnimationSampler& sampler, double time, bool is_rotation)
{
    const std::size_t width = sampler.width;
    const Place at = place_of(sampler.times, time);
    if (sampler.interpolation == Interpolation::cubic) {
        const std::vector<double> value = hermite(sampler, at);
        return is_rotation ? numbers(unit(quaternion(value))) : value;
    }
    const std::span<const double> from(&sampler.values[width * at.key], width);
    if (sampler.interpolation == Interpolation::step || at.u == 0) return {from.begin(), from.end()};
    const std::span<const double> to(&sampler.values[width * (at.key + 1)], width);
    if (is_rotation) return numbers(slerp(unit(quaternion(from)), unit(quaternion(to)), at.u));
    std::vector<double> out(width);
    for (std::size_t i = 0; i < width; ++i) out[i] = std::lerp(from[i], to[i], at.u);
    return out;
}

void evaluate(const Scene& scene, const Animation& animation, double time, Motion& motion)
{
    assume(std::isfinite(time));
    for (const AnimationChannel& channel : animation.channels) {
        const AnimatedProperty& property = animated_properties()[channel.property];
        std::vector<double> value = sample(animation.samplers.at(channel.sampler), time, property.is_rotation);
        for (double& number : value) {
            if (!std::isfinite(number))
                throw Error(Blame::input,
                            fmt::format("animation \"{}\" at {} s: {} of object {} is not finite", animation.name, time,
                                        property.pointer, channel.object),
                            "repair the keys");
            number = std::clamp(number, property.low, property.high);
        }
        property.set(scene, channel.object, value, motion);
    }
}

const Animation& find_animation(const Scene& scene, const std::string& name_or_index)
{
    const auto named = std::find_if(scene.animations.begin(), scene.animations.end(),
                                    [&](const Animation& a) { return a.name == name_or_index; });
    if (named != scene.animations.end()) return *named;
    std::size_t index = 0;
    const char* end = name_or_index.data() + name_or_index.size();
    const auto [stop, failure] = std::from_chars(name_or_index.data(), end, index);
    if (failure == std::errc() && stop == end && index < scene.animations.size()) return scene.animations[index];
    std::string have;
    constexpr std::size_t kListed = 20;
    for (std::size_t i = 0; i < std::min(scene.animations.size(), kListed); ++i)
        have += fmt::format("{}{} \"{}\"", i == 0 ? "" : ", ", i, scene.animations[i].name);
    if (scene.animations.size() > kListed) have += ", …";
    throw Error(Blame::input, fmt::format("no animation \"{}\" in {}", name_or_index, scene.name),
                have.empty() ? "it has none" : "it has " + have);
}

}  // namespace etalon
