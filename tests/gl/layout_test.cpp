// Blocks of shaders/shared as OpenGL reads them.
#include "engine/gpu/gl_block.h"
#include "gl_test_shaders.h"
#include "tests/gl/gl_test.h"
#include "tests/gpu/device_echo.h"

namespace etalon::test {
namespace {

using testing::HasSubstr;

constexpr std::uint32_t kElements = 3;  // more than one: the stride of an array counts too

template <class T>
gpu::Buffer filled(gpu::Device& device, std::uint32_t count)
{
    std::vector<T> records(count);
    for (std::uint32_t i = 0; i < count; ++i) shared::fill_echo(records[i], 1000 * i);
    return gpu::make_buffer(device, records, "records");
}

TEST(GlBlock, bytes_go_where_the_layout_says)
{
    // struct { vec3 a; float b; vec3 c[]; } with c at 16 in both, of stride 12 and 16.
    const gpu::BlockLayout layout{.fixed = {{0, 0, 16}},
                                  .from_fixed = 16,
                                  .to_fixed = 16,
                                  .element = {{0, 0, 12}},
                                  .from_stride = 12,
                                  .to_stride = 16};
    EXPECT_FALSE(layout.is_identity());
    std::vector<std::byte> bytes(16 + 2 * 12 + 5);  // the third element is cut off
    for (std::size_t i = 0; i < bytes.size(); ++i) bytes[i] = std::byte(i + 1);
    const std::vector<std::byte> laid = layout.apply(bytes);
    ASSERT_EQ(laid.size(), 16u + 2 * 16u);
    EXPECT_EQ(laid[0], std::byte{1});
    EXPECT_EQ(laid[16], std::byte{17});
    EXPECT_EQ(laid[27], std::byte{28});
    EXPECT_EQ(laid[28], std::byte{0});
    EXPECT_EQ(laid[32], std::byte{29});
}

TEST(GlBlock, nothing_is_read_beyond_what_is_there)
{
    const gpu::BlockLayout layout{.fixed = {{0, 0, 12}, {12, 16, 8}}, .from_fixed = 20, .to_fixed = 32, .element = {}};
    const std::vector<std::byte> half(14, std::byte{9});
    const std::vector<std::byte> laid = layout.apply(half);
    ASSERT_EQ(laid.size(), 32u);
    EXPECT_EQ(laid[17], std::byte{9});
    EXPECT_EQ(laid[18], std::byte{0});
    EXPECT_EQ(layout.apply({}), std::vector<std::byte>(32));
}

class GlLayout : public GlTest {};

TEST_P(GlLayout, every_struct_of_the_rasterizer_arrives_whole)
{
    const gpu::ComputePipeline kernel(device(),
                                      {.shader = {gl_test_shaders::find("layout.comp"), {}}, .name = "layout"});
    const gpu::Buffer materials = filled<shared::MaterialRecord>(device(), kElements);
    const gpu::Buffer lights = filled<shared::LightRecord>(device(), kElements);
    const gpu::Buffer frame = filled<shared::RasterFrame>(device(), 1);
    const gpu::Buffer emitters = filled<shared::EmitterRecord>(device(), kElements);
    const gpu::Buffer layers = filled<shared::LayerRecord>(device(), kElements);
    std::vector<vec3> values;
    for (std::uint32_t i = 0; i < kElements; ++i) values.emplace_back(1000 * i, 1000 * i + 1, 1000 * i + 2);
    const gpu::Buffer normals = gpu::make_buffer(device(), values, "normals");
    const gpu::Buffer verdicts(device(), {.size = kElements * 4, .name = "verdicts"});
    const gpu::Bindings bindings(
        device(), kernel.layout(),
        {{0, materials}, {1, lights}, {2, frame}, {3, emitters}, {4, layers}, {5, normals}, {6, verdicts}});
    shared::RasterDraw draw{};
    shared::fill_echo(draw, 7);
    gpu::run(device(), [&](gpu::Commands& commands) {
        commands.bind(kernel, bindings);
        commands.push(draw);
        commands.dispatch(kElements);
    });
    EXPECT_EQ(gpu::read_back<std::uint32_t>(device(), verdicts, kElements),
              std::vector<std::uint32_t>(kElements, 127u));
}

TEST_P(GlLayout, a_block_that_cannot_be_written_is_refused_by_name)
{
    try {
        const gpu::ComputePipeline kernel(device(),
                                          {.shader = {gl_test_shaders::find("written.comp"), {}}, .name = "written"});
        FAIL() << "made a kernel that writes a layout which OpenGL has not";
    } catch (const Error& error) {
        EXPECT_EQ(error.blame(), Blame::machine);
        EXPECT_THAT(error.what(), HasSubstr("not std430"));
        EXPECT_THAT(error.mend(), HasSubstr("--backend vulkan"));
    }
}
ETALON_EVERY_WAY(GlLayout);

}  // namespace
}  // namespace etalon::test
