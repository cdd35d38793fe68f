#pragma once
// Inside engine/gpu only: buffers, images and samplers of OpenGL.
#include <vector>

#include "engine/gl/handle.h"
#include "engine/gpu/buffer.h"
#include "engine/gpu/gl_device.h"
#include "engine/gpu/gl_format.h"
#include "engine/gpu/image.h"

namespace etalon::gpu {

/// Bytes counted against the device's budget while this lives.
class GlReservation {
 public:
    GlReservation(GlDevice& device, std::uint64_t bytes, const std::string& what) : device_(device), bytes_(bytes)
    {
        device.reserve(bytes, what);
    }
    GlReservation(const GlReservation&) = delete;
    GlReservation& operator=(const GlReservation&) = delete;
    ~GlReservation() { device_.release(bytes_); }

 private:
    GlDevice& device_;
    std::uint64_t bytes_;
};

/// A buffer. What the host sees of it (upload, readback) is a copy of its own: written to the device when it is used,
/// read from there when what wrote it is done.
class GlBuffer {
 public:
    GlBuffer(GlDevice& device, const BufferSpec& spec, std::uint64_t size);

    GlDevice& device() const { return device_; }
    std::uint64_t size() const { return size_; }
    std::span<std::byte> host() { return host_; }
    GLuint name() const { return buffer_.get(); }

    void write(std::span<const std::byte> bytes, std::uint64_t offset);
    void read(std::span<std::byte> bytes, std::uint64_t offset) const;
    /// Before the device reads it: what the host wrote goes there.
    void send();
    /// After the device was told to write it.
    void touch() { ++version_; }
    /// When the device is done: what it wrote comes to the host.
    void fetch();
    bool is_readback() const { return kind_ == MemoryKind::readback; }

    /// Its bytes by another layout; made anew when they have changed. `layout` is interned.
    struct Laid {
        GLuint name = 0;
        std::uint64_t size = 0;
    };
    Laid laid_out(const BlockLayout& layout);

 private:
    struct Relaid {
        const BlockLayout* layout = nullptr;
        std::uint64_t version = 0;
        std::uint64_t size = 0;
        gl::Buffer buffer;
    };

    GlDevice& device_;
    GlReservation reserved_;
    MemoryKind kind_;
    std::uint64_t size_;
    std::uint64_t version_ = 1;
    gl::Buffer buffer_;
    std::vector<std::byte> host_;
    std::vector<Relaid> relaid_;
};

class GlImage {
 public:
    GlImage(GlDevice& device, const ImageSpec& spec);

    GLuint name() const { return texture_.get(); }
    const GlFormat& format() const { return format_; }
    bool is_array() const { return array_; }

 private:
    GlReservation reserved_;
    GlFormat format_;
    bool array_;
    gl::Texture texture_;
};

class GlSampler {
 public:
    GlSampler(GlDevice& device, const SamplerSpec& spec);
    GLuint name() const { return sampler_.get(); }

 private:
    gl::Sampler sampler_;
};

gl::Buffer make_gl_buffer(GlDevice& device, std::span<const std::byte> bytes);

}  // namespace etalon::gpu
