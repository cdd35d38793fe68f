#include <fmt/format.h>

#include <map>

#include "engine/scene/validate.h"

namespace etalon::document {

namespace {

void check_samplers(const json& document, Findings& findings)
{
    const json& accessors = collection(document, "/accessors");
    visit(document, "/animations/*/samplers/*", [&](const json& sampler, const Place& place) {
        const auto input = index_at(sampler, "input");
        if (!input) return;
        const json& times = accessors[*input];
        if (member(times, "min") == nullptr || member(times, "max") == nullptr)
            findings.add(place.pointer() + "/input", "times without min and max",
                         "ANIMATION_SAMPLER_INPUT_ACCESSOR_WITHOUT_BOUNDS");
        if (text_at(sampler, "interpolation") == "CUBICSPLINE" && index_at(times, "count") < 2u)
            findings.add(place.pointer() + "/input", "a spline has at least two keys",
                         "ANIMATION_SAMPLER_INPUT_ACCESSOR_TOO_FEW_ELEMENTS");
    });
}

void check_pointer(const json& target, const Place& place, Findings& findings)
{
    visit(
        target, "/extensions/KHR_animation_pointer",
        [&](const json& extension, const Place& at) {
            if (member(extension, "pointer") == nullptr)
                findings.add(at.pointer(), "pointer is missing", "UNDEFINED_PROPERTY");
            if (member(target, "node") != nullptr)
                findings.add(at.pointer(), "the target has a node too",
                             "KHR_ANIMATION_POINTER_ANIMATION_CHANNEL_TARGET_NODE");
            if (text_at(target, "path") != "pointer")
                findings.add(at.pointer(), "the target's path is not \"pointer\"",
                             "KHR_ANIMATION_POINTER_ANIMATION_CHANNEL_TARGET_PATH");
        },
        place);
}

}  // namespace

void validate_animations(const json& document, Findings& findings)
{
    check_samplers(document, findings);
    visit(document, "/animations/*", [&](const json& animation, const Place& place) {
        std::map<std::pair<std::size_t, std::string_view>, std::string> moved;  // by which channel's target
        visit(
            animation, "/channels/*/target",
            [&](const json& target, const Place& at) {
                check_pointer(target, at, findings);
                const auto node = index_at(target, "node");
                if (!node) return;
                const auto [first, is_new] = moved.try_emplace({*node, text_at(target, "path")}, at.pointer());
                if (is_new || first->second.empty()) return;
                findings.add(first->second, "another channel moves the same", "ANIMATION_DUPLICATE_TARGETS");
                first->second.clear();
            },
            place);
    });
}

}  // namespace etalon::document
