#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <set>

#include "engine/scene/animation.h"
#include "engine/scene/gltf_accessor.h"
#include "engine/scene/gltf_import.h"

namespace etalon::gltf {

namespace {

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
        dvec3 scale{1};           // of each number of a value, where there are three
        std::size_t repeats = 1;  // how often each number of the file stands in a value
    };

    void convert(std::size_t index)
    {
        const tinygltf::Animation& in = source_.model.animations[index];
        Animation out;
        out.name = in.name.empty() ? fmt::format("animation {}", index) : in.name;
        std::map<std::pair<int, Index>, Index> sampler_of;  // also by material where keys are scaled
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
            const bool is_scaled = target->scale != dvec3(1) || target->repeats != 1;
            const auto [known, is_new] = sampler_of.try_emplace({channel.sampler, is_scaled ? target->object : kNone},
                                                                static_cast<Index>(out.samplers.size()));
            const std::string at = fmt::format("/animations/{}/samplers/{}", index, channel.sampler);
            if (is_new)
                out.samplers.push_back(read(in.samplers[static_cast<std::size_t>(channel.sampler)], *target, at));
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
        std::string property = fmt::format("/nodes/{}/{}", channel.target_node, channel.target_path);
        if (channel.target_path == "pointer") {
            const Value* extension = member(channel.target_extensions, "KHR_animation_pointer");
            const Value* text = extension == nullptr ? nullptr : member(*extension, "pointer");
            if (text == nullptr || !text->IsString()) {
                warn(pointer, "there is no KHR_animation_pointer [UNDEFINED_PROPERTY]");
                return std::nullopt;
            }
            property = text->Get<std::string>();
        } else if (channel.target_node < 0) {
            return std::nullopt;  // glTF 2.0 §3.11: to be ignored
        }
        return target_of(property, pointer);
    }

    std::optional<Target> target_of(const std::string& property, const std::string& pointer)
    {
        constexpr std::string_view kStrength = "/extensions/KHR_materials_emissive_strength/emissiveStrength";
        const bool is_strength = property.ends_with(kStrength);
        const std::optional<PropertyPlace> place = find_property(
            is_strength ? property.substr(0, property.size() - kStrength.size()) + "/emissiveFactor" : property);
        if (!place || place->object >= objects_of(property)) {
            warn(pointer, fmt::format("\"{}\" is nothing that can be animated", property.substr(0, 120)));
            return std::nullopt;
        }
        const std::string& row = animated_properties()[place->property].pointer;
        Target out{place->property, place->object, animated_properties()[place->property].width, dvec3(1)};
        if (out.width == 0) out.width = weights_of(row.starts_with("/nodes"), place->object);
        if (out.width == 0) {
            warn(pointer, "there are no morph targets [ANIMATION_CHANNEL_TARGET_NODE_WEIGHTS_NO_MORPHS]");
            return std::nullopt;
        }
        const bool is_trs = row == "/nodes/{}/translation" || row == "/nodes/{}/rotation" || row == "/nodes/{}/scale";
        if (is_trs && !scene_.nodes[place->object].trs) {
            warn(pointer, fmt::format("node {} has a matrix [ANIMATION_CHANNEL_TARGET_NODE_MATRIX]", place->object));
            return std::nullopt;
        }
        if (row == "/materials/{}/emissiveFactor") {
            // The scene holds their product: keys of the one are multiplied by the other as it rests.
            const tinygltf::Material& material = source_.model.materials[place->object];
            const auto& factor = material.emissiveFactor;
            const Value* extension = member(material.extensions, "KHR_materials_emissive_strength");
            const double strength =
                extension == nullptr ? 1 : number(*extension, "emissiveStrength", pointer, 1, 0, 1e30);
            out.scale = is_strength ? dvec3(factor.at(0), factor.at(1), factor.at(2)) : dvec3(strength);
            out.repeats = is_strength ? 3 : 1;
        }
        return out;
    }

    // How many objects there are of the kind that a pointer names.
    std::size_t objects_of(std::string_view property) const
    {
        if (property.starts_with("/nodes/")) return scene_.nodes.size();
        if (property.starts_with("/meshes/")) return scene_.meshes.size();
        if (property.starts_with("/materials/")) return source_.model.materials.size();
        if (property.starts_with("/cameras/")) return scene_.cameras.size();
        return scene_.lights.size();
    }

    std::size_t weights_of(bool is_node, Index object) const
    {
        const Index mesh = is_node ? scene_.nodes[object].mesh : object;
        return mesh == kNone ? 0 : scene_.meshes[mesh].weights.size();
    }

    AnimationSampler read(const tinygltf::AnimationSampler& in, const Target& target, const std::string& pointer)
    {
        AnimationSampler out;
        out.width = target.width;
        if (in.interpolation == "STEP")
            out.interpolation = Interpolation::step;
        else if (in.interpolation == "CUBICSPLINE")
            out.interpolation = Interpolation::cubic;
        else if (in.interpolation != "LINEAR")
            throw fault(pointer + "/interpolation",
                        fmt::format("\"{}\" [VALUE_NOT_IN_LIST]", in.interpolation.substr(0, 60)),
                        "LINEAR, STEP or CUBICSPLINE");
        numbers_ += reader_.count(in.input) + 4 * reader_.count(in.output);
        if (numbers_ > source_.limits.key_numbers)
            throw fault(pointer,
                        fmt::format("the keyframes of all animations take over {} numbers", source_.limits.key_numbers),
                        "split the file, or lift the limits with --limits none");
        out.times = reader_.doubles(in.input, {1}, pointer + "/input").values;
        const auto falls = std::is_sorted_until(out.times.begin(), out.times.end());
        if (falls != out.times.end())
            throw fault(pointer + "/input",
                        fmt::format("key {} is at {} s, after {} s [ACCESSOR_ANIMATION_INPUT_NON_INCREASING]",
                                    falls - out.times.begin(), *falls, *(falls - 1)));
        out.values = reader_.doubles(in.output, {1, 2, 3, 4}, pointer + "/output").values;
        const std::size_t needed =
            out.times.size() * out.width / target.repeats * (out.interpolation == Interpolation::cubic ? 3 : 1);
        if (out.values.size() != needed)
            throw fault(pointer + "/output", fmt::format("{} numbers for {} keys, which need {} "
                                                         "[ANIMATION_SAMPLER_OUTPUT_ACCESSOR_INVALID_COUNT]",
                                                         out.values.size(), out.times.size(), needed));
        if (target.repeats > 1) {
            std::vector<double> repeated;
            for (const double value : out.values) repeated.insert(repeated.end(), target.repeats, value);
            out.values = std::move(repeated);
        }
        if (target.scale != dvec3(1))
            for (std::size_t i = 0; i < out.values.size(); ++i) out.values[i] *= target.scale[static_cast<int>(i % 3)];
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
