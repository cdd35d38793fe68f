#include "engine/gpu/gl_resources.h"

#include <fmt/format.h>

#include <algorithm>

namespace etalon::gpu {
namespace {

GLenum wrap(VkSamplerAddressMode mode)
{
    switch (mode) {
        case VK_SAMPLER_ADDRESS_MODE_MIRRORED_REPEAT:
            return GL_MIRRORED_REPEAT;
        case VK_SAMPLER_ADDRESS_MODE_CLAMP_TO_EDGE:
            return GL_CLAMP_TO_EDGE;
        case VK_SAMPLER_ADDRESS_MODE_CLAMP_TO_BORDER:
            return GL_CLAMP_TO_BORDER;
        default:
            return GL_REPEAT;
    }
}

GLint minify(const SamplerSpec& spec)
{
    const bool linear = spec.minify == VK_FILTER_LINEAR;
    if (spec.mipmap == VK_SAMPLER_MIPMAP_MODE_LINEAR)
        return linear ? GL_LINEAR_MIPMAP_LINEAR : GL_NEAREST_MIPMAP_LINEAR;
    return linear ? GL_LINEAR_MIPMAP_NEAREST : GL_NEAREST_MIPMAP_NEAREST;
}

std::uint64_t bytes_of(const ImageSpec& spec)
{
    std::uint64_t texels = 0;
    for (std::uint32_t mip = 0; mip < spec.mips; ++mip)
        texels += std::uint64_t{std::max(1u, spec.width >> mip)} * std::max(1u, spec.height >> mip);
    return texels * spec.layers * spec.samples * texel_size(spec.format);
}

}  // namespace

gl::Buffer make_gl_buffer(GlDevice& device, std::span<const std::byte> bytes)
{
    GLuint name = 0;
    device.gl().CreateBuffers(1, &name);
    gl::Buffer buffer(device.gl(), name);
    device.gl().NamedBufferStorage(name, static_cast<GLsizeiptr>(bytes.size()), bytes.data(), GL_DYNAMIC_STORAGE_BIT);
    gl::check(device.gl(), "glNamedBufferStorage");
    return buffer;
}

GlBuffer::GlBuffer(GlDevice& device, const BufferSpec& spec, std::uint64_t size)
    : device_(device), reserved_(device, size, spec.name), kind_(spec.memory), size_(size)
{
    if (kind_ != MemoryKind::device) host_.resize(size);
    GLuint name = 0;
    device.gl().CreateBuffers(1, &name);
    buffer_ = {device.gl(), name};
    device.gl().NamedBufferStorage(name, static_cast<GLsizeiptr>(size), nullptr, GL_DYNAMIC_STORAGE_BIT);
    gl::check(device.gl(), "glNamedBufferStorage");
}

void GlBuffer::write(std::span<const std::byte> bytes, std::uint64_t offset)
{
    device_.gl().NamedBufferSubData(name(), static_cast<GLintptr>(offset), static_cast<GLsizeiptr>(bytes.size()),
                                    bytes.data());
    touch();
}

void GlBuffer::read(std::span<std::byte> bytes, std::uint64_t offset) const
{
    device_.gl().GetNamedBufferSubData(name(), static_cast<GLintptr>(offset), static_cast<GLsizeiptr>(bytes.size()),
                                       bytes.data());
}

void GlBuffer::send()
{
    if (kind_ == MemoryKind::upload) write(host_, 0);
}

void GlBuffer::fetch()
{
    if (kind_ == MemoryKind::readback) read(host_, 0);
}

GlBuffer::Laid GlBuffer::laid_out(const BlockLayout& layout)
{
    auto known = std::find_if(relaid_.begin(), relaid_.end(), [&](const Relaid& r) { return r.layout == &layout; });
    if (known == relaid_.end()) known = relaid_.insert(known, Relaid{.layout = &layout, .buffer = {}});
    if (known->version == version_) return {known->buffer.get(), known->size};
    std::vector<std::byte> bytes(size_);
    if (kind_ == MemoryKind::upload)
        std::copy(host_.begin(), host_.end(), bytes.begin());
    else
        read(bytes, 0);
    std::vector<std::byte> laid = layout.apply(bytes);
    laid.resize(std::max<std::size_t>(laid.size(), layout.to_fixed + layout.to_stride));  // a block of nothing is none
    known->buffer = make_gl_buffer(device_, laid);
    known->size = laid.size();
    known->version = version_;
    return {known->buffer.get(), known->size};
}

GlImage::GlImage(GlDevice& device, const ImageSpec& spec)
    : reserved_(device, bytes_of(spec), spec.name),
      format_(gl_format(spec.format)),
      array_(spec.array || spec.layers > 1)
{
    const DeviceLimits& limits = device.limits();
    if (std::max(spec.width, spec.height) > limits.image_side || spec.layers > limits.image_layers)
        throw Error(
            Blame::machine,
            fmt::format("image \"{}\" of {}x{} in {} layers; this device allows {}x{} in {}", spec.name, spec.width,
                        spec.height, spec.layers, limits.image_side, limits.image_side, limits.image_layers),
            "use a smaller picture or texture");
    if (!device.supports(spec.format, spec.samples) || (array_ && spec.samples > 1))
        throw Error(Blame::machine, fmt::format("image \"{}\": this device cannot use format {} with {} samples",
                                                spec.name, static_cast<int>(spec.format), spec.samples));
    const gl::Functions& gl = device.gl();
    const auto width = static_cast<GLsizei>(spec.width), height = static_cast<GLsizei>(spec.height);
    const auto mips = static_cast<GLsizei>(spec.mips);
    GLuint name = 0;
    gl.CreateTextures(spec.samples > 1 ? GL_TEXTURE_2D_MULTISAMPLE
                      : array_         ? GL_TEXTURE_2D_ARRAY
                                       : GL_TEXTURE_2D,
                      1, &name);
    texture_ = {gl, name};
    if (spec.samples > 1)
        gl.TextureStorage2DMultisample(name, static_cast<GLsizei>(spec.samples), format_.internal, width, height,
                                       GL_TRUE);
    else if (array_)
        gl.TextureStorage3D(name, mips, format_.internal, width, height, static_cast<GLsizei>(spec.layers));
    else
        gl.TextureStorage2D(name, mips, format_.internal, width, height);
    if (spec.samples == 1) {  // read by texel where no sampler says otherwise; integers and floats are complete then
        gl.TextureParameteri(name, GL_TEXTURE_MIN_FILTER, GL_NEAREST_MIPMAP_NEAREST);
        gl.TextureParameteri(name, GL_TEXTURE_MAG_FILTER, GL_NEAREST);
    }
    gl::check(gl, "glTextureStorage");
}

GlSampler::GlSampler(GlDevice& device, const SamplerSpec& spec)
{
    const gl::Functions& gl = device.gl();
    GLuint name = 0;
    gl.CreateSamplers(1, &name);
    sampler_ = {gl, name};
    gl.SamplerParameteri(name, GL_TEXTURE_MAG_FILTER, spec.magnify == VK_FILTER_LINEAR ? GL_LINEAR : GL_NEAREST);
    gl.SamplerParameteri(name, GL_TEXTURE_MIN_FILTER, minify(spec));
    gl.SamplerParameteri(name, GL_TEXTURE_WRAP_S, static_cast<GLint>(wrap(spec.wrap_u)));
    gl.SamplerParameteri(name, GL_TEXTURE_WRAP_T, static_cast<GLint>(wrap(spec.wrap_v)));
    gl.SamplerParameteri(name, GL_TEXTURE_WRAP_R, GL_CLAMP_TO_EDGE);
    gl.SamplerParameterf(name, GL_TEXTURE_MIN_LOD, 0);
    gl.SamplerParameterf(name, GL_TEXTURE_MAX_LOD, spec.max_lod);
    constexpr GLenum kAnisotropy = 0x84FE;  // GL_TEXTURE_MAX_ANISOTROPY, core in 4.6
    const float anisotropy = std::min(spec.anisotropy, device.limits().anisotropy);
    if (anisotropy > 1) gl.SamplerParameterf(name, kAnisotropy, anisotropy);
    gl::check(gl, "glSamplerParameter");
}

}  // namespace etalon::gpu
