#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <map>

#include "engine/scene/validate.h"

namespace etalon::document {

namespace {

constexpr Unsigned kUnsignedInt = 5125;

/// Decimal digits without leading zeros.
bool is_number(std::string_view text)
{
    return !text.empty() && text.find_first_not_of("0123456789") == std::string_view::npos &&
           (text.size() == 1 || text.front() != '0');
}

bool is_attribute(std::string_view name, bool in_target)
{
    if (name.starts_with('_') || name == "POSITION" || name == "NORMAL" || name == "TANGENT") return true;
    constexpr std::array<std::string_view, 4> kSets{"TEXCOORD_", "COLOR_", "JOINTS_", "WEIGHTS_"};
    for (const std::string_view set : std::span(kSets).first(in_target ? 2 : 4))
        if (name.starts_with(set)) return is_number(name.substr(set.size()));
    return false;
}

/// How many sets of texture coordinates the textures of each material ask for.
std::vector<std::size_t> sets_of_materials(const json& document)
{
    std::vector<std::size_t> out(collection(document, "/materials").size());
    const auto count = [&](const json& texture, const Place& place) {
        if (!place.key.ends_with("Texture") || !texture.is_object()) return;
        const Place* material = &place;
        while (material->parent->parent->parent != nullptr) material = material->parent;
        std::size_t set = index_at(texture, "texCoord").value_or(0);
        visit(texture, "/extensions/KHR_texture_transform",
              [&](const json& transform, const Place&) { set = index_at(transform, "texCoord").value_or(set); });
        out[material->element] = std::max(out[material->element], set + 1);
    };
    for (const std::string_view textures :
         {"/materials/*/*", "/materials/*/pbrMetallicRoughness/*", "/materials/*/extensions/*/*"})
        visit(document, textures, count);
    return out;
}

class Primitives {
 public:
    Primitives(const json& document, Findings& findings)
        : accessors_(collection(document, "/accessors")),
          views_(collection(document, "/bufferViews")),
          sets_(sets_of_materials(document)),
          findings_(findings)
    {}

    void check(const json& primitive, const Place& place)
    {
        visit(
            primitive, "/attributes/*", [&](const json& accessor, const Place& at) { attribute(accessor, at); }, place);
        visit(
            primitive, "/targets/*/*",
            [&](const json& accessor, const Place& at) {
                positions_have_bounds(accessor, at);
                if (!is_attribute(at.key, true))
                    findings_.add(at.pointer(), "no name of an attribute", "MESH_PRIMITIVE_INVALID_ATTRIBUTE");
                else if (member(primitive["attributes"], at.key) == nullptr)
                    findings_.add(at.pointer(), "moves an attribute that the primitive lacks",
                                  "MESH_PRIMITIVE_MORPH_TARGET_NO_BASE_ACCESSOR");
            },
            place);
        visit(
            primitive, "/indices", [&](const json& accessor, const Place& at) { indices(accessor, at); }, place);
        texture_coordinates(primitive, place);
    }

 private:
    const json& accessor_of(const json& index) const { return accessors_[index.get<std::size_t>()]; }

    void positions_have_bounds(const json& index, const Place& at)
    {
        const json& accessor = accessor_of(index);
        if (at.key == "POSITION" && (member(accessor, "min") == nullptr || member(accessor, "max") == nullptr))
            findings_.add(at.pointer(), "positions without min and max",
                          "MESH_PRIMITIVE_POSITION_ACCESSOR_WITHOUT_BOUNDS");
    }

    void attribute(const json& index, const Place& at)
    {
        positions_have_bounds(index, at);
        if (!is_attribute(at.key, false))
            findings_.add(at.pointer(), "no name of an attribute", "MESH_PRIMITIVE_INVALID_ATTRIBUTE");
        if (index_at(accessor_of(index), "componentType") == kUnsignedInt)
            findings_.add(at.pointer(), "32-bit integers are for indices alone",
                          "MESH_PRIMITIVE_ATTRIBUTES_ACCESSOR_UNSIGNED_INT");
        const auto view = index_at(accessor_of(index), "bufferView");
        if (!view || member(views_[*view], "byteStride") != nullptr) return;
        const auto [first, is_new] = user_of_view_.emplace(*view, index.get<std::size_t>());
        if (!is_new && first->second != index.get<std::size_t>())
            findings_.add(at.pointer(), "accessors share a bufferView without a stride",
                          "MESH_PRIMITIVE_ACCESSOR_WITHOUT_BYTESTRIDE");
    }

    void indices(const json& index, const Place& at) const
    {
        const json& accessor = accessor_of(index);
        const Unsigned type = index_at(accessor, "componentType").value_or(0);
        if (text_at(accessor, "type") != "SCALAR" || (type != 5121u && type != 5123u && type != kUnsignedInt))
            throw fault(at.pointer(),
                        fmt::format("indices of type {}, {} [MESH_PRIMITIVE_INDICES_ACCESSOR_INVALID_FORMAT]",
                                    text_at(accessor, "type"), type));
    }

    void texture_coordinates(const json& primitive, const Place& place)
    {
        const auto material = index_at(primitive, "material");
        if (!material) return;
        std::size_t have = 0;
        while (member(primitive["attributes"], fmt::format("TEXCOORD_{}", have)) != nullptr) ++have;
        if (sets_[*material] > have)
            findings_.add(place.pointer() + "/material",
                          fmt::format("its textures ask for TEXCOORD_{}", sets_[*material] - 1),
                          "MESH_PRIMITIVE_TOO_FEW_TEXCOORDS");
    }

    const json& accessors_;
    const json& views_;
    std::vector<std::size_t> sets_;
    std::map<std::size_t, std::size_t> user_of_view_;
    Findings& findings_;
};

void check_targets(const json& mesh, const Place& place, Findings& findings)
{
    std::optional<std::size_t> first;
    visit(
        mesh, "/primitives/*",
        [&](const json& primitive, const Place& at) {
            const json* targets = member(primitive, "targets");
            const std::size_t count = targets == nullptr ? 0 : targets->size();
            if (count != first.value_or(count))
                findings.add(at.pointer() + (targets == nullptr ? "" : "/targets"),
                             fmt::format("{} morph targets, but the first primitive has {}", count, *first),
                             "MESH_PRIMITIVES_UNEQUAL_TARGETS_COUNT");
            if (!first) first = count;
        },
        place);
}

}  // namespace

void validate_meshes(const json& document, Findings& findings)
{
    Primitives primitives(document, findings);
    visit(document, "/meshes/*/primitives/*",
          [&](const json& primitive, const Place& place) { primitives.check(primitive, place); });
    visit(document, "/meshes/*", [&](const json& mesh, const Place& place) { check_targets(mesh, place, findings); });
}

}  // namespace etalon::document
