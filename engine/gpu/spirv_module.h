#pragma once
// Inside engine/gpu only: SPIR-V under SPIRV-Cross.
#include <spirv_cross/spirv_cross_c.h>

#include <cstdint>
#include <memory>
#include <span>
#include <type_traits>

#include "engine/base/error.h"

namespace etalon::gpu {

/// The SPIR-V of one entry point.
class SpirvModule {
 public:
    /// Throws Error(input) when `code` is not SPIR-V.
    SpirvModule(std::span<const std::uint32_t> code, spvc_backend backend)
    {
        spvc_context context = nullptr;
        if (spvc_context_create(&context) != SPVC_SUCCESS) throw Error(Blame::machine, "out of memory in SPIRV-Cross");
        context_.reset(context);
        spvc_parsed_ir ir = nullptr;
        check(spvc_context_parse_spirv(context, code.data(), code.size(), &ir));
        check(spvc_context_create_compiler(context, backend, ir, SPVC_CAPTURE_MODE_TAKE_OWNERSHIP, &compiler_));
        check(spvc_compiler_create_shader_resources(compiler_, &resources_));
    }

    void check(spvc_result result) const
    {
        if (result == SPVC_SUCCESS) return;
        const std::string why = spvc_context_get_last_error_string(context_.get());
        // Whatever was thrown within is an invalid shader to it, with the exception's name as the reason.
        if (result == SPVC_ERROR_OUT_OF_MEMORY || why.find("bad_alloc") != std::string::npos)
            throw Error(Blame::machine, "no memory to look at a shader");
        throw Error(Blame::input, "this is not a SPIR-V shader: " + why);
    }

    std::span<const spvc_reflected_resource> list(spvc_resource_type type) const
    {
        const spvc_reflected_resource* first = nullptr;
        std::size_t count = 0;
        check(spvc_resources_get_resource_list_for_type(resources_, type, &first, &count));
        return {first, count};
    }

    spvc_compiler compiler() const { return compiler_; }
    spvc_type type(spvc_type_id id) const { return spvc_compiler_get_type_handle(compiler_, id); }
    unsigned decoration(SpvId id, SpvDecoration which) const
    {
        return spvc_compiler_get_decoration(compiler_, id, which);
    }

 private:
    struct DestroyContext {
        void operator()(spvc_context context) const { spvc_context_destroy(context); }
    };
    std::unique_ptr<std::remove_pointer_t<spvc_context>, DestroyContext> context_;
    spvc_compiler compiler_ = nullptr;
    spvc_resources resources_ = nullptr;
};

}  // namespace etalon::gpu
