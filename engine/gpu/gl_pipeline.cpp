#include "engine/gpu/gl_pipeline.h"

#include <fmt/format.h>

#include <algorithm>

#include "engine/gpu/gl_format.h"

namespace etalon::gpu {
namespace {

gl::Shader compile(GlDevice& device, GLenum stage, const std::string& code, const std::string& pipeline)
{
    const gl::Functions& gl = device.gl();
    gl::Shader shader(gl, gl.CreateShader(stage));
    const GLchar* text = code.c_str();
    gl.ShaderSource(shader.get(), 1, &text, nullptr);
    gl.CompileShader(shader.get());
    GLint done = GL_FALSE;
    gl.GetShaderiv(shader.get(), GL_COMPILE_STATUS, &done);
    if (done == GL_TRUE) return shader;
    std::string log(4096, '\0');
    GLsizei length = 0;
    gl.GetShaderInfoLog(shader.get(), static_cast<GLsizei>(log.size()), &length, log.data());
    log.resize(static_cast<std::size_t>(length));
    throw Error(Blame::machine, fmt::format("the OpenGL driver refuses a shader of \"{}\": {}", pipeline, log),
                "render with --backend vulkan");
}

GLenum compare(VkCompareOp op)
{
    switch (op) {
        case VK_COMPARE_OP_NEVER:
            return GL_NEVER;
        case VK_COMPARE_OP_LESS:
            return GL_LESS;
        case VK_COMPARE_OP_EQUAL:
            return GL_EQUAL;
        case VK_COMPARE_OP_LESS_OR_EQUAL:
            return GL_LEQUAL;
        case VK_COMPARE_OP_GREATER:
            return GL_GREATER;
        case VK_COMPARE_OP_NOT_EQUAL:
            return GL_NOTEQUAL;
        case VK_COMPARE_OP_GREATER_OR_EQUAL:
            return GL_GEQUAL;
        default:
            return GL_ALWAYS;
    }
}

GLenum topology(VkPrimitiveTopology topology)
{
    switch (topology) {
        case VK_PRIMITIVE_TOPOLOGY_POINT_LIST:
            return GL_POINTS;
        case VK_PRIMITIVE_TOPOLOGY_LINE_LIST:
            return GL_LINES;
        case VK_PRIMITIVE_TOPOLOGY_LINE_STRIP:
            return GL_LINE_STRIP;
        case VK_PRIMITIVE_TOPOLOGY_TRIANGLE_STRIP:
            return GL_TRIANGLE_STRIP;
        case VK_PRIMITIVE_TOPOLOGY_TRIANGLE_FAN:
            return GL_TRIANGLE_FAN;
        default:
            return GL_TRIANGLES;
    }
}

}  // namespace

GlPipeline::GlPipeline(GlDevice& device, const ComputePipelineSpec& spec)
{
    GlUnits units;
    const GlStage stage = translate(spec.shader, units);
    const gl::Shader shader = compile(device, GL_COMPUTE_SHADER, stage.code, spec.name);
    link(device, std::span(&shader, 1), spec.name);
    add_resources(device, stage);
}

GlPipeline::GlPipeline(GlDevice& device, const GraphicsPipelineSpec& spec)
    : depth_(spec.depth), topology_(gpu::topology(spec.topology)), wireframe_(spec.wireframe), graphics_(true)
{
    GlUnits units;
    const GlStage vertex = translate(spec.vertex, units);
    const GlStage fragment = translate(spec.fragment, units);
    const gl::Shader shaders[] = {compile(device, GL_VERTEX_SHADER, vertex.code, spec.name),
                                  compile(device, GL_FRAGMENT_SHADER, fragment.code, spec.name)};
    link(device, shaders, spec.name);
    add_resources(device, vertex);
    add_resources(device, fragment);
    set_vertices(device, spec);
    for (const ColorFormat& color : spec.colors) blends_.push_back(color.blend);
}

void GlPipeline::link(GlDevice& device, std::span<const gl::Shader> shaders, const std::string& name)
{
    const gl::Functions& gl = device.gl();
    program_ = {gl, gl.CreateProgram()};
    for (const gl::Shader& shader : shaders) gl.AttachShader(program_.get(), shader.get());
    gl.LinkProgram(program_.get());
    GLint done = GL_FALSE;
    gl.GetProgramiv(program_.get(), GL_LINK_STATUS, &done);
    if (done == GL_TRUE) return;
    std::string log(4096, '\0');
    GLsizei length = 0;
    gl.GetProgramInfoLog(program_.get(), static_cast<GLsizei>(log.size()), &length, log.data());
    log.resize(static_cast<std::size_t>(length));
    throw Error(Blame::machine, fmt::format("the OpenGL driver cannot link \"{}\": {}", name, log),
                "render with --backend vulkan");
}

void GlPipeline::add_resources(GlDevice& device, const GlStage& stage)
{
    for (const GlResource& found : stage.resources) {
        const auto same = std::find_if(resources_.begin(), resources_.end(), [&](const GlResource& other) {
            return other.kind == found.kind && other.unit == found.unit;
        });
        if (same != resources_.end()) {
            assume(same->layout == found.layout);  // by the same rules from the same declaration
            same->writes |= found.writes;
            continue;
        }
        resources_.push_back(found);
        layouts_.push_back(found.layout.is_identity() ? nullptr : &device.intern(found.layout));
    }
}

void GlPipeline::set_vertices(GlDevice& device, const GraphicsPipelineSpec& spec)
{
    const gl::Functions& gl = device.gl();
    GLuint name = 0;
    gl.CreateVertexArrays(1, &name);
    vertices_ = {gl, name};
    for (const VertexStream& stream : spec.streams) {
        gl.VertexArrayBindingDivisor(name, static_cast<GLuint>(strides_.size()), stream.per_instance ? 1 : 0);
        strides_.push_back(stream.stride);
    }
    for (const VertexAttribute& attribute : spec.attributes) {
        const GlFormat format = gl_format(attribute.format);
        gl.EnableVertexArrayAttrib(name, attribute.location);
        if (format.is_unsigned())
            gl.VertexArrayAttribIFormat(name, attribute.location, format.components, format.type, attribute.offset);
        else
            gl.VertexArrayAttribFormat(name, attribute.location, format.components, format.type,
                                       format.type == GL_FLOAT || format.type == GL_HALF_FLOAT ? GL_FALSE : GL_TRUE,
                                       attribute.offset);
        gl.VertexArrayAttribBinding(name, attribute.location, attribute.stream);
    }
    gl::check(gl, "glVertexArrayAttribFormat");
}

void GlPipeline::use(const gl::Functions& gl) const
{
    gl.UseProgram(program_.get());
    if (!graphics_) return;
    gl.BindVertexArray(vertices_.get());
    const bool has_depth = depth_.format != VK_FORMAT_UNDEFINED;
    // Without the test nothing is written either, in both.
    (has_depth && depth_.test ? gl.Enable : gl.Disable)(GL_DEPTH_TEST);
    gl.DepthMask(has_depth && depth_.write ? GL_TRUE : GL_FALSE);
    gl.DepthFunc(compare(depth_.passes));
    gl.PolygonMode(GL_FRONT_AND_BACK, wireframe_ ? GL_LINE : GL_FILL);
    for (GLuint i = 0; i < blends_.size(); ++i) {
        (blends_[i] == Blend::none ? gl.Disablei : gl.Enablei)(GL_BLEND, i);
        gl.BlendFunci(i, GL_ONE, blends_[i] == Blend::add ? GL_ONE : GL_ONE_MINUS_SRC_ALPHA);
    }
}

const GlResource* GlPipeline::push_constants() const
{
    for (const GlResource& resource : resources_)
        if (resource.kind == GlResourceKind::push_constants) return &resource;
    return nullptr;
}

}  // namespace etalon::gpu
