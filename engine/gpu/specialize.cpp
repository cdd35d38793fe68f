#include <spirv-tools/optimizer.hpp>
#include <string>
#include <unordered_map>

#include "engine/base/error.h"
#include "engine/gpu/shader.h"

namespace etalon::gpu {

std::vector<std::uint32_t> specialize(const ShaderSpec& shader)
{
    std::unordered_map<std::uint32_t, std::vector<std::uint32_t>> values;
    for (const Constant& constant : shader.constants) values[constant.id] = {constant.bits};

    std::string said;
    spvtools::Optimizer optimizer(SPV_ENV_VULKAN_1_3);
    optimizer.SetMessageConsumer(
        [&said](spv_message_level_t, const char*, const spv_position_t&, const char* message) { said = message; });
    optimizer.RegisterPass(spvtools::CreateSetSpecConstantDefaultValuePass(values))
        .RegisterPass(spvtools::CreateFreezeSpecConstantValuePass())
        .RegisterPass(spvtools::CreateFoldSpecConstantOpAndCompositePass())
        .RegisterPass(spvtools::CreateCCPPass())
        .RegisterPass(spvtools::CreateDeadBranchElimPass())
        .RegisterPass(spvtools::CreateBlockMergePass())
        .RegisterPass(spvtools::CreateEliminateDeadFunctionsPass())
        .RegisterPass(spvtools::CreateAggressiveDCEPass());
    // The layers validate what tests make of it; here that would cost more than it saves.
    spvtools::OptimizerOptions options;
    options.set_run_validator(false);
    std::vector<std::uint32_t> out;
    if (!optimizer.Run(shader.code.data(), shader.code.size(), &out, options))
        throw Error(Blame::input, "the shader cannot be specialised: " + said);
    return out;
}

}  // namespace etalon::gpu
