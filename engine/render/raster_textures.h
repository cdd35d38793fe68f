#pragma once
#include <map>
#include <tuple>
#include <utility>
#include <vector>

#include "engine/gpu/bindings.h"
#include "engine/render/raster_texels.h"
#include "engine/render/raster_variant.h"

namespace etalon {

/// The textures of a posed scene that its variants read, on a device. Each image is decoded once per coding.
class RasterTextures {
 public:
    /// `mipmaps`: with all levels; else level 0 alone is there. `filter`: instead of the samplers' own.
    RasterTextures(gpu::Device& device, const Scene& scene, bool mipmaps, TextureFilter filter, unsigned threads);

    /// Uploads what `variant` reads of `material`, unless it is there.
    void require(const Material& material, const RasterVariant& variant);
    /// What tells the sets of two materials apart: texture and coding, slot by slot.
    using Key = std::vector<std::pair<Index, Coding>>;
    static Key key(const Material& material, const RasterVariant& variant);
    /// Descriptor set 1 of surface.glsl for a material drawn by `variant`; what that does not read is one white texel.
    gpu::Bindings bind(const gpu::Layout& layout, const Material& material, const RasterVariant& variant) const;

 private:
    using ImageKey = std::pair<Index, Coding>;  // of Scene::images
    struct Slot;
    static std::vector<Slot> slots(const Material& material, const RasterVariant& variant);
    const gpu::Sampler& sampler(const Sampler& sampler);
    const gpu::Sampler* find_sampler(const Sampler& sampler) const;
    gpu::Image upload(const MipChain& chain, const std::string& name) const;

    gpu::Device& device_;
    const Scene& scene_;
    bool mipmaps_;
    TextureFilter filter_;
    unsigned threads_;
    std::map<ImageKey, gpu::Image> images_;
    std::vector<std::pair<gpu::SamplerSpec, gpu::Sampler>> samplers_;
    gpu::Image white_;
    gpu::Sampler white_sampler_;
};

}  // namespace etalon
