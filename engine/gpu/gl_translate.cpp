#include "engine/gpu/gl_translate.h"

#include <fmt/format.h>

#include <algorithm>

namespace etalon::gpu {
namespace {

const char* prefix_of(const SpirvModule& module)
{
    switch (spvc_compiler_get_execution_model(module.compiler())) {
        case SpvExecutionModelVertex:
            return "vertex";
        case SpvExecutionModelFragment:
            return "fragment";
        default:
            return "compute";
    }
}

class Translation {
 public:
    Translation(const ShaderSpec& shader, GlUnits& units)
        : module_(specialize(shader), SPVC_BACKEND_GLSL), units_(units), prefix_(prefix_of(module_))
    {}

    GlStage run()
    {
        // Images first: a texture and its sampler become one variable, which the lists below do not have.
        combine();
        add_buffers(SPVC_RESOURCE_TYPE_STORAGE_BUFFER, GlResourceKind::storage_buffer, BlockRules::std430);
        add_buffers(SPVC_RESOURCE_TYPE_UNIFORM_BUFFER, GlResourceKind::uniform_buffer, BlockRules::std140);
        add_buffers(SPVC_RESOURCE_TYPE_PUSH_CONSTANT, GlResourceKind::push_constants, BlockRules::std140);
        for (const spvc_reflected_resource& image : module_.list(SPVC_RESOURCE_TYPE_SAMPLED_IMAGE))
            place(image.id, image.type_id, resource(GlResourceKind::texture, image.id));
        for (const spvc_reflected_resource& image : module_.list(SPVC_RESOURCE_TYPE_STORAGE_IMAGE)) {
            GlResource found = resource(GlResourceKind::storage_image, image.id);
            found.writes = module_.decoration(image.id, SpvDecorationNonWritable) == 0;
            place(image.id, image.type_id, std::move(found));
        }
        set_options();
        const char* code = nullptr;
        module_.check(spvc_compiler_compile(module_.compiler(), &code));
        stage_.code = code;
        return std::move(stage_);
    }

 private:
    GlResource resource(GlResourceKind kind, SpvId id) const
    {
        return {.kind = kind,
                .set = module_.decoration(id, SpvDecorationDescriptorSet),
                .binding = module_.decoration(id, SpvDecorationBinding)};
    }

    /// Gives a variable its binding point, and a name that no other stage has: OpenGL links uniforms by name.
    void place(SpvId id, spvc_type_id type_id, GlResource found)
    {
        const spvc_type type = module_.type(type_id);
        if (is_image(found.kind)) {
            if (spvc_type_get_image_dimension(type) == SpvDimBuffer)
                throw Error(Blame::machine, "texel views have no place in the OpenGL backend",
                            "render with --backend vulkan");
            if (spvc_type_get_num_array_dimensions(type) > 0) found.count = spvc_type_get_array_dimension(type, 0);
        }
        found.unit = units_.take(found.kind, found.set, found.binding, found.sampler, found.count);
        spvc_compiler_unset_decoration(module_.compiler(), id, SpvDecorationDescriptorSet);
        spvc_compiler_set_decoration(module_.compiler(), id, SpvDecorationBinding, found.unit);
        const std::string name = fmt::format("{}_{}_{}", prefix_, static_cast<int>(found.kind), found.unit);
        spvc_compiler_set_name(module_.compiler(), is_image(found.kind) ? id : spvc_type_get_base_type_id(type),
                               name.c_str());
        stage_.resources.push_back(std::move(found));
    }

    static bool is_image(GlResourceKind kind)
    {
        return kind == GlResourceKind::texture || kind == GlResourceKind::storage_image;
    }

    void combine()
    {
        if (module_.list(SPVC_RESOURCE_TYPE_SEPARATE_IMAGE).empty()) return;
        spvc_variable_id dummy = 0;
        module_.check(spvc_compiler_build_dummy_sampler_for_combined_images(module_.compiler(), &dummy));
        module_.check(spvc_compiler_build_combined_image_samplers(module_.compiler()));
        const spvc_combined_image_sampler* pairs = nullptr;
        std::size_t count = 0;
        module_.check(spvc_compiler_get_combined_image_samplers(module_.compiler(), &pairs, &count));
        for (const spvc_combined_image_sampler& pair : std::span(pairs, count)) {
            GlResource found = resource(GlResourceKind::texture, pair.image_id);
            if (pair.sampler_id != dummy) found.sampler = module_.decoration(pair.sampler_id, SpvDecorationBinding);
            const auto images = module_.list(SPVC_RESOURCE_TYPE_SEPARATE_IMAGE);
            const auto image = std::find_if(images.begin(), images.end(),
                                            [&](const auto& candidate) { return candidate.id == pair.image_id; });
            assume(image != images.end());
            place(pair.combined_id, image->type_id, std::move(found));
        }
    }

    void add_buffers(spvc_resource_type list, GlResourceKind kind, BlockRules rules)
    {
        for (const spvc_reflected_resource& block : module_.list(list)) {
            GlResource found = resource(kind, block.id);
            found.layout = layouts_.lay_out(block.base_type_id, rules);
            found.writes = kind == GlResourceKind::storage_buffer && !is_read_only(block.id);
            if (found.writes && !found.layout.is_identity())
                throw Error(Blame::machine,
                            fmt::format("the OpenGL backend cannot write the block \"{}\": its layout is not std430",
                                        block.name),
                            "render with --backend vulkan");
            place(block.id, block.type_id, std::move(found));
        }
    }

    /// True where every member says so, as `readonly buffer` does.
    bool is_read_only(spvc_variable_id id) const
    {
        const SpvDecoration* decorations = nullptr;
        std::size_t count = 0;
        module_.check(spvc_compiler_get_buffer_block_decorations(module_.compiler(), id, &decorations, &count));
        return std::find(decorations, decorations + count, SpvDecorationNonWritable) != decorations + count;
    }

    void set_options() const
    {
        spvc_compiler_options options = nullptr;
        module_.check(spvc_compiler_create_compiler_options(module_.compiler(), &options));
        module_.check(spvc_compiler_options_set_uint(options, SPVC_COMPILER_OPTION_GLSL_VERSION, 450));
        for (const spvc_compiler_option off : {SPVC_COMPILER_OPTION_GLSL_ES, SPVC_COMPILER_OPTION_GLSL_VULKAN_SEMANTICS,
                                               SPVC_COMPILER_OPTION_GLSL_SUPPORT_NONZERO_BASE_INSTANCE})
            module_.check(spvc_compiler_options_set_bool(options, off, SPVC_FALSE));
        module_.check(spvc_compiler_options_set_bool(
            options, SPVC_COMPILER_OPTION_GLSL_EMIT_PUSH_CONSTANT_AS_UNIFORM_BUFFER, SPVC_TRUE));
        module_.check(spvc_compiler_install_compiler_options(module_.compiler(), options));
    }

    SpirvModule module_;
    BlockLayouts layouts_{module_};
    GlUnits& units_;
    const char* prefix_;
    GlStage stage_;
};

}  // namespace

std::uint32_t GlUnits::take(GlResourceKind kind, std::uint32_t set, std::uint32_t binding, std::uint32_t sampler,
                            std::uint32_t count)
{
    // Push constants share the binding points of uniform buffers: one pool for both.
    const GlResourceKind pool = kind == GlResourceKind::push_constants ? GlResourceKind::uniform_buffer : kind;
    const auto [entry, is_new] = taken_.try_emplace({kind, set, binding, sampler}, next_[pool]);
    if (is_new) next_[pool] += count;
    return entry->second;
}

GlStage translate(const ShaderSpec& shader, GlUnits& units)
{
    return Translation(shader, units).run();
}

}  // namespace etalon::gpu
