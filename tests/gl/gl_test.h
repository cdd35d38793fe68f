#pragma once
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <optional>
#include <string>
#include <vector>

#include "engine/gpu/commands.h"

namespace etalon::test {

/// A device by each way to an OpenGL context: the number that `etalon info` shows. The test fails when OpenGL said
/// anything of errors.
class GlTest : public testing::TestWithParam<const char*> {
 protected:
    gpu::Device& device()
    {
        if (!device_) device_.emplace(options());
        return *device_;
    }
    gpu::DeviceOptions options()
    {
        return {.backend = gpu::Backend::opengl,
                .device = GetParam(),
                .validate = true,
                .on_message = [this](const std::string& text) { messages_.push_back(text); }};
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

inline std::string name_of_way(const testing::TestParamInfo<const char*>& info)
{
    return info.param;
}

#define ETALON_EVERY_WAY(suite) \
    INSTANTIATE_TEST_SUITE_P(Way, suite, testing::Values("EGL", "OSMesa"), etalon::test::name_of_way)

}  // namespace etalon::test
