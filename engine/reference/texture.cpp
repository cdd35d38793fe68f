#include "engine/reference/texture.h"

#include <algorithm>
#include <cmath>

namespace etalon::reference {
namespace {

// (TX-5)
double linear_from_coded(double c)
{
    return c <= 0.04045 ? c / 12.92 : std::pow((c + 0.055) / 1.055, 2.4);
}

const std::array<double, 256>& linear_from_byte()
{
    static const std::array<double, 256> table = [] {
        std::array<double, 256> t{};
        for (std::size_t i = 0; i < t.size(); ++i) t[i] = linear_from_coded(static_cast<double>(i) / 255);
        return t;
    }();
    return table;
}

dvec4 average(const MipChain& source, int level, const BoxWeights::Tap* x, std::size_t nx, const BoxWeights::Tap* y,
              std::size_t ny)
{
    dvec4 sum(0);
    for (std::size_t j = 0; j < ny; ++j)
        for (std::size_t i = 0; i < nx; ++i)
            sum += x[i].weight * y[j].weight * source.texel(level, x[i].index, y[j].index);
    return sum;
}

}  // namespace

// (TX-4), (SH-41)
BoxWeights box_weights(int count, int target)
{
    BoxWeights weights;
    weights.taps.resize(static_cast<std::size_t>(target));
    const double scale = static_cast<double>(count) / target;
    for (int i = 0; i < target; ++i) {
        const double low = i * scale, high = (i + 1) * scale;
        const int last = std::min(count - 1, static_cast<int>(std::ceil(high)) - 1);
        for (int s = static_cast<int>(std::floor(low)); s <= last; ++s) {
            const double covered = std::min(high, s + 1.0) - std::max(low, static_cast<double>(s));
            if (covered > 0) weights.taps[static_cast<std::size_t>(i)].push_back({s, covered / scale});
        }
    }
    return weights;
}

MipChain::MipChain(const Texels& texels, Coding coding, bool all_levels) : texels_(&texels), coding_(coding)
{
    while (all_levels) {
        const ivec2 above = size(levels() - 1);
        if (above.x <= 1 && above.y <= 1) break;
        Level next{.size = ivec2(std::max(1, above.x / 2), std::max(1, above.y / 2)), .texels = {}};
        const BoxWeights wx = box_weights(above.x, next.size.x);
        const BoxWeights wy = box_weights(above.y, next.size.y);
        next.texels.reserve(static_cast<std::size_t>(next.size.x) * static_cast<std::size_t>(next.size.y));
        for (const auto& row : wy.taps)
            for (const auto& column : wx.taps)
                next.texels.push_back(
                    average(*this, levels() - 1, column.data(), column.size(), row.data(), row.size()));
        coarser_.push_back(std::move(next));
    }
}

ivec2 MipChain::size(int level) const
{
    return level == 0 ? ivec2(texels_->width, texels_->height) : coarser_[static_cast<std::size_t>(level - 1)].size;
}

namespace {

// (TX-7)
dvec4 made_unit(const dvec4& texel)
{
    const dvec3 n = 2.0 * dvec3(texel) - 1.0;
    const double size = length(n);
    return size > 0 && std::isfinite(size) ? dvec4(0.5 + 0.5 / size * n, texel.w) : texel;
}

}  // namespace

dvec4 MipChain::texel(int level, int x, int y) const
{
    const std::size_t at =
        static_cast<std::size_t>(y) * static_cast<std::size_t>(size(level).x) + static_cast<std::size_t>(x);
    if (level > 0) return coarser_[static_cast<std::size_t>(level - 1)].texels[at];
    if (texels_->is_8_bit) {
        const std::uint8_t* code = texels_->bytes.data() + 4 * at;
        const double alpha = code[3] / 255.0;
        const dvec4 plain(code[0] / 255.0, code[1] / 255.0, code[2] / 255.0, alpha);
        if (coding_ == Coding::normal) return made_unit(plain);
        if (coding_ == Coding::linear) return plain;
        const auto& decode = linear_from_byte();
        return {decode[code[0]], decode[code[1]], decode[code[2]], alpha};
    }
    const float* code = texels_->wide.data() + 4 * at;
    if (coding_ == Coding::normal) return made_unit({code[0], code[1], code[2], code[3]});
    if (coding_ == Coding::linear) return {code[0], code[1], code[2], code[3]};
    return {linear_from_coded(code[0]), linear_from_coded(code[1]), linear_from_coded(code[2]), code[3]};
}

// The integer is wrapped, not the coordinate: u = -1e-8 is the last texel, never one past it (T5).
int wrap_texel(long long i, int size, Wrap wrap)
{
    const long long n = size;
    switch (wrap) {
        case Wrap::clamp_to_edge:
            return static_cast<int>(std::clamp(i, 0LL, n - 1));
        case Wrap::mirrored_repeat: {
            const long long m = ((i % (2 * n)) + 2 * n) % (2 * n);
            return static_cast<int>(m < n ? m : 2 * n - 1 - m);
        }
        case Wrap::repeat:
            break;
    }
    return static_cast<int>(((i % n) + n) % n);
}

double mip_level(const dvec2& texels_dx, const dvec2& texels_dy, int levels)
{
    const double footprint = std::max(length(texels_dx), length(texels_dy));  // (TX-1)
    if (!std::isfinite(texels_dx.x + texels_dx.y + texels_dy.x + texels_dy.y)) return levels - 1;
    return footprint > 1 ? std::min(std::log2(footprint), levels - 1.0) : 0;  // (TX-2)
}

namespace {

// (TX-3) at one level.
dvec4 sample_level(const MipChain& mips, const Sampler& sampler, Filter filter, const dvec2& uv, int level)
{
    const ivec2 size = mips.size(level);
    // Far beyond any picture's reach, and the largest that a cast to an integer is sure to take (T7).
    const auto limited = [](double x) { return std::isfinite(x) ? std::clamp(x, -1e15, 1e15) : 0.0; };
    const double shift = filter == Filter::linear ? 0.5 : 0.0;
    const double x = limited(uv.x * size.x) - shift, y = limited(uv.y * size.y) - shift;
    const double fx = std::floor(x), fy = std::floor(y);
    const auto ix = static_cast<long long>(fx), iy = static_cast<long long>(fy);
    const auto fetch = [&](long long i, long long j) {
        return mips.texel(level, wrap_texel(i, size.x, sampler.wrap_u), wrap_texel(j, size.y, sampler.wrap_v));
    };
    if (filter == Filter::nearest) return fetch(ix, iy);
    const double wx = x - fx, wy = y - fy;
    return (1 - wy) * ((1 - wx) * fetch(ix, iy) + wx * fetch(ix + 1, iy)) +
           wy * ((1 - wx) * fetch(ix, iy + 1) + wx * fetch(ix + 1, iy + 1));
}

}  // namespace

dvec4 sample_mips(const MipChain& mips, const Sampler& sampler, const dvec2& uv, double level)
{
    if (!(level > 0)) return sample_level(mips, sampler, sampler.mag, uv, 0);
    if (!sampler.mipmapped || mips.levels() == 1) return sample_level(mips, sampler, sampler.min, uv, 0);
    const int last = mips.levels() - 1;
    if (sampler.mip == Filter::nearest) {
        const int nearest = std::min(last, static_cast<int>(std::ceil(level + 0.5)) - 1);  // Vulkan 1.3 §16.6
        return sample_level(mips, sampler, sampler.min, uv, nearest);
    }
    const int fine = std::min(last, static_cast<int>(std::floor(level)));
    const int coarse = std::min(last, fine + 1);
    const double blend = level - fine;
    const dvec4 a = sample_level(mips, sampler, sampler.min, uv, fine);
    if (blend == 0 || coarse == fine) return a;
    return (1 - blend) * a + blend * sample_level(mips, sampler, sampler.min, uv, coarse);
}

TextureSet::TextureSet(const Scene& scene, const std::vector<bool>& used, bool mipmaps) : scene_(&scene)
{
    by_texture_.resize(scene.textures.size(), {nullptr, nullptr, nullptr});
    const auto add = [&](const TextureUse& use, Coding coding) {
        if (!use.present() || use.texture >= scene.textures.size()) return;
        if (!used.empty() && !used[use.texture]) return;
        const Texture& texture = scene.textures[use.texture];
        if (texture.image >= scene.images.size()) return;
        const Texels& texels = scene.images[texture.image];
        if (texels.width < 1 || texels.height < 1) return;
        const auto found = chains_.try_emplace({texture.image, coding}, texels, coding, mipmaps).first;
        by_texture_[use.texture][static_cast<std::size_t>(coding)] = &found->second;
    };
    for (const Material& material : scene.materials) {
        add(material.base_color_texture, Coding::srgb);
        add(material.emissive_texture, Coding::srgb);
        add(material.metallic_roughness_texture,
            material.model == BsdfModel::specular_glossiness ? Coding::srgb : Coding::linear);
        add(material.normal_texture, Coding::linear);
        add(material.normal_texture, Coding::normal);
        add(material.occlusion_texture, Coding::linear);
        if (!material.layers) continue;
        const MaterialLayers& layers = *material.layers;
        add(layers.clearcoat_normal_texture, Coding::normal);
        for (const TextureUse* use :
             {&layers.specular_color_texture, &layers.sheen_color_texture, &layers.diffuse_transmission_color_texture})
            add(*use, Coding::srgb);
        for (const TextureUse* use :
             {&layers.specular_texture, &layers.clearcoat_texture, &layers.clearcoat_roughness_texture,
              &layers.clearcoat_normal_texture, &layers.sheen_roughness_texture, &layers.transmission_texture,
              &layers.thickness_texture, &layers.iridescence_texture, &layers.iridescence_thickness_texture,
              &layers.anisotropy_texture, &layers.diffuse_transmission_texture})
            add(*use, Coding::linear);
    }
}

Probes probes_along(const dvec2& texels_dx, const dvec2& texels_dy, int most)
{
    const bool across = length(texels_dx) >= length(texels_dy);
    Probes out{.axis = across ? texels_dx : texels_dy};
    const double longer = length(out.axis), shorter = length(across ? texels_dy : texels_dx);
    if (!std::isfinite(longer) || !std::isfinite(shorter) || !(longer > 0)) return out;
    // A thousandth less, so that footprints of a whole ratio have as many probes in any arithmetic.
    out.count = shorter > 0 ? static_cast<int>(std::min(std::ceil(0.999 * longer / shorter), double(most))) : most;
    out.count = std::max(out.count, 1);
    return out;
}

void TextureSet::read_by(TextureFilter filter, int most_probes)
{
    filter_ = filter;
    most_probes_ = most_probes;
}

namespace {

Sampler filtered_by(TextureFilter filter, Sampler sampler)
{
    if (filter == TextureFilter::file) return sampler;
    sampler.mipmapped = true;
    sampler.mip = filter == TextureFilter::trilinear ? Filter::linear : Filter::nearest;
    sampler.min = sampler.mag = filter == TextureFilter::nearest ? Filter::nearest : Filter::linear;
    return sampler;
}

}  // namespace

dvec4 TextureSet::sample(const TextureUse& use, Coding coding, const TexturePoint& at) const
{
    if (!use.present() || use.texture >= by_texture_.size()) return dvec4(1);
    const MipChain* mips = by_texture_[use.texture][static_cast<std::size_t>(coding)];
    if (mips == nullptr) return dvec4(1);
    const Sampler sampler = filtered_by(filter_, scene_->textures[use.texture].sampler);
    const auto set = static_cast<std::size_t>(use.uv_set == 1 ? 1 : 0);
    const dvec3 uv = use.transform * dvec3(at.uv[set], 1);
    if (!at.has_footprint) return sample_mips(*mips, sampler, dvec2(uv), 0);
    const dvec2 size(mips->size(0));
    const dmat3& m = use.transform;
    const dvec2 dx = dvec2(m * dvec3(at.uv_dx[set], 0)) * size;
    const dvec2 dy = dvec2(m * dvec3(at.uv_dy[set], 0)) * size;
    // Without levels the footprint still chooses between the two filters, hence at least 2 levels here.
    const int levels = std::max(2, mips->levels());
    const Probes probes = probes_along(dx, dy, most_probes_);
    if (probes.count == 1) return sample_mips(*mips, sampler, dvec2(uv), mip_level(dx, dy, levels));
    const dvec2 step = probes.axis / static_cast<double>(probes.count);
    dvec4 sum(0);
    for (int i = 1; i <= probes.count; ++i) {
        const dvec2 probe = dvec2(uv) + (i / (probes.count + 1.0) - 0.5) * probes.axis / size;
        sum += sample_mips(*mips, sampler, probe, mip_level(step, step, levels));
    }
    return sum / static_cast<double>(probes.count);
}

double TextureSet::level(const TextureUse& use, Coding coding, const TexturePoint& at) const
{
    if (!use.present() || use.texture >= by_texture_.size() || !at.has_footprint) return 0;
    const MipChain* mips = by_texture_[use.texture][static_cast<std::size_t>(coding)];
    if (mips == nullptr) return 0;
    const auto set = static_cast<std::size_t>(use.uv_set == 1 ? 1 : 0);
    const dvec2 size(mips->size(0));
    const dvec2 dx = dvec2(use.transform * dvec3(at.uv_dx[set], 0)) * size;
    const dvec2 dy = dvec2(use.transform * dvec3(at.uv_dy[set], 0)) * size;
    return mip_level(dx, dy, std::max(2, mips->levels()));
}

}  // namespace etalon::reference
