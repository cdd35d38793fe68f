#include "engine/gpu/gl_device.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <string_view>

#include "engine/base/memory.h"
#include "engine/gl/handle.h"
#include "engine/gpu/device_state.h"
#include "engine/gpu/gl_format.h"

namespace etalon::gpu {
namespace {

GLint integer(const gl::Functions& gl, GLenum what)
{
    GLint value = 0;
    gl.GetIntegerv(what, &value);
    return value;
}

std::uint32_t limit(const gl::Functions& gl, GLenum what)
{
    return static_cast<std::uint32_t>(std::max(integer(gl, what), 0));
}

bool has_extension(const gl::Functions& gl, std::string_view wanted)
{
    for (GLuint i = 0; i < limit(gl, GL_NUM_EXTENSIONS); ++i)
        if (reinterpret_cast<const char*>(gl.GetStringi(GL_EXTENSIONS, i)) == wanted) return true;
    return false;
}

/// Bit n: 2^n samples a pixel.
std::uint32_t samples_of(const gl::Functions& gl, GLenum format)
{
    std::array<GLint, 16> counts{};
    gl.GetInternalformativ(GL_TEXTURE_2D_MULTISAMPLE, format, GL_SAMPLES, static_cast<GLsizei>(counts.size()),
                           counts.data());
    std::uint32_t bits = 1;
    for (const GLint count : counts) bits |= count > 0 ? static_cast<std::uint32_t>(count) : 0;
    return bits;
}

/// Vulkan's standard positions of 2, 4, 8 and 16 samples (1.3, §25.3), x and y in sixteenths of a pixel; those of n
/// begin at n - 2. Shaders rely on them.
constexpr std::array<std::array<int, 2>, 30> kStandardSamples{{
    {12, 12}, {4, 4},                                                            // 2
    {6, 2},   {14, 6}, {2, 10}, {10, 14},                                        // 4
    {9, 5},   {7, 11}, {13, 9}, {5, 3},   {3, 13}, {1, 7},   {11, 15}, {15, 1},  // 8
    {9, 9},   {7, 5},  {5, 10}, {12, 7},  {3, 6},  {10, 13}, {13, 11}, {11, 3},  // 16
    {6, 14},  {8, 1},  {4, 2},  {2, 12},  {0, 8},  {15, 4},  {14, 15}, {1, 0},
}};

/// Whether targets of so many samples a pixel take them where Vulkan does.
bool samples_where_vulkan_does(const gl::Functions& gl, GLsizei samples)
{
    GLuint name = 0;
    gl.CreateTextures(GL_TEXTURE_2D_MULTISAMPLE, 1, &name);
    const gl::Texture texture(gl, name);
    gl.TextureStorage2DMultisample(name, samples, GL_RGBA32F, 1, 1, GL_TRUE);
    gl.CreateFramebuffers(1, &name);
    const gl::Framebuffer framebuffer(gl, name);
    gl.NamedFramebufferTexture(name, GL_COLOR_ATTACHMENT0, texture.get(), 0);
    gl.BindFramebuffer(GL_FRAMEBUFFER, name);
    bool same = true;
    const auto count = static_cast<std::size_t>(samples);
    for (std::size_t i = 0; i < count; ++i) {
        GLfloat at[2] = {};
        gl.GetMultisamplefv(GL_SAMPLE_POSITION, static_cast<GLuint>(i), at);
        for (std::size_t axis = 0; axis < 2; ++axis)
            same &= at[axis] * 16 == static_cast<float>(kStandardSamples[count - 2 + i][axis]);
    }
    gl.BindFramebuffer(GL_FRAMEBUFFER, 0);
    return same;
}

DeviceLimits query_limits(const gl::Functions& gl)
{
    DeviceLimits limits;
    GLint64 range = 0;
    gl.GetInteger64v(GL_MAX_SHADER_STORAGE_BLOCK_SIZE, &range);
    limits.storage_buffer_range = static_cast<std::uint64_t>(range);
    limits.uniform_buffer_range = limit(gl, GL_MAX_UNIFORM_BLOCK_SIZE);
    limits.buffer_size = limits.allocation = std::uint64_t{1} << 31;  // what a GLsizei of texels and most drivers allow
    limits.image_side = std::min(limit(gl, GL_MAX_TEXTURE_SIZE), limit(gl, GL_MAX_FRAMEBUFFER_WIDTH));
    limits.image_layers = limit(gl, GL_MAX_ARRAY_TEXTURE_LAYERS);
    limits.push_constants = 128;
    limits.sampled_images_per_stage = limit(gl, GL_MAX_TEXTURE_IMAGE_UNITS);
    limits.storage_buffers_per_stage = limit(gl, GL_MAX_FRAGMENT_SHADER_STORAGE_BLOCKS);
    limits.storage_images_per_stage = limit(gl, GL_MAX_COMPUTE_IMAGE_UNIFORMS);
    for (GLuint axis = 0; axis < 3; ++axis) {
        GLint value = 0;
        gl.GetIntegeri_v(GL_MAX_COMPUTE_WORK_GROUP_COUNT, axis, &value);
        limits.workgroup_count[axis] = static_cast<std::uint32_t>(value);
        gl.GetIntegeri_v(GL_MAX_COMPUTE_WORK_GROUP_SIZE, axis, &value);
        limits.workgroup_size[axis] = static_cast<std::uint32_t>(value);
    }
    limits.workgroup_invocations = limit(gl, GL_MAX_COMPUTE_WORK_GROUP_INVOCATIONS);
    limits.workgroup_memory = limit(gl, GL_MAX_COMPUTE_SHARED_MEMORY_SIZE);
    limits.samples = samples_of(gl, GL_RGBA32F) & samples_of(gl, GL_DEPTH_COMPONENT32F) & 31;
    for (std::uint32_t count = 2; count <= 16; count *= 2)
        if ((limits.samples & count) != 0 && !samples_where_vulkan_does(gl, static_cast<GLsizei>(count)))
            limits.samples &= ~count;
    limits.subpixel_bits = limit(gl, GL_SUBPIXEL_BITS);
    if (has_extension(gl, "GL_EXT_texture_filter_anisotropic") ||
        has_extension(gl, "GL_ARB_texture_filter_anisotropic")) {
        constexpr GLenum kMaxAnisotropy = 0x84FF;  // GL_MAX_TEXTURE_MAX_ANISOTROPY, core in 4.6
        gl.GetFloatv(kMaxAnisotropy, &limits.anisotropy);
    }
    limits.timestamp_ns = 1;
    limits.primitive_id = true;
    limits.wireframe = true;
    GLfloat widths[2] = {1, 1};
    gl.GetFloatv(GL_ALIASED_LINE_WIDTH_RANGE, widths);
    limits.wide_lines = widths[1] > 1;
    return limits;
}

bool is_software(const std::string& renderer)
{
    return renderer.find("llvmpipe") != std::string::npos || renderer.find("softpipe") != std::string::npos;
}

DeviceReport describe(const gl::Context& context, unsigned index)
{
    const bool software = is_software(context.renderer());
    return {.index = index,
            .name = fmt::format("{}, {}", context.renderer(), name(context.kind())),
            .kind = software ? DeviceKind::cpu : DeviceKind::gpu,
            .type = software ? "cpu" : "other",
            .driver = context.vendor(),
            .api_version = context.version(),
            .memory = software ? memory_of_machine() : 0};
}

std::string lower(std::string text)
{
    for (char& c : text) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
    return text;
}

void judge(const DeviceOptions& options, DeviceReport& report)
{
    const bool named = options.device.empty() || options.device == std::to_string(report.index) ||
                       lower(report.name).find(lower(options.device)) != std::string::npos;
    if (!named) report.reasons.push_back(fmt::format("is not the device \"{}\" that was asked for", options.device));
    if (options.kind && *options.kind != report.kind)
        report.reasons.push_back(fmt::format("is a {} device; a {} was asked for", report.type, name(*options.kind)));
}

/// Makes a context and says what it is; null with the reason where there is none.
std::unique_ptr<gl::Context> attempt(const gl::ContextOptions& options, unsigned index, DeviceReport& report)
{
    try {
        check_address_space(name(options.kind));
        auto context = std::make_unique<gl::Context>(options);
        report = describe(*context, index);
        return context;
    } catch (const Error& error) {
        // What is missing here need not be missing elsewhere: the next way is tried, and all reasons are told at the
        // end.
        report.index = index;
        report.name = name(options.kind);
        report.type = "none";
        report.reasons.push_back(error.message());
        return nullptr;
    }
}

void prefer(const DeviceReport& best, DeviceReport& report)
{
    if (report.reasons.empty())
        report.reasons.push_back(fmt::format("would do, but device {} ({}) comes first", best.index, best.name));
}

}  // namespace

std::vector<DeviceReport> list_gl_devices(const DeviceOptions& options)
{
    std::vector<DeviceReport> reports;
    const DeviceReport* best = nullptr;
    reports.reserve(std::size(gl::kContextKinds));
    for (const gl::ContextKind kind : gl::kContextKinds) {
        DeviceReport& report = reports.emplace_back();
        if (attempt({.kind = kind, .on_message = {}}, static_cast<unsigned>(reports.size() - 1), report))
            judge(options, report);
        if (best != nullptr)
            prefer(*best, report);
        else if (report.reasons.empty()) {
            report.chosen = true;
            best = &report;
        }
    }
    return reports;
}

GlDevice::GlDevice(const DeviceOptions& options) : validating_(options.validate)
{
    if (options.make_surface)
        throw Error(Blame::input, "windows are drawn to by Vulkan alone, not by OpenGL", "leave out --backend opengl");
    std::string reasons;
    for (const gl::ContextKind kind : gl::kContextKinds) {
        DeviceReport& report = candidates_.emplace_back();
        gl::ContextOptions wanted{.kind = kind, .on_message = {}};
        if (validating_)
            wanted.on_message = [this, heard = options.on_message](const std::string& message) {
                const std::lock_guard lock(messages_mutex_);
                messages_.push_back(message);
                if (heard) heard(message);
            };
        context_ = attempt(wanted, static_cast<unsigned>(candidates_.size() - 1), report);
        if (context_) judge(options, report);
        if (report.reasons.empty()) {
            report.chosen = true;
            report_ = report;
            break;
        }
        context_.reset();
        reasons += fmt::format("{} {}: {}", reasons.empty() ? "" : ";", report.name, fmt::join(report.reasons, ", "));
    }
    if (!context_)
        throw Error(Blame::machine, "no OpenGL context of this machine will do:" + reasons,
                    "see what there is with `etalon info`; on Debian: apt install libegl1 libegl-mesa0");
    limits_ = query_limits(gl());
    memory_.budget = options.memory_budget.value_or(memory_of_machine() / 4 * 3);
    set_up();
}

GlDevice::~GlDevice()
{
    if (last_ != nullptr) gl().DeleteSync(last_);
}

/// What Vulkan does always and OpenGL when told.
void GlDevice::set_up()
{
    gl().ClipControl(GL_LOWER_LEFT, GL_ZERO_TO_ONE);
    gl().ProvokingVertex(GL_FIRST_VERTEX_CONVENTION);
    gl().Enable(GL_SCISSOR_TEST);
    gl().Enable(GL_PROGRAM_POINT_SIZE);
    gl().Enable(GL_FRAMEBUFFER_SRGB);
    gl().Disable(GL_DITHER);
    gl().PixelStorei(GL_PACK_ALIGNMENT, 1);
    gl().PixelStorei(GL_UNPACK_ALIGNMENT, 1);
    gl::check(gl(), "setting up OpenGL");
}

bool GlDevice::supports(VkFormat format, std::uint32_t samples) const
{
    const auto found = find_gl_format(format);
    return found && (samples == 1 || (samples_of(gl(), found->internal) & samples) != 0);
}

void GlDevice::reserve(std::uint64_t bytes, const std::string& what)
{
    const std::uint64_t room = memory_.budget - std::min(memory_.budget, memory_.held);
    if (bytes > room)
        throw Error(Blame::machine,
                    fmt::format("\"{}\" needs {} MiB of device memory, but {} of a budget of {} MiB are left", what,
                                (bytes >> 20) + 1, room >> 20, memory_.budget >> 20),
                    "render a smaller picture or scene");
    memory_.in_use = memory_.held += bytes;
}

Ticket GlDevice::submitted()
{
    if (last_ != nullptr) gl().DeleteSync(last_);
    last_ = gl().FenceSync(GL_SYNC_GPU_COMMANDS_COMPLETE, 0);
    gl().Flush();
    return ++tickets_;
}

// Work is done in order, and its last piece is the one that is looked at: a little longer than asked, never shorter.
void GlDevice::wait(Ticket, std::chrono::milliseconds timeout) const
{
    if (last_ == nullptr) return;
    const auto nanoseconds = std::chrono::duration_cast<std::chrono::nanoseconds>(timeout).count();
    const GLenum result =
        gl().ClientWaitSync(last_, GL_SYNC_FLUSH_COMMANDS_BIT, static_cast<GLuint64>(std::max<long>(0, nanoseconds)));
    if (result == GL_TIMEOUT_EXPIRED)
        throw Error(Blame::machine,
                    fmt::format("the device {} did not finish its work within {:.1f} s", report_.name,
                                static_cast<double>(timeout.count()) / 1000),
                    "try a smaller picture, or another device (see etalon info)");
    gl::check(gl(), "glClientWaitSync");
}

bool GlDevice::finished(Ticket) const
{
    return last_ == nullptr || gl().ClientWaitSync(last_, 0, 0) != GL_TIMEOUT_EXPIRED;
}

std::vector<std::string> GlDevice::messages() const
{
    const std::lock_guard lock(messages_mutex_);
    return messages_;
}

const BlockLayout& GlDevice::intern(const BlockLayout& layout)
{
    const auto known = std::find(layouts_.begin(), layouts_.end(), layout);
    return known != layouts_.end() ? *known : layouts_.emplace_back(layout);
}

}  // namespace etalon::gpu
