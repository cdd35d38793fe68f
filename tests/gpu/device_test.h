#pragma once
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "engine/gpu/commands.h"

namespace etalon::test {

/// A device under core and synchronization validation. The test fails when the layers said anything, also while the
/// device was destroyed with what the test left behind.
class DeviceTest : public testing::Test {
 protected:
    gpu::Device& device()
    {
        if (!device_) device_.emplace(options());
        return *device_;
    }
    gpu::DeviceOptions options()
    {
        return {.validate = true, .on_message = [this](const std::string& text) { messages_.push_back(text); }};
    }
    void TearDown() override
    {
        device_.reset();
        EXPECT_THAT(messages_, testing::IsEmpty());
    }
    std::vector<std::string> messages_;

 private:
    std::optional<gpu::Device> device_;
};

/// Runs a test kernel over a table: invocation i reads inputs[i] and writes outputs[i]. The kernel declares
///   #include "tests/gpu/device_kernel.glsl"       (local size, `uint count` as push constant, kernel_index())
///   layout(scalar, set = 0, binding = 0) readonly buffer Inputs { In inputs[]; };
///   layout(scalar, set = 0, binding = 1) writeonly buffer Outputs { Out outputs[]; };
/// In and Out are trivially copyable and laid out alike (scalar block layout: no padding between members).
template <class Out, class In>
std::vector<Out> run_kernel(gpu::Device& device, std::span<const std::uint32_t> code, const std::vector<In>& inputs,
                            std::vector<gpu::Constant> constants = {})
{
    const gpu::ComputePipeline kernel(device, {.shader = {code, std::move(constants)}, .name = "test kernel"});
    const gpu::Buffer in = gpu::make_buffer(device, inputs, "inputs");
    const gpu::Buffer out(device, {.size = inputs.size() * sizeof(Out), .name = "outputs"});
    const gpu::Bindings bindings(device, kernel.layout(), {{0, in}, {1, out}});
    gpu::run(device, [&](gpu::Commands& commands) {
        commands.bind(kernel, bindings);
        commands.push(static_cast<std::uint32_t>(inputs.size()));
        commands.dispatch_over(static_cast<std::uint32_t>(inputs.size()));
    });
    return gpu::read_back<Out>(device, out, inputs.size());
}

}  // namespace etalon::test
