#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <set>

#include "engine/scene/animation.h"
#include "engine/scene/gltf_accessor.h"
#include "engine/scene/gltf_import.h"

namespace etalon::gltf {

namespace {

// Many samplers may share one accessor, and each gets its own copy.
constexpr std::size_t kMaxNumbers = 400'000'000;

class Animations {
 public:
    Animations(const Source& source, Scene& scene) : source_(source), scene_(scene), reader_(source)
    {
        for (std::size_t i = 0; i < source_.model.animations.size(); ++i) convert(i);
    }

 private:
    // Where a channel leads: a property, its object, and how many numbers its value has.
    struct Target {
        Index property = 0;
        Index object = 0;
        std::size_t width = 0;
    };

    void convert(std::size_t index)
    {
        const tinygltf::Animation& in = source_.model.animations[index];
        Animation out;
        out.name = in.name.empty() ? fmt::format("animation {}", index) : in.name;
        std::map<int, Index> sampler_of;
        std::set<std::pair<Index, Index>> taken;
        for (std::size_t c = 0; c < in.channels.size(); ++c) {
            const std::string pointer = fmt::format("/animations/{}/channels/{}", index, c);
            const tinygltf::AnimationChannel& channel = in.channels[c];
            if (channel.sampler < 0 || static_cast<std::size_t>(channel.sampler) >= in.samplers.size())
                throw fault(pointer + "/sampler", fmt::format("{} is out of range: the animation has {} samplers "
                                                              "[UNRESOLVED_REFERENCE]",
                                                              channel.sampler, in.samplers.size()));
            const std::optional<Target> target = target_of(channel, pointer + "/target");
            if (!target) continue;
            if (!taken.emplace(target->property, target->object).second) {
                warn(pointer + "/target", "another channel moves the same [ANIMATION_DUPLICATE_TARGETS]");
                continue;
            }
            const auto [known, is_new] =
                sampler_of.try_emplace(channel.sampler, static_cast<Index>(out.samplers.size()));
            const std::string at = fmt::format("/animations/{}/samplers/{}", index, channel.sampler);
            if (is_new)
                out.samplers.push_back(read(in.samplers[static_cast<std::size_t>(channel.sampler)], target->width, at));
            else if (out.samplers[known->second].width != target->width)
                throw fault(pointer + "/sampler",
                            fmt::format("sampler {} gives {} numbers elsewhere, but here {} are needed",
                                        channel.sampler, out.samplers[known->second].width, target->width));
            out.channels.push_back({known->second, target->property, target->object});
        }
        for (const AnimationSampler& sampler : out.samplers)
            out.duration = std::max(out.duration, sampler.times.back());
        scene_.animations.push_back(std::move(out));
    }

    void warn(const std::string& pointer, const std::string& what)
    {
        scene_.warnings.push_back(fmt::format("{}: {}: the channel is ignored", pointer, what));
    }

    std::optional<Target> target_of(const tinygltf::AnimationChannel& channel, const std::string& pointer)
    {
        if (channel.target_node < 0) return std::nullopt;  // glTF 2.0 §3.11: to be ignored
        const auto object = static_cast<Index>(channel.target_node);
        const std::string& path = channel.target_path;
        if (path == "weights") {
            const std::size_t width = weights_of(object);
            if (width == 0) {
                warn(pointer,
                     fmt::format("node {} has no morph targets [ANIMATION_CHANNEL_TARGET_NODE_WEIGHTS_NO_MORPHS]",
                                 object));
                return std::nullopt;
            }
            return Target{animated_property("/nodes/{}/weights"), object, width};
        }
        if (path != "translation" && path != "rotation" && path != "scale") {
            warn(pointer + "/path", fmt::format("\"{}\" is not known", path.substr(0, 60)));
            return std::nullopt;
        }
        if (!scene_.nodes[object].trs) {
            warn(pointer, fmt::format("node {} has a matrix [ANIMATION_CHANNEL_TARGET_NODE_MATRIX]", object));
            return std::nullopt;
        }
        const Index property = animated_property("/nodes/{}/" + path);
        return Target{property, object, animated_properties()[property].width};
    }

    std::size_t weights_of(Index node) const
    {
        const Index mesh = scene_.nodes[node].mesh;
        return mesh == kNone ? 0 : scene_.meshes[mesh].weights.size();
    }

    AnimationSampler read(const tinygltf::AnimationSampler& in, std::size_t width, const std::string& pointer)
    {
        AnimationSampler out;
        out.width = width;
        if (in.interpolation == "STEP")
            out.interpolation = Interpolation::step;
        else if (in.interpolation == "CUBICSPLINE")
            out.interpolation = Interpolation::cubic;
        else if (in.interpolation != "LINEAR")
            throw fault(pointer + "/interpolation",
                        fmt::format("\"{}\" [VALUE_NOT_IN_LIST]", in.interpolation.substr(0, 60)),
                        "LINEAR, STEP or CUBICSPLINE");
        numbers_ += reader_.count(in.input) + 4 * reader_.count(in.output);
        if (numbers_ > kMaxNumbers)
            throw fault(pointer, fmt::format("the keys of all animations are over {} numbers", kMaxNumbers));
        out.times = reader_.doubles(in.input, {1}, pointer + "/input").values;
        const auto falls = std::is_sorted_until(out.times.begin(), out.times.end());
        if (falls != out.times.end())
            throw fault(pointer + "/input",
                        fmt::format("key {} is at {} s, after {} s [ACCESSOR_ANIMATION_INPUT_NON_INCREASING]",
                                    falls - out.times.begin(), *falls, *(falls - 1)));
        out.values = reader_.doubles(in.output, {1, 2, 3, 4}, pointer + "/output").values;
        const std::size_t needed = out.times.size() * width * (out.interpolation == Interpolation::cubic ? 3 : 1);
        if (out.values.size() != needed)
            throw fault(pointer + "/output", fmt::format("{} numbers for {} keys, which need {} "
                                                         "[ANIMATION_SAMPLER_OUTPUT_ACCESSOR_INVALID_COUNT]",
                                                         out.values.size(), out.times.size(), needed));
        return out;
    }

    const Source& source_;
    Scene& scene_;
    AccessorReader reader_;
    std::size_t numbers_ = 0;
};

}  // namespace

void import_animations(const Source& source, Scene& scene)
{
    const Animations animations(source, scene);
}

}  // namespace etalon::gltf
