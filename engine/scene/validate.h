#pragma once
// Private to preflight: rules of glTF 2.0 beyond those that a reader needs to be safe. Who breaks them is warned, at
// the JSON pointer and with the code of the Khronos validator; docs/verdicts.md compares the two.
#include <cmath>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "engine/scene/preflight_parts.h"

namespace etalon::document {

/// Broken rules as warnings, "pointer: what [CODE]". No more than a hundred, and how many more there are.
class Findings {
 public:
    void add(const std::string& pointer, std::string_view what, std::string_view code);
    std::vector<std::string> lines() &&;

 private:
    std::vector<std::string> lines_;
    std::size_t more_ = 0;
};

/// Throws for an object that lacks what it cannot be read without. Before the references are checked.
void check_required(const json& document);

/// Every rule below. After all checks of preflight.
std::vector<std::string> validate(const json& document, std::span<const View> views,
                                  std::span<const GltfBuffer> buffers);

/// What must not be empty, what needs something else, and where extensions may stand. validate_properties.cpp
void validate_properties(const json& document, Findings& findings);
/// Buffer views and how they are used, cameras, nodes, skins. validate_objects.cpp
void validate_objects(const json& document, Findings& findings);
/// Primitives and what their materials ask of them. validate_meshes.cpp
void validate_meshes(const json& document, Findings& findings);
/// Channels and samplers, without their data. validate_animations.cpp
void validate_animations(const json& document, Findings& findings);
/// The data of accessors: bounds, finite, unit vectors, times, matrices. validate_values.cpp
void validate_values(const json& document, std::span<const View> views, std::span<const GltfBuffer> buffers,
                     Findings& findings);

/// As for_each, but what is of another kind than the pattern expects is passed over.
template <typename Function>
void visit(const json& at, std::string_view pattern, const Function& with, const Place& place = {})
{
    if (pattern.empty()) return with(at, place);
    const std::size_t slash = std::min(pattern.find('/', 1), pattern.size());
    const std::string_view key = pattern.substr(1, slash - 1);
    const std::string_view rest = pattern.substr(slash);
    if (key != "*") {
        if (const json* found = member(at, key)) visit(*found, rest, with, Place{.parent = &place, .key = key});
    } else if (at.is_array()) {
        for (std::size_t i = 0; i < at.size(); ++i) visit(at[i], rest, with, Place{.parent = &place, .element = i});
    } else if (at.is_object()) {
        for (auto i = at.begin(); i != at.end(); ++i) visit(*i, rest, with, Place{.parent = &place, .key = i.key()});
    }
}

/// A reference that has been checked; nothing when absent.
inline std::optional<std::size_t> index_at(const json& object, std::string_view key)
{
    const json* found = member(object, key);
    if (found == nullptr || !found->is_number_unsigned()) return std::nullopt;
    return found->get<std::size_t>();
}

inline double number_at(const json& object, std::string_view key, double standard)
{
    const json* found = member(object, key);
    return found != nullptr && found->is_number() ? found->get<double>() : standard;
}

inline std::string_view text_at(const json& object, std::string_view key)
{
    const json* found = member(object, key);
    return found != nullptr && found->is_string() ? std::string_view(found->get_ref<const std::string&>())
                                                  : std::string_view{};
}

/// |length - 1| over which the validator calls a vector, or a quaternion, not of unit length: one step of 8 bits.
inline constexpr double kUnitVector = 0.00674;
inline constexpr double kUnitQuaternion = 0.00769;

}  // namespace etalon::document
