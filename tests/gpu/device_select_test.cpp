// Which device is taken, and why the others were not.
#include "engine/base/error.h"
#include "engine/gpu/probe.h"
#include "tests/gpu/device_test.h"

namespace etalon::test {
namespace {

using testing::Contains;
using testing::HasSubstr;
using testing::IsEmpty;

using DeviceSelect = DeviceTest;

TEST_F(DeviceSelect, takes_exactly_one_and_gives_every_other_a_reason)
{
    const std::vector<gpu::DeviceReport> devices = gpu::list_devices();
    ASSERT_FALSE(devices.empty());
    int chosen = 0;
    for (const gpu::DeviceReport& report : devices) {
        EXPECT_EQ(report.chosen, report.reasons.empty()) << report.name;
        EXPECT_FALSE(report.driver.empty());
        EXPECT_FALSE(report.api_version.empty());
        chosen += report.chosen ? 1 : 0;
    }
    EXPECT_EQ(chosen, 1);
    EXPECT_TRUE(device().report().chosen);
    EXPECT_EQ(device().candidates().size(), devices.size());
}

TEST_F(DeviceSelect, finds_a_device_by_index_and_by_part_of_its_name)
{
    const gpu::DeviceReport first = gpu::list_devices().front();
    const gpu::Device by_index({.device = "0"});
    EXPECT_EQ(by_index.name(), first.name);
    std::string part = first.name.substr(0, 4);
    for (char& c : part) c = static_cast<char>(std::toupper(static_cast<unsigned char>(c)));
    const gpu::Device by_name({.device = part});
    EXPECT_THAT(by_name.name(), HasSubstr(first.name.substr(0, 4)));
}

TEST_F(DeviceSelect, refuses_with_the_reasons_of_every_device)
{
    for (const std::string wanted : {"no such device", "999"}) {
        const gpu::DeviceOptions absent{.device = wanted};
        for (const gpu::DeviceReport& report : gpu::list_devices(absent))
            EXPECT_THAT(report.reasons, Contains(HasSubstr("is not the device \"" + wanted + "\""))) << report.name;
        try {
            const gpu::Device none(absent);
            ADD_FAILURE() << "a device was found for " << wanted;
        } catch (const Error& error) {
            EXPECT_EQ(error.blame(), Blame::machine);
            EXPECT_THAT(error.what(), HasSubstr("is not the device \"" + wanted + "\""));
            EXPECT_THAT(error.what(), HasSubstr(gpu::list_devices().front().name));
            EXPECT_THAT(error.mend(), HasSubstr("etalon info"));
        }
    }
}

TEST_F(DeviceSelect, requires_the_kind_that_was_asked_for)
{
    for (const gpu::DeviceKind kind : {gpu::DeviceKind::cpu, gpu::DeviceKind::gpu}) {
        const gpu::DeviceOptions only{.kind = kind};
        bool found = false;
        for (const gpu::DeviceReport& report : gpu::list_devices(only)) {
            found = found || report.chosen;
            if (report.kind == kind) continue;
            EXPECT_THAT(report.reasons, Contains(HasSubstr("was asked for"))) << report.name;
        }
        if (found)
            EXPECT_EQ(gpu::Device(only).kind(), kind);
        else
            EXPECT_THROW(gpu::Device{only}, Error);
    }
}

TEST_F(DeviceSelect, can_be_moved_and_still_works)
{
    gpu::Device first(options());
    gpu::Device second(std::move(first));
    EXPECT_TRUE(gpu::probe(second).works);
}

TEST_F(DeviceSelect, states_limits_that_a_vulkan_1_3_device_must_have)
{
    const gpu::DeviceLimits& limits = device().limits();
    EXPECT_GE(limits.storage_buffer_range, 1u << 27);
    EXPECT_GE(limits.texel_buffer_elements, 65536u);
    EXPECT_GE(limits.image_side, 4096u);
    EXPECT_GE(limits.push_constants, 128u);
    EXPECT_GE(limits.subpixel_bits, 4u);
    EXPECT_EQ(limits.samples & 5u, 5u) << "1 and 4 samples";
    EXPECT_GE(limits.subgroup_size, 1u);
}

TEST_F(DeviceSelect, probe_draws_computes_and_reads_back)
{
    const gpu::ProbeResult result = gpu::probe(device());
    EXPECT_TRUE(result.works) << result.detail;
    EXPECT_THAT(result.detail, HasSubstr("4096 of 4096"));
    EXPECT_GT(result.milliseconds, 0);
}

TEST_F(DeviceSelect, names_the_loader_and_its_layers)
{
    EXPECT_THAT(gpu::vulkan_versions(), Contains(HasSubstr("Vulkan loader 1.")));
    EXPECT_THAT(gpu::vulkan_versions(), Contains(HasSubstr("VK_LAYER_KHRONOS_validation")));
}

TEST(DeviceValidation, hears_of_a_fault)
{
    // A copy past the end of a texel buffer's alignment: the one fault that these tests plant, to know that silence
    // means something.
    std::vector<std::string> heard;
    gpu::Device device({.validate = true, .on_message = [&](const std::string& text) { heard.push_back(text); }});
    const gpu::Buffer buffer(device, {.size = 64, .name = "victim"});
    gpu::run(device, [&](gpu::Commands& commands) { commands.fill(buffer, 0, 2, 4); });  // offset not a multiple of 4
    EXPECT_THAT(device.validation_messages(), Contains(HasSubstr("VUID-vkCmdFillBuffer")));
    EXPECT_EQ(heard, device.validation_messages());
}

TEST(DeviceValidation, hears_of_a_missing_barrier)
{
    gpu::Device device({.validate = true});
    const gpu::Buffer a(device, {.size = 64, .name = "a"});
    const gpu::Buffer b(device, {.size = 64, .name = "b"});
    gpu::run(device, [&](gpu::Commands& commands) {
        commands.fill(a, 1);
        commands.copy(a, b, 64);  // reads what the fill may not have written yet
    });
    EXPECT_THAT(device.validation_messages(), Contains(HasSubstr("SYNC-HAZARD-READ-AFTER-WRITE")));
}

}  // namespace
}  // namespace etalon::test
