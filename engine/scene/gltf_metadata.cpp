#include <fmt/format.h>

#include "engine/scene/gltf_import.h"

namespace etalon::gltf {

namespace {

constexpr std::size_t kMaxText = 2000;  // bytes shown of one property

// All text within a JSON-LD value, in its order: sets, lists and language alternatives are objects and arrays of it.
void collect_text(const Value& value, std::string& out)
{
    if (out.size() > kMaxText) return;
    const auto add = [&](const std::string& text) { out += (out.empty() ? "" : "; ") + text; };
    if (value.IsString())
        add(value.Get<std::string>());
    else if (value.IsBool())
        add(value.Get<bool>() ? "true" : "false");
    else if (value.IsNumber())
        add(fmt::format("{}", value.GetNumberAsDouble()));
    else if (value.IsArray())
        for (std::size_t i = 0; i < value.ArrayLen(); ++i) collect_text(value.Get(static_cast<int>(i)), out);
    else if (value.IsObject())
        for (const std::string& key : value.Keys())
            if (key != "@type" && key != "@language") collect_text(value.Get(key), out);
}

}  // namespace

void list_variants(const Model& model, Scene& scene)
{
    const Value* extension = member(model.extensions, "KHR_materials_variants");
    const Value* variants = extension == nullptr ? nullptr : member(*extension, "variants");
    for (std::size_t i = 0; variants != nullptr && i < variants->ArrayLen(); ++i) {
        const Value* name = member(variants->Get(static_cast<int>(i)), "name");
        scene.variants.push_back(name != nullptr && name->IsString() ? name->Get<std::string>()
                                                                     : fmt::format("variant {}", i));
    }
}

void list_metadata(const Model& model, Scene& scene)
{
    const Value* own = member(model.asset.extensions, "KHR_xmp_json_ld");
    const Value* extension = member(model.extensions, "KHR_xmp_json_ld");
    const Value* packets = extension == nullptr ? nullptr : member(*extension, "packets");
    if (own == nullptr || packets == nullptr) return;
    const std::string pointer = "/asset/extensions/KHR_xmp_json_ld";
    const double index = number(*own, "packet", pointer, -1, 0, 1e9);
    if (!(index >= 0 && index < static_cast<double>(packets->ArrayLen())))
        throw fault(pointer + "/packet",
                    fmt::format("{} is no index of the {} packets [UNRESOLVED_REFERENCE]", index, packets->ArrayLen()));
    const Value& packet = packets->Get(static_cast<int>(index));
    if (!packet.IsObject()) return;
    for (const std::string& key : packet.Keys()) {
        if (key.starts_with('@')) continue;
        std::string text;
        collect_text(packet.Get(key), text);
        scene.metadata.push_back({key, std::move(text)});
    }
}

}  // namespace etalon::gltf
