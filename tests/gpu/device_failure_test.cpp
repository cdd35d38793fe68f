// What a failing driver becomes: single functions of the device's table are swapped for ones that fail.
#include <cstdlib>

#include "engine/base/error.h"
#include "engine/gpu/device_state.h"
#include "engine/gpu/probe.h"
#include "tests/gpu/device_test.h"

namespace etalon::test {
namespace {

using testing::HasSubstr;

template <class F>
std::string error_of(const F& action)
{
    try {
        action();
    } catch (const Error& error) {
        EXPECT_EQ(error.blame(), Blame::machine);
        return error.message();
    }
    return "no error";
}

using DeviceFailure = DeviceTest;

TEST_F(DeviceFailure, a_lost_device_is_an_error_of_the_machine)
{
    const auto working = device().state().vk.vkQueueSubmit2;
    device().state().vk.vkQueueSubmit2 = [](VkQueue, std::uint32_t, const VkSubmitInfo2*, VkFence) {
        return VK_ERROR_DEVICE_LOST;
    };
    const std::string message = error_of([&] { gpu::run(device(), [](gpu::Commands&) {}); });
    EXPECT_THAT(message, HasSubstr("vkQueueSubmit2 failed: VK_ERROR_DEVICE_LOST"));
    EXPECT_THAT(message, HasSubstr("another device"));
    const gpu::ProbeResult probed = gpu::probe(device());
    EXPECT_FALSE(probed.works);
    EXPECT_THAT(probed.detail, HasSubstr("VK_ERROR_DEVICE_LOST"));
    device().state().vk.vkQueueSubmit2 = working;
    EXPECT_TRUE(gpu::probe(device()).works);
}

TEST_F(DeviceFailure, a_device_lost_while_it_is_waited_for_is_said)
{
    const auto working = device().state().vk.vkWaitSemaphores;
    device().state().vk.vkWaitSemaphores = [](VkDevice, const VkSemaphoreWaitInfo*, std::uint64_t) {
        return VK_ERROR_DEVICE_LOST;
    };
    EXPECT_THAT(error_of([&] { device().wait(1); }), HasSubstr("vkWaitSemaphores failed: VK_ERROR_DEVICE_LOST"));
    device().state().vk.vkWaitSemaphores = working;
}

TEST_F(DeviceFailure, memory_that_the_driver_refuses_is_named_and_not_counted)
{
    const auto working = device().state().vk.vkAllocateMemory;
    device().state().vk.vkAllocateMemory = [](VkDevice, const VkMemoryAllocateInfo*, const VkAllocationCallbacks*,
                                              VkDeviceMemory*) { return VK_ERROR_OUT_OF_DEVICE_MEMORY; };
    EXPECT_THAT(error_of([&] { gpu::Buffer(device(), {.size = 100, .name = "the film"}); }),
                testing::AllOf(HasSubstr("\"the film\""), HasSubstr("VK_ERROR_OUT_OF_DEVICE_MEMORY")));
    EXPECT_EQ(device().memory().held, 0u);
    EXPECT_EQ(device().memory().in_use, 0u);
    device().state().vk.vkAllocateMemory = working;
}

TEST_F(DeviceFailure, a_pipeline_that_does_not_compile_names_the_call)
{
    device().state().vk.vkCreateGraphicsPipelines =
        [](VkDevice, VkPipelineCache, std::uint32_t, const VkGraphicsPipelineCreateInfo*, const VkAllocationCallbacks*,
           VkPipeline*) { return VK_ERROR_OUT_OF_HOST_MEMORY; };
    EXPECT_THAT(gpu::probe(device()).detail,
                HasSubstr("vkCreateGraphicsPipelines failed: VK_ERROR_OUT_OF_HOST_MEMORY"));
}

TEST(DeviceAbsence, a_machine_without_driver_has_no_devices_and_says_so)
{
    ASSERT_EQ(setenv("VK_ICD_FILENAMES", "/nonexistent/driver.json", 1), 0);
    EXPECT_TRUE(gpu::list_devices().empty());
    EXPECT_THAT(error_of([] { const gpu::Device none; }), HasSubstr("there is none"));
    ASSERT_EQ(unsetenv("VK_ICD_FILENAMES"), 0);
}

}  // namespace
}  // namespace etalon::test
