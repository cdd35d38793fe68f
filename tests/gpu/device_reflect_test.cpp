// What is read from SPIR-V, and how formats and results are described. No device needed.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "device_shaders.h"
#include "engine/base/error.h"
#include "engine/gpu/device_state.h"
#include "engine/gpu/image.h"
#include "engine/gpu/shader.h"

namespace etalon::gpu {
namespace {

struct Expected {
    std::uint32_t set;
    std::uint32_t binding;
    VkDescriptorType type;
    std::uint32_t count;
};

void expect_bindings(const Interface& found, const std::vector<Expected>& expected)
{
    ASSERT_EQ(found.bindings.size(), expected.size());
    for (std::size_t i = 0; i < expected.size(); ++i) {
        EXPECT_EQ(found.bindings[i].set, expected[i].set);
        EXPECT_EQ(found.bindings[i].binding, expected[i].binding);
        EXPECT_EQ(found.bindings[i].type, expected[i].type);
        EXPECT_EQ(found.bindings[i].count, expected[i].count);
        EXPECT_EQ(found.bindings[i].stages, static_cast<VkShaderStageFlags>(found.stage));
    }
}

TEST(Reflect, reads_every_kind_of_binding_in_order)
{
    const Interface constants = reflect(device_shaders::find("device_constants.comp"));
    EXPECT_EQ(constants.stage, VK_SHADER_STAGE_COMPUTE_BIT);
    EXPECT_THAT(constants.workgroup, testing::ElementsAre(8, 4, 1));
    EXPECT_EQ(constants.push_constants, 16u);
    expect_bindings(constants, {{0, 3, VK_DESCRIPTOR_TYPE_STORAGE_BUFFER, 1},
                                {2, 0, VK_DESCRIPTOR_TYPE_UNIFORM_BUFFER, 1},
                                {2, 1, VK_DESCRIPTOR_TYPE_COMBINED_IMAGE_SAMPLER, 3}});
    expect_bindings(reflect(device_shaders::find("device_texels.comp")),
                    {{0, 0, VK_DESCRIPTOR_TYPE_STORAGE_TEXEL_BUFFER, 1},
                     {0, 1, VK_DESCRIPTOR_TYPE_STORAGE_TEXEL_BUFFER, 1},
                     {0, 2, VK_DESCRIPTOR_TYPE_UNIFORM_TEXEL_BUFFER, 1},
                     {0, 3, VK_DESCRIPTOR_TYPE_STORAGE_BUFFER, 1}});
}

TEST(Reflect, tells_the_stages_apart)
{
    EXPECT_EQ(reflect(device_shaders::find("device_slope.vert")).stage, VK_SHADER_STAGE_VERTEX_BIT);
    EXPECT_EQ(reflect(device_shaders::find("device_slope.frag")).stage, VK_SHADER_STAGE_FRAGMENT_BIT);
    EXPECT_EQ(reflect(device_shaders::find("device_slope.frag")).push_constants, 0u);
}

TEST(Reflect, refuses_what_is_not_spirv)
{
    EXPECT_THROW(reflect({}), Error);
    const std::vector<std::uint32_t> garbage(100, 0xdeadbeefu);
    EXPECT_THROW(reflect(garbage), Error);
    const auto code = device_shaders::find("device_count.comp");
    EXPECT_THROW(reflect(code.first(6)), Error) << "cut after the header";
}

std::size_t count_spec_constants(std::span<const std::uint32_t> code)
{
    constexpr std::uint32_t kHeaderWords = 5;
    constexpr std::uint32_t kOpSpecConstantTrue = 48;
    constexpr std::uint32_t kOpSpecConstantOp = 52;
    std::size_t count = 0;
    for (std::size_t at = kHeaderWords; at < code.size(); at += code[at] >> 16) {
        const std::uint32_t op = code[at] & 0xffffu;
        if (op >= kOpSpecConstantTrue && op <= kOpSpecConstantOp) ++count;
    }
    return count;
}

TEST(Specialize, fixes_every_constant_and_drops_what_they_turn_off)
{
    const auto code = device_shaders::find("device_constants.comp");
    ASSERT_GE(count_spec_constants(code), 4u);
    const std::vector<std::uint32_t> fixed = specialize({code, {{0, true}, {99, 1u}}});
    EXPECT_EQ(count_spec_constants(fixed), 0u);
    EXPECT_LT(fixed.size(), code.size());
    const Interface before = reflect(code);
    const Interface after = reflect(fixed);
    EXPECT_EQ(after.stage, before.stage);
    EXPECT_EQ(after.push_constants, before.push_constants);
    EXPECT_EQ(after.bindings.size(), before.bindings.size());
}

TEST(Specialize, refuses_what_is_not_spirv)
{
    EXPECT_THROW(specialize({}), Error);
    const std::vector<std::uint32_t> garbage(100, 0xdeadbeefu);
    EXPECT_THROW(specialize({garbage, {}}), Error);
    EXPECT_THROW(specialize({device_shaders::find("device_count.comp").first(6), {}}), Error) << "cut after the header";
}

TEST(Formats, know_their_texels_and_levels)
{
    EXPECT_EQ(texel_size(VK_FORMAT_R8G8B8A8_SRGB), 4u);
    EXPECT_EQ(texel_size(VK_FORMAT_R32G32B32A32_UINT), 16u);
    EXPECT_THROW(texel_size(VK_FORMAT_BC7_SRGB_BLOCK), Error);
    EXPECT_EQ(mip_count(1, 1), 1u);
    EXPECT_EQ(mip_count(2, 1), 2u);
    EXPECT_EQ(mip_count(1024, 3), 11u);
    EXPECT_EQ(mip_count(1023, 1), 10u);
}

TEST(Results, are_named_and_blamed_on_the_machine)
{
    EXPECT_NO_THROW(check(VK_SUCCESS, "vkCall"));
    EXPECT_NO_THROW(check(VK_SUBOPTIMAL_KHR, "vkCall"));
    try {
        check(VK_ERROR_DEVICE_LOST, "vkCall");
        ADD_FAILURE();
    } catch (const Error& error) {
        EXPECT_STREQ(error.what(), "vkCall failed: VK_ERROR_DEVICE_LOST");
        EXPECT_EQ(error.blame(), Blame::machine);
    }
    EXPECT_EQ(name(static_cast<VkResult>(-12345)), "VkResult -12345");
}

}  // namespace
}  // namespace etalon::gpu
