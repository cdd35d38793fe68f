// Every Vulkan call that may fail, failed once: an Error of the machine that names the call, nothing left behind, and a
// device that still draws the same bits afterwards.
#include <map>
#include <set>

#include "engine/gpu/probe.h"
#include "tests/faults/picture.h"
#include "tests/faults/vulkan_shim.h"

namespace etalon::test {
namespace {

using testing::AnyOf;
using testing::HasSubstr;
using testing::IsEmpty;

std::string name(VkResult result)
{
    switch (result) {
        case VK_ERROR_OUT_OF_HOST_MEMORY:
            return "VK_ERROR_OUT_OF_HOST_MEMORY";
        case VK_ERROR_OUT_OF_DEVICE_MEMORY:
            return "VK_ERROR_OUT_OF_DEVICE_MEMORY";
        case VK_ERROR_DEVICE_LOST:
            return "VK_ERROR_DEVICE_LOST";
        default:
            return "did not finish its work";
    }
}

constexpr VkResult kResults[] = {VK_ERROR_OUT_OF_HOST_MEMORY, VK_ERROR_OUT_OF_DEVICE_MEMORY, VK_ERROR_DEVICE_LOST,
                                 VK_TIMEOUT};

/// Positions among `calls` to try: all; or one of each function, by turns its first and its last, and by turns with
/// each of the two kinds of memory that run out.
std::vector<std::size_t> calls_to_try(const std::vector<std::string>& calls, VkResult result)
{
    std::map<std::string, std::pair<std::size_t, std::size_t>> ends;
    for (std::size_t i = 0; i < calls.size(); ++i) ends.try_emplace(calls[i], i, i).first->second.second = i;
    std::set<std::size_t> chosen;
    for (std::size_t i = 0; every_fault() && i < calls.size(); ++i) chosen.insert(i);
    std::size_t turn = 0;
    for (const auto& [function, end] : ends) {
        const VkResult memory = turn % 2 == 0 ? VK_ERROR_OUT_OF_HOST_MEMORY : VK_ERROR_OUT_OF_DEVICE_MEMORY;
        if (result == memory || result == VK_TIMEOUT) chosen.insert(turn % 4 < 2 ? end.first : end.second);
        ++turn;
    }
    return {chosen.begin(), chosen.end()};
}

class VulkanCalls : public testing::TestWithParam<Renderer> {
 protected:
    gpu::DeviceOptions options()
    {
        return {.validate = true, .on_message = [this](const std::string& text) { messages_.push_back(text); }};
    }
    void TearDown() override { EXPECT_THAT(messages_, IsEmpty()); }

    VulkanShim shim_;
    std::vector<std::string> messages_;
};

TEST_F(VulkanCalls, creation_of_a_device_survives_each_call_that_fails)
{
    for (const VkResult result : kResults) {
        shim_.fail(result, 0, 0);
        {
            const gpu::Device counted(options());
        }
        const std::vector<std::string> calls = shim_.calls();
        for (std::size_t n = 0; n < calls.size(); ++n) {
            shim_.fail(result, n);
            const Outcome outcome = attempt([&] { const gpu::Device device(options()); });
            ASSERT_EQ(shim_.failed(), calls[n]);
            const bool in_destructor = calls[n] == "vkDeviceWaitIdle";
            EXPECT_EQ(outcome.blame.has_value(), !in_destructor) << calls[n];
            if (in_destructor) continue;
            EXPECT_EQ(outcome.blame, Blame::machine) << outcome.message;
            EXPECT_THAT(outcome.message, HasSubstr(calls[n] + " failed: " + name(result)));
        }
    }
    shim_.watch();
    gpu::Device works(options());
    EXPECT_TRUE(gpu::probe(works).works);
}

INSTANTIATE_TEST_SUITE_P(Of, VulkanCalls, testing::Values(Renderer::raster, Renderer::path),
                         [](const auto& param_info) {
                             return std::string(param_info.param == Renderer::raster ? "raster" : "path");
                         });

/// Faults of one kind, tried one after another on one device, which must stay as good as new.
TEST_P(VulkanCalls, a_picture_survives_each_call_that_fails)
{
    const Picture picture("maps", GetParam());
    gpu::Device device(options());
    const Film expected = picture.render(&device);
    for (const VkResult result : {VK_ERROR_OUT_OF_HOST_MEMORY, VK_ERROR_OUT_OF_DEVICE_MEMORY, VK_TIMEOUT}) {
        shim_.fail(result, 0, 0);
        static_cast<void>(picture.render(&device));
        for (const std::size_t n : calls_to_try(shim_.calls(), result)) {
            shim_.fail(result, n);
            Film film;
            const Outcome outcome = attempt([&] { film = picture.render(&device); });
            const std::string what = shim_.failed() + " gives " + name(result);
            if (outcome.blame) {
                EXPECT_EQ(*outcome.blame, Blame::machine) << what << outcome.message;
                EXPECT_THAT(outcome.message, HasSubstr(name(result))) << what;
            } else {
                EXPECT_TRUE(same_bits(film, expected)) << what;
            }
            EXPECT_EQ(device.memory().in_use, 0u) << what;
            EXPECT_THAT(messages_, IsEmpty()) << what;
        }
    }
    shim_.watch();
    EXPECT_TRUE(same_bits(picture.render(&device), expected));
}

TEST_P(VulkanCalls, a_device_that_is_lost_at_any_call_is_said_or_mended)
{
    const Picture picture("maps", GetParam());
    gpu::Device device(options());
    const Film expected = picture.render(&device);
    shim_.fail(VK_ERROR_DEVICE_LOST, 0, 0);
    static_cast<void>(picture.render(&device));
    for (const std::size_t n : faults_to_try(shim_.calls().size(), 3)) {
        shim_.fail(VK_ERROR_DEVICE_LOST, n);
        Film film;
        const Outcome outcome = attempt([&] { film = picture.render(&device); });
        if (shim_.failed().empty()) continue;  // how many waves a picture takes depends on their speed
        if (outcome.blame) {
            EXPECT_EQ(GetParam(), Renderer::raster) << outcome.message;
            EXPECT_EQ(*outcome.blame, Blame::machine);
            EXPECT_THAT(outcome.message, HasSubstr("VK_ERROR_DEVICE_LOST"));
        } else {  // mended, or lost when all had been read
            EXPECT_TRUE(same_bits(film, expected)) << n;
        }
        EXPECT_EQ(device.memory().in_use, 0u);
        shim_.watch();
        device.renew();
        EXPECT_THAT(messages_, IsEmpty());
    }
    EXPECT_TRUE(same_bits(picture.render(&device), expected));
}

/// Blocks of 256 samples are what outlives a device: the loss is in the third.
TEST_F(VulkanCalls, path_tracing_goes_on_from_what_was_kept_when_the_device_was_lost)
{
    const Picture picture("triangle", Renderer::path, 8, 600);
    gpu::Device device(options());
    const Film expected = picture.render(&device);
    shim_.fail(VK_ERROR_DEVICE_LOST, 0, 0);
    shim_.only("vkQueueSubmit2");
    static_cast<void>(picture.render(&device));
    const std::size_t submissions = shim_.calls().size();
    shim_.fail(VK_ERROR_DEVICE_LOST, submissions - 2);  // before the AOVs' and the last accumulation
    shim_.only("vkQueueSubmit2");
    EXPECT_TRUE(same_bits(picture.render(&device), expected));
    EXPECT_EQ(shim_.failed(), "vkQueueSubmit2");
    // Two blocks of three need no second tracing.
    EXPECT_LT(shim_.calls().size(), 2 * submissions - submissions / 3);
}

TEST_F(VulkanCalls, a_device_that_is_lost_twice_while_path_tracing_is_given_up)
{
    const Picture picture("triangle", Renderer::path);
    gpu::Device device(options());
    shim_.fail(VK_ERROR_DEVICE_LOST, 4, 2);
    const Outcome outcome = attempt([&] { static_cast<void>(picture.render(&device)); });
    EXPECT_EQ(outcome.blame, Blame::machine);
    EXPECT_THAT(outcome.message, HasSubstr("VK_ERROR_DEVICE_LOST"));
}

}  // namespace
}  // namespace etalon::test
