// The host and the device read shaders/shared/*.h alike: layouts and random numbers.
#include <cstring>

#include "device_shaders.h"
#include "shaders/shared/rng.h"
#include "tests/gpu/device_echo.h"
#include "tests/gpu/device_test.h"

namespace etalon::test {
namespace {

constexpr std::uint32_t kElements = 3;  // more than one: the stride of an array counts too

template <class T>
gpu::Buffer make_records(gpu::Device& device)
{
    return gpu::Buffer(device, {.size = kElements * sizeof(T), .name = "records"});
}

/// The words that the host writes where the device writes those of `buffer`.
template <class T>
void expect_same(gpu::Device& device, const gpu::Buffer& buffer, const char* what)
{
    constexpr std::uint32_t kUnset = 0xcdcdcdcdu;
    constexpr std::size_t kWords = sizeof(T) / 4;
    static_assert(sizeof(T) % 4 == 0);
    std::vector<std::uint32_t> expected(kElements * kWords, kUnset);
    for (std::uint32_t i = 0; i < kElements; ++i) {
        T record;
        std::memcpy(&record, expected.data() + i * kWords, sizeof(T));
        shared::fill_echo(record, 1000 * i);
        std::memcpy(expected.data() + i * kWords, &record, sizeof(T));
    }
    EXPECT_THAT(expected, testing::Not(testing::Contains(kUnset))) << what << ": fill_echo forgets a field";
    EXPECT_EQ(gpu::read_back<std::uint32_t>(device, buffer, expected.size()), expected) << what;
}

using DeviceShared = DeviceTest;

TEST_F(DeviceShared, every_shared_struct_has_one_layout_on_host_and_device)
{
    const gpu::ComputePipeline kernel(device(), {.shader = {device_shaders::find("device_echo.comp")}, .name = "echo"});
    const gpu::Buffer materials = make_records<shared::MaterialRecord>(device());
    const gpu::Buffer lights = make_records<shared::LightRecord>(device());
    const gpu::Buffer raster_frames = make_records<shared::RasterFrame>(device());
    const gpu::Buffer raster_draws = make_records<shared::RasterDraw>(device());
    const gpu::Buffer raster_spheres = make_records<shared::RasterSphere>(device());
    const gpu::Buffer path_frames = make_records<shared::PathFrame>(device());
    const gpu::Buffer path_pushes = make_records<shared::PathPush>(device());
    const gpu::Buffer emitters = make_records<shared::EmitterRecord>(device());
    const gpu::Buffer layers = make_records<shared::LayerRecord>(device());
    const gpu::Buffer shrinks = make_records<shared::RasterShrink>(device());
    const gpu::Bindings bindings(device(), kernel.layout(),
                                 {{0, materials},
                                  {1, lights},
                                  {2, raster_frames},
                                  {3, raster_draws},
                                  {4, raster_spheres},
                                  {5, path_frames},
                                  {6, path_pushes},
                                  {7, emitters},
                                  {8, layers},
                                  {9, shrinks}});
    gpu::run(device(), [&](gpu::Commands& commands) {
        commands.bind(kernel, bindings);
        commands.push(kElements);
        commands.dispatch_over(kElements);
    });
    expect_same<shared::MaterialRecord>(device(), materials, "MaterialRecord");
    expect_same<shared::LightRecord>(device(), lights, "LightRecord");
    expect_same<shared::RasterFrame>(device(), raster_frames, "RasterFrame");
    expect_same<shared::RasterDraw>(device(), raster_draws, "RasterDraw");
    expect_same<shared::RasterSphere>(device(), raster_spheres, "RasterSphere");
    expect_same<shared::PathFrame>(device(), path_frames, "PathFrame");
    expect_same<shared::PathPush>(device(), path_pushes, "PathPush");
    expect_same<shared::EmitterRecord>(device(), emitters, "EmitterRecord");
    expect_same<shared::LayerRecord>(device(), layers, "LayerRecord");
    expect_same<shared::RasterShrink>(device(), shrinks, "RasterShrink");
}

struct Drawn {
    uvec4 bits;
    float unit;
};

TEST_F(DeviceShared, random_numbers_are_the_same_bits_on_host_and_device)
{
    std::vector<uvec4> inputs = {uvec4(0), uvec4(0xffffffffu), uvec4(1, 0, 0, 0), uvec4(0, 0, 0, 1),
                                 uvec4(0x80000000u, 0x7fffffffu, 0xfffffffeu, 2)};
    for (std::uint32_t i = 0; i < 5000; ++i) inputs.push_back(shared::pcg4d(uvec4(i, 11, 13, 17)));
    const auto drawn = run_kernel<Drawn>(device(), device_shaders::find("device_rng.comp"), inputs);
    for (std::size_t i = 0; i < inputs.size(); ++i) {
        const uvec4 bits = shared::random_bits(inputs[i].x, inputs[i].y, inputs[i].z, inputs[i].w);
        ASSERT_EQ(drawn[i].bits, bits) << "row " << i;
        ASSERT_EQ(drawn[i].unit, shared::unit_float(bits.x)) << "row " << i;
        ASSERT_LT(drawn[i].unit, 1.f);
    }
}

}  // namespace
}  // namespace etalon::test
