#include "engine/scene/gltf_layers.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace etalon::gltf {

namespace {

constexpr double kHuge = std::numeric_limits<float>::max();

constexpr double kNever = std::numeric_limits<double>::infinity();

constexpr std::array kLayerExtensions = {"KHR_materials_ior",          "KHR_materials_specular",
                                         "KHR_materials_clearcoat",    "KHR_materials_sheen",
                                         "KHR_materials_transmission", "KHR_materials_volume",
                                         "KHR_materials_iridescence",  "KHR_materials_anisotropy",
                                         "KHR_materials_dispersion",   "KHR_materials_diffuse_transmission"};

// The members of one extension of a material; all at their standard values where the material lacks it.
class Extension {
 public:
    Extension(const tinygltf::Material& material, const std::string& pointer, const char* name, Textures& textures,
              Scene& scene)
        : value_(member(material.extensions, name)),
          pointer_(fmt::format("{}/extensions/{}", pointer, name)),
          textures_(textures),
          scene_(scene)
    {
        if (value_ != nullptr && !value_->IsObject()) throw fault(pointer_, "not an object [TYPE_MISMATCH]");
    }

    bool present() const { return value_ != nullptr; }
    const std::string& pointer() const { return pointer_; }

    double real(const char* key, double standard, double low = -kHuge, double high = kHuge)
    {
        if (!present()) return standard;
        return within(number(*value_, key, pointer_, standard, -kHuge, kHuge), low, high, key);
    }
    double factor(const char* key, double standard) { return real(key, standard, 0, 1); }

    dvec3 color(const char* key, double standard, double high = 1)
    {
        if (!present()) return dvec3(standard);
        dvec3 out = triple(*value_, key, pointer_, dvec3(standard), -kHuge, kHuge);
        for (int c = 0; c < 3; ++c) out[c] = within(out[c], 0, high, key);
        return out;
    }

    dvec4 color_and_alpha(const char* key)
    {
        const Value* found = present() ? member(*value_, key) : nullptr;
        if (found == nullptr) return dvec4(1);
        const std::string where = pointer_ + "/" + key;
        if (!found->IsArray() || found->ArrayLen() != 4) throw fault(where, "not four numbers [TYPE_MISMATCH]");
        dvec4 out;
        for (int c = 0; c < 4; ++c) {
            if (!found->Get(c).IsNumber()) throw fault(where, "not four numbers [ARRAY_TYPE_MISMATCH]");
            out[c] = within(found->Get(c).GetNumberAsDouble(), 0, 1, key);
        }
        return out;
    }

    TextureUse texture(const char* key) { return present() ? textures_.use(*value_, key, pointer_) : TextureUse{}; }

    double normal_scale(const char* key)
    {
        const Value* info = present() ? member(*value_, key) : nullptr;
        return info == nullptr ? 1 : number(*info, "scale", fmt::format("{}/{}", pointer_, key), 1, -kHuge, kHuge);
    }

    void warn(const char* key, const std::string& what)
    {
        scene_.warnings.push_back(fmt::format("{}/{}: {}", pointer_, key, what));
    }

 private:
    double within(double value, double low, double high, const char* key)
    {
        const double out = value < low ? low : std::min(value, high);
        if (out != value) warn(key, fmt::format("{} is taken as {} [VALUE_NOT_IN_RANGE]", value, out));
        return out;
    }

    const Value* value_;
    std::string pointer_;
    Textures& textures_;
    Scene& scene_;
};

class Layers {
 public:
    Layers(const tinygltf::Material& in, const std::string& pointer, const Material& base, bool animated,
           Textures& textures, Scene& scene)
        : in_(in), pointer_(pointer), animated_(animated), textures_(textures), scene_(scene)
    {
        // What only the dielectric part of a surface has does not show on a metal.
        const bool dielectric = animated || base.metallic < 1 || base.metallic_roughness_texture.present();
        ior(dielectric);
        specular(dielectric);
        transmission(dielectric);
        volume();
        diffuse_transmission(dielectric);
        sheen();
        clearcoat();
        iridescence();
        anisotropy();
    }

    std::optional<MaterialLayers> result() &&
    {
        if (!changes_) return std::nullopt;
        return std::move(out_);
    }

 private:
    Extension extension(const char* name) { return {in_, pointer_, name, textures_, scene_}; }

    // Does a layer of this strength show nothing, now and later?
    bool is_inert(const Extension& in, bool none) const { return none && !(animated_ && in.present()); }

    void ior(bool shows)
    {
        Extension in = extension("KHR_materials_ior");
        double value = in.real("ior", 1.5, 0);
        if (value > 0 && value < 1) {
            in.warn("ior", fmt::format("{} is taken as 1 [VALUE_NOT_IN_RANGE]", value));
            value = 1;
        }
        if (!shows || is_inert(in, value == 1.5)) return;
        out_.ior = value;
        changes_ = true;
    }

    void specular(bool shows)
    {
        Extension in = extension("KHR_materials_specular");
        const double factor = in.factor("specularFactor", 1);
        const dvec3 color = in.color("specularColorFactor", 1, kHuge);
        if (!shows) return;
        out_.specular = factor;
        if (!is_inert(in, factor == 0)) {
            out_.specular_color = color;
            out_.specular_texture = in.texture("specularTexture");
            if (!is_inert(in, color == dvec3(0))) out_.specular_color_texture = in.texture("specularColorTexture");
        }
        changes_ = changes_ || out_.specular != 1 || out_.specular_color != dvec3(1) ||
                   out_.specular_texture.present() || out_.specular_color_texture.present();
    }

    void transmission(bool shows)
    {
        Extension in = extension("KHR_materials_transmission");
        const double factor = in.factor("transmissionFactor", 0);
        if (!shows || is_inert(in, factor == 0)) return;
        out_.transmission = factor;
        out_.transmission_texture = in.texture("transmissionTexture");
        changes_ = true;
    }

    // Without transmission no light gets in.
    void volume()
    {
        Extension in = extension("KHR_materials_volume");
        const double thickness = in.real("thicknessFactor", 0, 0);
        const dvec3 color = in.color("attenuationColor", 1);
        double distance = in.real("attenuationDistance", kNever, -kHuge, kNever);
        if (!(distance > 0)) {
            in.warn("attenuationDistance",
                    fmt::format("{} is not above 0: nothing is absorbed [VALUE_NOT_IN_RANGE]", distance));
            distance = kNever;
        }
        const double dispersion = extension("KHR_materials_dispersion").real("dispersion", 0, 0);
        if (is_inert(in, out_.transmission == 0 || thickness == 0)) return;
        out_.thickness = thickness;
        out_.attenuation_color = color;
        out_.attenuation_distance = distance;
        out_.thickness_texture = in.texture("thicknessTexture");
        out_.dispersion = dispersion;
    }

    void diffuse_transmission(bool shows)
    {
        Extension in = extension("KHR_materials_diffuse_transmission");
        const double factor = in.factor("diffuseTransmissionFactor", 0);
        const dvec3 color = in.color("diffuseTransmissionColorFactor", 1);
        if (!shows || is_inert(in, factor == 0)) return;
        out_.diffuse_transmission = factor;
        out_.diffuse_transmission_color = color;
        out_.diffuse_transmission_texture = in.texture("diffuseTransmissionTexture");
        if (!is_inert(in, color == dvec3(0)))
            out_.diffuse_transmission_color_texture = in.texture("diffuseTransmissionColorTexture");
        changes_ = true;
    }

    void sheen()
    {
        Extension in = extension("KHR_materials_sheen");
        const dvec3 color = in.color("sheenColorFactor", 0);
        const double roughness = in.factor("sheenRoughnessFactor", 0);
        if (is_inert(in, color == dvec3(0))) return;
        out_.sheen_color = color;
        out_.sheen_roughness = roughness;
        out_.sheen_color_texture = in.texture("sheenColorTexture");
        if (!is_inert(in, roughness == 0)) out_.sheen_roughness_texture = in.texture("sheenRoughnessTexture");
        changes_ = true;
    }

    void clearcoat()
    {
        Extension in = extension("KHR_materials_clearcoat");
        const double factor = in.factor("clearcoatFactor", 0);
        const double roughness = in.factor("clearcoatRoughnessFactor", 0);
        const double scale = in.normal_scale("clearcoatNormalTexture");
        if (is_inert(in, factor == 0)) return;
        out_.clearcoat = factor;
        out_.clearcoat_roughness = roughness;
        out_.clearcoat_normal_scale = scale;
        out_.clearcoat_texture = in.texture("clearcoatTexture");
        if (!is_inert(in, roughness == 0)) out_.clearcoat_roughness_texture = in.texture("clearcoatRoughnessTexture");
        out_.clearcoat_normal_texture = in.texture("clearcoatNormalTexture");
        changes_ = true;
    }

    void iridescence()
    {
        Extension in = extension("KHR_materials_iridescence");
        const double factor = in.factor("iridescenceFactor", 0);
        const double ior = in.real("iridescenceIor", 1.3, 1);
        const double thinnest = in.real("iridescenceThicknessMinimum", 100, 0);
        const double thickest = in.real("iridescenceThicknessMaximum", 400, 0);
        if (is_inert(in, factor == 0)) return;
        const TextureUse thickness = in.texture("iridescenceThicknessTexture");
        if (is_inert(in, thickest == 0 && (thinnest == 0 || !thickness.present()))) return;  // no film
        out_.iridescence = factor;
        out_.iridescence_ior = ior;
        out_.iridescence_thickness_min = thinnest;
        out_.iridescence_thickness_max = thickest;
        out_.iridescence_texture = in.texture("iridescenceTexture");
        out_.iridescence_thickness_texture = thickness;
        changes_ = true;
    }

    void anisotropy()
    {
        Extension in = extension("KHR_materials_anisotropy");
        const double strength = in.factor("anisotropyStrength", 0);
        const double rotation = in.real("anisotropyRotation", 0);
        if (is_inert(in, strength == 0)) return;
        out_.anisotropy = strength;
        out_.anisotropy_rotation = rotation;
        out_.anisotropy_texture = in.texture("anisotropyTexture");
        changes_ = true;
    }

    const tinygltf::Material& in_;
    const std::string& pointer_;
    bool animated_;
    Textures& textures_;
    Scene& scene_;
    MaterialLayers out_;
    bool changes_ = false;
};

}  // namespace

bool apply_specular_glossiness(const tinygltf::Material& in, const std::string& pointer, Textures& textures,
                               Scene& scene, Material& out)
{
    Extension extension(in, pointer, "KHR_materials_pbrSpecularGlossiness", textures, scene);
    if (!extension.present()) return false;
    out.model = BsdfModel::specular_glossiness;
    out.metallic = 0;
    out.base_color = extension.color_and_alpha("diffuseFactor");
    out.base_color_texture = extension.texture("diffuseTexture");
    out.k = extension.color("specularFactor", 1);
    const double glossiness = extension.factor("glossinessFactor", 1);
    out.roughness = 1 - glossiness;
    if (out.k != dvec3(0) || glossiness > 0)
        out.metallic_roughness_texture = extension.texture("specularGlossinessTexture");
    return true;
}

std::optional<MaterialLayers> read_layers(const tinygltf::Material& in, const std::string& pointer,
                                          const Material& base, bool animated, Textures& textures, Scene& scene)
{
    return Layers(in, pointer, base, animated, textures, scene).result();
}

void warn_of_excluded_layers(const tinygltf::Material& in, const std::string& pointer, Scene& scene)
{
    for (const char* name : kLayerExtensions)
        if (member(in.extensions, name) != nullptr)
            scene.warnings.push_back(
                fmt::format("{}/extensions/{}: ignored, because the material is unlit or specular-glossiness "
                            "[MULTIPLE_EXTENSIONS]",
                            pointer, name));
}

}  // namespace etalon::gltf
