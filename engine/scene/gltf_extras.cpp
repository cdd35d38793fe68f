#include <fmt/format.h>

#include <cmath>
#include <limits>

#include "engine/base/error.h"
#include "engine/scene/environment.h"
#include "engine/scene/gltf_import.h"
#include "engine/scene/resources.h"

namespace etalon::gltf {

namespace {

constexpr double kHuge = std::numeric_limits<float>::max();

// The object extras.etalon, or null.
const Value* etalon_of(const Value& extras)
{
    return extras.IsObject() ? member(extras, "etalon") : nullptr;
}

std::string text(const Value& value, const std::string& key)
{
    const Value* found = member(value, key);
    return found != nullptr && found->IsString() ? found->Get<std::string>() : std::string();
}

Error unknown(const std::string& pointer, const std::string& what, const std::string& value, const std::string& known)
{
    return fault(pointer, fmt::format("{} \"{}\" is not known", what, value), "choose one of: " + known);
}

double ggx_alpha(const Value& bsdf, const std::string& pointer)
{
    if (const std::string distribution = text(bsdf, "distribution"); !distribution.empty() && distribution != "ggx")
        throw unknown(pointer + "/distribution", "distribution", distribution, "ggx");
    return number(bsdf, "alpha", pointer, 0, 1e-6, 1);
}

void apply_bsdf(const Value& bsdf, const std::string& pointer, Material& material)
{
    const std::string type = text(bsdf, "type");
    const auto reflectance = [&] {
        material.base_color =
            dvec4(triple(bsdf, "reflectance", pointer, dvec3(material.base_color), 0, 1), material.base_color.w);
    };
    if (type == "lambert") {
        material.model = BsdfModel::lambert;
        reflectance();
    } else if (type == "mirror") {
        material.model = BsdfModel::mirror;
        reflectance();
    } else if (type == "rough_conductor") {
        material.model = BsdfModel::rough_conductor;
        material.ggx_alpha = ggx_alpha(bsdf, pointer);
        material.eta = triple(bsdf, "eta", pointer, dvec3(0), 0, kHuge);
        material.k = triple(bsdf, "k", pointer, dvec3(1), 0, kHuge);
    } else if (type == "dielectric" || type == "rough_dielectric") {
        material.model = type == "dielectric" ? BsdfModel::dielectric : BsdfModel::rough_dielectric;
        material.eta = dvec3(number(bsdf, "ior", pointer, 1.5, 1e-3, 1e3));
        if (type == "rough_dielectric") material.ggx_alpha = ggx_alpha(bsdf, pointer);
    } else {
        throw unknown(pointer + "/type", "BSDF", type,
                      "lambert, mirror, rough_conductor, dielectric, rough_dielectric");
    }
}

}  // namespace

Error fault(const std::string& pointer, std::string what, std::string mend)
{
    Error error(Blame::input, std::move(what), std::move(mend));
    error.at(pointer);
    return error;
}

const Value* member(const Value& value, const std::string& key)
{
    return value.IsObject() && value.Has(key) ? &value.Get(key) : nullptr;
}

const Value* member(const tinygltf::ExtensionMap& extensions, const std::string& key)
{
    const auto found = extensions.find(key);
    return found == extensions.end() ? nullptr : &found->second;
}

double number(const Value& value, const std::string& key, const std::string& pointer, double standard, double low,
              double high)
{
    const Value* found = member(value, key);
    if (found == nullptr) return standard;
    if (!found->IsNumber()) throw fault(pointer + "/" + key, "not a number [TYPE_MISMATCH]");
    const double out = found->GetNumberAsDouble();
    if (!(out >= low && out <= high))
        throw fault(pointer + "/" + key, fmt::format("{} is not from {} to {} [VALUE_NOT_IN_RANGE]", out, low, high));
    return out;
}

dvec3 triple(const Value& value, const std::string& key, const std::string& pointer, const dvec3& standard, double low,
             double high)
{
    const Value* found = member(value, key);
    if (found == nullptr) return standard;
    const std::string where = pointer + "/" + key;
    if (!found->IsArray() || found->ArrayLen() != 3) throw fault(where, "not three numbers [TYPE_MISMATCH]");
    dvec3 out;
    for (int i = 0; i < 3; ++i) {
        const Value& element = found->Get(i);
        out[i] = element.IsNumber() ? element.GetNumberAsDouble() : std::numeric_limits<double>::quiet_NaN();
        if (!(out[i] >= low && out[i] <= high))
            throw fault(where,
                        fmt::format("element {} is not a number from {} to {} [VALUE_NOT_IN_RANGE]", i, low, high));
    }
    return out;
}

void apply_material_extras(const Value& extras, const std::string& pointer, Material& material)
{
    const Value* own = etalon_of(extras);
    if (own == nullptr) return;
    if (const Value* bsdf = member(*own, "bsdf")) apply_bsdf(*bsdf, pointer + "/extras/etalon/bsdf", material);
    if (const std::string side = text(*own, "emission"); side == "front")
        material.emits_front_only = true;
    else if (!side.empty())
        throw unknown(pointer + "/extras/etalon/emission", "emission", side, "front");
}

std::optional<SphereShape> sphere_extras(const Value& extras, const std::string& pointer, std::size_t materials)
{
    const Value* own = etalon_of(extras);
    const Value* shape = own == nullptr ? nullptr : member(*own, "shape");
    if (shape == nullptr) return std::nullopt;
    const std::string where = pointer + "/extras/etalon";
    if (text(*shape, "type") != "sphere") throw unknown(where + "/shape/type", "shape", text(*shape, "type"), "sphere");
    SphereShape out;
    out.radius = number(*shape, "radius", where + "/shape", 1, 1e-30, 1e30);
    const double index = number(*own, "material", where, -1, 0, 4294967294.0);
    if (index < 0 || index >= static_cast<double>(materials) || index != std::floor(index))
        throw fault(where + "/material",
                    fmt::format("{} is no index of the {} materials [UNRESOLVED_REFERENCE]", index, materials));
    out.material = static_cast<Index>(index);
    return out;
}

std::optional<ThinLens> lens_extras(const Value& extras, const std::string& pointer)
{
    const Value* own = etalon_of(extras);
    const Value* lens = own == nullptr ? nullptr : member(*own, "thin_lens");
    if (lens == nullptr) return std::nullopt;
    const std::string where = pointer + "/extras/etalon/thin_lens";
    return ThinLens{.aperture_radius = number(*lens, "aperture_radius", where, 0, 0, kHuge),
                    .focus_distance = number(*lens, "focus_distance", where, 1, 1e-30, kHuge),
                    .blades = static_cast<int>(number(*lens, "blades", where, 0, 0, 64))};
}

void apply_scene_extras(const Value& extras, const std::string& pointer, const std::filesystem::path& folder,
                        SceneRoot& root)
{
    const Value* own = etalon_of(extras);
    if (own == nullptr) return;
    const std::string where = pointer + "/extras/etalon";
    if (const Value* film = member(*own, "film"); film != nullptr && film->Has("width") && film->Has("height"))
        root.hints.size = ivec2(static_cast<int>(number(*film, "width", where + "/film", 0, 1, 16384)),
                                static_cast<int>(number(*film, "height", where + "/film", 0, 1, 16384)));
    if (const Value* integrator = member(*own, "integrator"); integrator != nullptr && integrator->Has("max_depth"))
        root.hints.max_depth = static_cast<int>(number(*integrator, "max_depth", where + "/integrator", 0, 1, 4096));
    const Value* light = member(*own, "environment");
    if (light == nullptr) return;
    const std::string at = where + "/environment";
    Environment environment;
    environment.radiance = triple(*light, "radiance", at, dvec3(0), 0, kHuge);
    environment.rotation = number(*light, "rotation", at, 0, -kHuge, kHuge);
    environment.scale = number(*light, "scale", at, 1, 0, kHuge);
    if (const Value* file = member(*light, "file")) {
        if (!file->IsString()) throw fault(at + "/file", "not a file name [TYPE_MISMATCH]");
        try {
            environment.map = read_environment(confined_path(file->Get<std::string>(), folder)).map;
        } catch (Error& error) {
            throw error.at(at + "/file");
        }
    }
    root.environment = std::move(environment);
}

}  // namespace etalon::gltf
